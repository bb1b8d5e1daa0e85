"""Forces in frames and tables of runs: a stack that bears its weight, the same bits whatever else is requested, refusals."""

import re
from pathlib import Path

import meshio
import numpy as np
import pytest
from test_cli import bench, refused
from test_friction import SLOPE

from barrierbench_analysis.figures.frames_out import verb as frames_out
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.frames import frame_paths, read_frame, with_vectors
from barrierbench_analysis.tables.run import Run

ROOT = Path(__file__).resolve().parents[2]
STACK = ROOT / "configs/scenes/stack.json"
WEIGHT = 17.32050807568877 * 0.2**2 * np.sqrt(3) / 4 * 9.81  # N, of a layer
FORCES = ("/output/contact_forces=true", "/output/pair_forces=true", "/output/frames_every=1")
SOLVERS = {"line_search", "accumulated_toi", "penalty", "augmented_lagrangian", "al_barrier", "pncg", "article_literal"}
NONE = {"xpbd", "projection", "al_free"}


def run(program, out, scene, *settings) -> Run:
    words = [w for s in settings for w in ("--set", s)]
    done = bench(program, "run", scene, "--out", out, "--progress", "none", *words)
    assert done.returncode == 0, done.stderr
    return Run(out)


def contact(frame):
    return with_vectors(frame.of_vertices)["contact_N"]


@pytest.fixture(scope="module")
def stack(program, tmp_path_factory) -> Run:
    return run(program, tmp_path_factory.mktemp("stack") / "run", STACK, *FORCES, "/step_solver/tol_velocity_m_per_s=1e-9")


def test_a_stack_bears_what_is_above(stack):
    table = stack.pair_forces
    last = table[table["step"] == table["step"].max()].set_index(["body_a", "body_b"])
    above = {("layer0", "floor"): 4, ("layer0", "layer1"): 3, ("layer1", "layer2"): 2, ("layer2", "layer3"): 1}
    assert set(last.index) == set(above)
    for pair, layers in above.items():
        row = last.loc[pair]
        sign = 1 if pair[1] == "floor" else -1  # on the first body
        assert row["normal_N"] == pytest.approx(layers * WEIGHT, rel=2e-2) and row["contacts"] >= 3
        assert row["contact_z_N"] == pytest.approx(sign * row["normal_N"], rel=1e-6)
        assert row["friction_N"] == 0
    assert table["area_m2"].isna().all()
    assert (table["contact_work_J"].abs() > 0).any()
    totals = table.groupby("step")["contacts"].sum()
    recorded = stack.steps.set_index("step")["contacts_total"]
    assert (totals == recorded[totals.index]).all() and (totals > 0).sum() > 20


def test_frames_and_table_have_the_same_forces_and_they_cancel(stack):
    table, seen = stack.pair_forces, 0
    for step, path in frame_paths(stack.record, stack.folder).items():
        rows = table[table["step"] == step]
        if step < 0:
            assert "contact_x_N" not in read_frame(path).of_vertices
            continue
        frame = read_frame(path)
        total = contact(frame).sum(axis=0)
        on_floor = rows[rows["body_b"] == "floor"][["contact_x_N", "contact_y_N", "contact_z_N"]].sum().to_numpy(float)
        scale = max(np.abs(contact(frame)).max(), 1e-12)
        np.testing.assert_allclose(total, on_floor, atol=1e-12 * scale)  # layers push each other, and cancel
        seen += bool(scale > 0.5)
    assert seen > 20


def test_runs_without_them_keep_their_bits_and_so_do_threads(program, stack, tmp_path):
    exact = "/step_solver/tol_velocity_m_per_s=1e-9"
    plain = run(program, tmp_path / "plain", STACK, "/output/frames_every=1", exact)
    assert plain.record["summary"]["state_hash"] == stack.record["summary"]["state_hash"]
    assert not (tmp_path / "plain/forces").exists()
    assert "contact_forces" not in plain.config["output"] and "pair_forces" not in plain.config["output"]
    with pytest.raises(UserError, match="no forces of bodies; run the config with --set /output/pair_forces=true"):
        plain.pair_forces  # noqa: B018
    two = run(program, tmp_path / "two", STACK, *FORCES, exact, "/threads=2")
    hashes = [{a["path"]: a["sha256"] for a in r.record["artifacts"] if a["kind"] in ("frame", "pair_forces")} for r in (stack, two)]
    assert hashes[0] == hashes[1] and "forces/pairs.csv" in hashes[0]


