"""The contact model points and the tolerances of the augmented Lagrangian in whole runs: what a record says of them, under which step
solvers they run, and what is refused by name."""

import json
import subprocess

import pytest

from barrierbench_analysis.studies.catalogue.entry import FULL, MINI, read_entry, write_config

BALL = {"name": "ball", "kind": "sphere", "point_m": [0.0, 0.0, -0.042], "radius_m": 0.04}


def config(tmp_path, **more):
    """A square of 0.1 m that comes down to a floor, with a ball between its four vertices."""
    mesh = {"generator": "grid", "n_x": 2, "n_y": 2, "size_x_m": 0.1, "size_y_m": 0.1}
    square = {"name": "square", "mesh": mesh, "velocity_m_per_s": [0, 0, -1], "material": {"model": "none", "springs_N_per_m": 2000, "density_kg_per_m2": 100}}
    floor = {"name": "floor", "kind": "plane", "point_m": [0, 0, -0.02]}
    data = {"schema": "barrierbench.config/1", "scene": {"name": "bodies", "gravity_m_per_s2": [0, 0, -9.81], "bodies": [square], "obstacles": [BALL, floor]},
            "formulation": {"shape": "quadratic", "argument": "gap", "d_hat_m": 1e-3, "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 1e6}},
            "matching": {"rule": "as_given"}, "contact": {"model": "points"}, "time": {"dt_s": 1e-3, "steps": 30}, **more}  # fmt: skip
    (tmp_path / "config.json").write_text(json.dumps(data))
    return tmp_path / "config.json"


def bench(program, verb, file, *words):
    return subprocess.run([program, verb, str(file), *words], capture_output=True, text=True, check=False)


def record_of(program, file, out, *sets):
    words = [word for one in sets for word in ("--set", one)]
    done = bench(program, "run", file, "--out", str(out), "--progress", "none", "--set", "/passes/audit=true", *words)
    assert done.returncode == 0, done.stderr
    return json.loads((out / "run.json").read_text())


@pytest.mark.parametrize("solver", ["line_search", "accumulated_toi", "penalty", "augmented_lagrangian", "al_barrier", "al_free", "pncg"])
def test_a_square_comes_to_the_floor_with_a_ball_through_it(program, tmp_path, solver):
    record = record_of(program, config(tmp_path), tmp_path / "out", f"/step_solver/name={solver}")
    audit, status = record["audit"], record["status"]
    assert status["outcome"] == "ok" and status["valid"], status
    assert "points only" in status["detail"] and audit["obstacles_judge"] == "points"
    deepest = 0.018  # of the square on the floor, at the top of the ball
    assert audit["surface_gap_obstacles_m"] == pytest.approx(-deepest, abs=1.5e-3)
    assert f"{-audit['surface_gap_obstacles_m']:.3g} m deep" in status["detail"]
    assert audit["obstacle_vertices"] > 0 and audit["obstacle_edges"] == audit["obstacle_triangles"] == 0
    assert record["config"]["contact"]["model"] == "points"
    assert max(step["contacts"]["obstacle"] for step in record["steps"]) == 4  # each vertex and the floor, no row of a triangle
    whole = record_of(program, config(tmp_path), tmp_path / "whole", f"/step_solver/name={solver}", "/contact/model=all_pairs")
    assert whole["audit"]["obstacles_judge"] == "surface"
    assert whole["audit"]["surface_gap_obstacles_m"] > -1e-3  # the ball carries the middle


def test_explain_says_that_points_alone_are_kept_out(program, tmp_path):
    message = bench(program, "explain", config(tmp_path)).stdout
    assert "points only: this holds for vertices at obstacles; edges and triangles between them may be in an obstacle" in message
    assert "points only" not in bench(program, "explain", config(tmp_path), "--set", "/contact/model=all_pairs").stdout


@pytest.mark.parametrize(("sets", "message"), [
    (["/device=host"], '/contact/model: found "points"; allowed: all_pairs with device host: its kernels know no other pairs'),
    (["/contact/weighting=area"], '/contact/model: found "points"; allowed: all_pairs, or weighting none: points have no area'),
    (["/contact/model=edges"], "/contact/model"),
    (["/step_solver/name=augmented_lagrangian", "/step_solver/al_tolerance_relative=1"], "/step_solver/al_tolerance_relative"),
    (["/step_solver/name=augmented_lagrangian", "/step_solver/al_inner_tolerance_N=-1"], "/step_solver/al_inner_tolerance_N"),
    (["/scene/bodies/0/material/cloth_softening_m=0.1"], "/material/cloth_softening_m: found 0.1; allowed: 0 without a cloth spring"),
    (["/scene/bodies/0/material/cloth_skip_one_N_per_m=-1"], "cloth_skip_one_N_per_m"),
])
def test_what_does_not_go_with_it_is_refused_by_name(program, tmp_path, sets, message):
    words = [word for one in sets for word in ("--set", one)]
    done = bench(program, "check", config(tmp_path), *words)
    assert done.returncode == 2 and message in done.stderr, done.stderr


def test_springs_two_apart_are_refused_on_what_is_no_grid(program, tmp_path):
    mesh = {"generator": "icosphere", "level": 1, "radius_m": 0.05}
    words = ["--set", f"/scene/bodies/0/mesh={json.dumps(mesh)}", "--set", "/scene/bodies/0/material/cloth_skip_one_N_per_m=5"]
    done = bench(program, "check", config(tmp_path), *words)
    assert done.returncode == 2
    assert "/material/cloth_skip_one_N_per_m: found 5; allowed: 0: the mesh is no grid, it has triangle 0, which is no half of a quad" in done.stderr


@pytest.mark.parametrize("solver", ["xpbd", "projection"])
def test_solvers_that_know_constraints_alone_refuse_springs_of_cloth(program, tmp_path, solver):
    material = {"model": "none", "cloth_tension_N_per_m": 100, "cloth_skip_one_N_per_m": 5, "density_kg_per_m2": 100}
    words = ["--set", f"/step_solver/name={solver}", "--set", f"/scene/bodies/0/material={json.dumps(material)}"]
    done = bench(program, "check", config(tmp_path), *words)
    assert done.returncode == 2 and f"/step_solver/name: found {solver} with the term cloth_springs; allowed" in done.stderr


@pytest.mark.parametrize(("absolute", "relative"), [(1e-6, 0.0), (1e-6, 1e-4), (1e-3, 1e-4)])
def test_the_larger_of_the_two_tolerances_is_what_is_promised(program, tmp_path, absolute, relative):
    sets = [f"/step_solver/al_tolerance_m={absolute}", f"/step_solver/al_tolerance_relative={relative}", "/step_solver/al_inner_tolerance_N=1e-3"]
    record = record_of(program, config(tmp_path), tmp_path / "out", "/step_solver/name=augmented_lagrangian", *sets)
    promised = max(absolute, relative)
    assert record["audit"]["promised_m"] == promised and record["status"]["outcome"] == "ok"
    assert 0 < record["summary"]["solver"]["al_violation_m"] <= promised
    assert record["audit"]["overlap_max_m"] <= promised


def test_a_minimum_to_an_inner_tolerance_takes_fewer_iterations(program, tmp_path):
    iterations = []
    for inner in (0, 1e-1):
        record = record_of(program, config(tmp_path), tmp_path / str(inner), "/step_solver/name=augmented_lagrangian",
                           "/step_solver/tol_velocity_m_per_s=1e-9", f"/step_solver/al_inner_tolerance_N={inner}")  # fmt: skip
        assert record["status"]["outcome"] == "ok"
        iterations.append(record["summary"]["newton_iterations"])
    assert iterations[1] < iterations[0]


# --- the cloth of jaxls


def full_run(program, tmp_path, seed):
    """The full size from its own start, seed 0, or from one that is moved by up to 0.1 mm."""
    file = tmp_path / "drape.json"
    write_config(read_entry("jaxls-drape"), file, FULL)
    return record_of(program, file, tmp_path / f"out{seed}", f"/seeds/main={seed or 1}", f"/seeds/jitter_m={1e-4 if seed else 0}", "/output/frames_every=1")


def test_the_cloth_of_jaxls_ends_where_jaxls_does(program, tmp_path):
    """results/jaxls_drape.json: jaxls itself, from eleven starts (examples/jaxls)."""
    from barrierbench_analysis.io.frames import frame_of
    from barrierbench_analysis.io.places import ROOT

    known = json.loads((ROOT / "results" / "jaxls_drape.json").read_text())["runs"]
    record = full_run(program, tmp_path, 0)
    assert record["status"]["outcome"] == "ok" and record["status"]["valid"], record["status"]
    assert len(record["steps"]) == 150
    assert record["audit"]["promised_m"] == 1e-5 and record["audit"]["obstacles_judge"] == "points"
    for count, within in ((19, 1e-4), (31, 2e-3), (41, 1e-2)):
        x = frame_of(record, tmp_path / "out0", count - 1).vertices
        there = known[0]["after_steps"][str(count)]
        centre = [0.7, 0.7, 0.0]  # their ball is there, ours over the origin
        assert x.mean(axis=0) + centre == pytest.approx(there["mean_m"], abs=within)
        assert x[:, 2].max() == pytest.approx(there["highest_m"], abs=within)
    highest = [run["after_steps"]["150"]["highest_m"] for run in known]
    end = frame_of(record, tmp_path / "out0", 149).vertices[:, 2]
    assert min(highest) <= end.max() <= max(highest)
    assert -1e-5 <= end.min() <= 1e-5


def test_the_two_sizes_are_the_example_and_a_scene_for_barriers():
    entry = read_entry("jaxls-drape")
    assert entry.config(FULL)["contact"] == {"model": "points"} and entry.config(MINI)["contact"] == {"model": "all_pairs"}
    damping, dt = entry.config(FULL)["scene"]["velocity_damping"], entry.config(FULL)["time"]["dt_s"]
    assert damping["factor_per_s"] ** dt == pytest.approx(0.95, rel=1e-15)
    assert damping["near_obstacles_factor_per_s"] ** dt == pytest.approx(0.7, rel=1e-15)
    material = entry.config(FULL)["scene"]["bodies"][0]["material"]
    assert material["density_kg_per_m2"] * 1.4**2 / 15**2 == pytest.approx(0.01, rel=1e-15)


def test_the_page_has_the_numbers_of_jaxls():
    from barrierbench_analysis.io.places import ROOT

    runs = json.loads((ROOT / "results" / "jaxls_drape.json").read_text())["runs"]
    rows = {line.split("|")[1].strip(): [cell.strip() for cell in line.split("|")[2:-1]]
            for line in (ROOT / "docs/results/jaxls.md").read_text().splitlines() if line.startswith("|")}  # fmt: skip
    assert len(runs) == 11
    for steps in (31, 41, 150):
        highest = [run["after_steps"][str(steps)]["highest_m"] for run in runs]
        cells = rows[f"highest point after {steps} steps, m"]
        assert cells[1] == f"{highest[0]}" and cells[2] == f"{min(highest)} to {max(highest)}"
    assert min(highest) < 0.176 < max(highest), "the page of jaxls is within what it does itself"
    deepest = [run["deepest_m"] for run in runs]
    assert rows["deepest point of all step ends, m"][2] == f"{min(deepest):.1e} to {max(deepest):.1e}"