def test_a_table_needs_no_frames_and_a_new_run_takes_its_place(program, tmp_path):
    first = run(program, tmp_path / "out", STACK, "/output/pair_forces=true", "/time/steps=5")
    assert sorted(p.name for p in (tmp_path / "out/forces").iterdir()) == ["pairs.csv"] and len(first.pair_forces)
    done = bench(program, "run", STACK, "--out", tmp_path / "out", "--replace", "--progress", "none", "--set", "/time/steps=5")
    assert done.returncode == 0, done.stderr
    assert not (tmp_path / "out/forces").exists()


@pytest.mark.parametrize("law", ["smoothed_coulomb", "static_kinetic"])
def test_work_of_friction_is_the_dissipation_of_the_step(program, tmp_path, law):
    made = run(program, tmp_path / "out", SLOPE, "/output/pair_forces=true", "/friction/mu=0.2", f"/friction/law={law}")
    table, steps = made.pair_forces.set_index("step"), made.steps.set_index("step")
    dissipated = steps.loc[table.index, "friction_dissipation_J"].astype(float)
    np.testing.assert_allclose(-table["friction_work_J"], dissipated, rtol=1e-12, atol=1e-18)
    late = table.loc[30:]
    np.testing.assert_allclose(late["friction_N"], 0.2 * late["normal_N"], rtol=1e-2)
    assert (late["friction_N"] > 0).all() and len(late) == 30


def test_areas_are_there_where_contacts_are_weighted_by_them(program, tmp_path):
    table = run(program, tmp_path / "out", STACK, "/output/pair_forces=true", '/contact/weighting="area"', "/time/steps=5").pair_forces
    assert (table["area_m2"] > 0).all() and len(table) >= 4


def test_formats_for_other_tools_have_vectors(stack, tmp_path):
    for kind in ("vtu", "npz"):
        assert frames_out.main([str(stack.folder), str(tmp_path / kind), "--format", kind]) == 0
    frames = [frame for _, frame in stack.frames()]
    arrays = np.load(tmp_path / "npz/frame.npz")
    assert arrays["contact_N"].shape == (len(frames), len(frames[0].vertices), 3) and np.isnan(arrays["contact_N"][0]).all()
    np.testing.assert_array_equal(arrays["contact_N"][-1], contact(frames[-1]))
    np.testing.assert_array_equal(arrays["positions"][-1], frames[-1].vertices)
    np.testing.assert_array_equal(arrays["triangles"], frames[0].triangles)
    assert np.load(tmp_path / "npz/obstacles.npz")["positions"].shape[0] == 1
    last = meshio.read(tmp_path / f"vtu/frame_{len(frames) - 1:06}.vtu")
    np.testing.assert_array_equal(last.point_data["contact_N"], contact(frames[-1]))
    assert np.abs(last.point_data["contact_N"]).max() > 0.5


@pytest.mark.parametrize("solver", sorted(SOLVERS | NONE))
@pytest.mark.parametrize("key", ["contact_forces", "pair_forces"])
def test_step_solvers_without_rows_are_refused_by_name(program, solver, key):
    words = [f"/step_solver/name={solver}", "/output/frames_every=1", f"/output/{key}=true"]
    done = bench(program, "check", STACK, *[w for s in words for w in ("--set", s)])
    message = f"/output/{key}: found true with the step solver {solver}"
    assert (message in done.stderr) == (solver in NONE), done.stderr
    if solver in NONE:
        allowed = done.stderr.split(message)[1].split("one of the step solvers ")[1].splitlines()[0]
        assert {name.strip() for name in allowed.split(",")} == SOLVERS


def test_what_does_not_go_with_them_is_refused(program):
    refused(bench(program, "check", STACK, "--set", "/output/contact_forces=true"), "/output/contact_forces", "frames_every > 0")
    device = ["--set", "/output/pair_forces=true", "--set", "/device=host"]
    refused(bench(program, "check", STACK, *device), "/output/pair_forces", "/device cpu")


def test_every_step_solver_is_judged(program):
    listed = bench(program, "list", "step_solvers").stdout
    assert set(re.findall(r"^  (\w+) .*\n    guarantee: ", listed, re.MULTILINE)) == SOLVERS | NONE
