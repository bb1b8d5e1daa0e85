"""Step solvers without a guarantee through the program: what they say that they keep, what their records count, what the audit
finds, what is refused."""

import json
from pathlib import Path

import pytest
from test_cli import bench, refused, write

ROOT = Path(__file__).resolve().parents[2]
CHAIN = ROOT / "configs/scenes/chain.json"
BASELINES = ["penalty", "projection", "augmented_lagrangian"]


def shot(tmp_path: Path, offset: float) -> Path:
    """A pair of beads at 10 m/s towards a sheet that stays."""
    return write(tmp_path / "shot.json", {
        "schema": "barrierbench.config/1",
        "scene": {"name": "bodies", "gravity_m_per_s2": [0, 0, 0], "bodies": [
            {"name": "beads", "mesh": {"generator": "rod", "n_segments": 1, "length_m": 0.05},
             "transform": {"axis": [0, 0, 1], "angle_deg": 20, "translate_m": [0.1, 0.1, 0.05]},
             "material": {"springs_N_per_m": 100, "line_density_kg_per_m": 1}, "velocity_m_per_s": [0, 0, -10], "offset_m": offset},
            {"name": "sheet", "kind": "rigid", "mesh": {"generator": "grid", "n_x": 3, "n_y": 3, "size_x_m": 1, "size_y_m": 1}}]},
        "formulation": {"name": "quadratic", "d_hat_m": 0.01, "stiffness_policy": {"kappa_N_per_m": 5e4}},
        "matching": {"rule": "as_given"},
        "time": {"dt_s": 0.01, "steps": 4}})


def run(program: str, config: Path, out: Path, solver: str, *words: str) -> dict:
    done = bench(program, "run", config, "--out", out, "--progress", "none", "--set", f"/step_solver/name={solver}", *words)
    assert done.returncode == 0, done.stderr
    return json.loads((out / "run.json").read_text())


@pytest.mark.parametrize("solver", BASELINES)
def test_what_is_faster_than_it_can_see_is_a_penetration_that_the_audit_names(program, tmp_path, solver):
    record = run(program, shot(tmp_path, 0), tmp_path / "out", solver)
    assert record["status"]["outcome"] == "penetration" and "sheet" in record["status"]["detail"], record["status"]
    assert record["audit"]["crossings"] + record["audit"]["violations"] > 0
    safe = run(program, shot(tmp_path, 0), tmp_path / "safe", "line_search")
    assert safe["status"]["outcome"] == "ok", safe["status"]


@pytest.mark.parametrize("solver", BASELINES)
def test_list_and_explain_say_what_a_step_solver_guarantees(program, tmp_path, solver):
    message = bench(program, "explain", shot(tmp_path, 0), "--set", f"/step_solver/name={solver}").stdout
    line = next(line for line in message.splitlines() if line.startswith("guarantee "))
    assert line.split()[1] == solver + ":" and "none" in line
    listed = bench(program, "list", "step_solvers").stdout
    assert line.split(": ", 1)[1] in listed


def test_penalty_counts_how_deep_contacts_are(program, tmp_path):
    config = shot(tmp_path, 0.02)  # thick enough to be seen
    soft = ["--set", "/formulation/stiffness_policy/kappa_N_per_m=2000"]
    record = run(program, config, tmp_path / "out", "penalty", "--set", "/time/dt_s=0.001", "--set", "/time/steps=8", *soft)
    solver = record["summary"]["solver"]
    assert set(solver) == {"penalty_overlap_m", "penalty_overlaps", "penalty_feasibility_trials", "penalty_secants"}
    assert 0 < solver["penalty_overlap_m"] < 0.03 and solver["penalty_overlaps"] >= 1
    assert solver["penalty_overlap_m"] == max(step["solver"]["penalty_overlap_m"] for step in record["steps"])
    assert record["summary"]["gap_min_m"] == pytest.approx(-solver["penalty_overlap_m"])


def resting(tmp_path: Path, kind: str) -> Path:
    """A sheet that comes to rest on a floor, or slides over the top of a ball."""
    floor = {"name": "floor", "kind": "plane", "point_m": [0, 0, 0], "axis": [0, 0, 1]}
    ball = {"name": "ball", "kind": "sphere", "point_m": [0.03, 0.02, -0.5], "radius_m": 0.5}
    return write(tmp_path / "rest.json", {
        "schema": "barrierbench.config/1",
        "scene": {"name": "bodies", "bodies": [
            {"name": "sheet", "mesh": {"generator": "grid", "n_x": 4, "n_y": 4, "size_x_m": 0.4, "size_y_m": 0.4},
             "transform": {"translate_m": [0, 0, 0.004]}, "material": {"springs_N_per_m": 100}}], "obstacles": [floor if kind == "floor" else ball]},
        "formulation": {"name": "quadratic", "d_hat_m": 0.01, "stiffness_policy": {"kappa_N_per_m": 50}},
        "matching": {"rule": "as_given"}, "time": {"dt_s": 0.01, "steps": 10}})


@pytest.mark.parametrize("kind", ["floor", "ball"])
def test_an_overlap_with_an_obstacle_within_al_tolerance_is_ok_and_has_a_depth(program, tmp_path, kind):
    config = resting(tmp_path, kind)
    for tolerance in (1e-6, 1e-4):
        record = run(program, config, tmp_path / str(tolerance), "augmented_lagrangian", "--set", f"/step_solver/al_tolerance_m={tolerance}")
        assert record["status"]["outcome"] == "ok" and "within what the step solver promises" in record["status"]["detail"], record["status"]
        assert record["audit"]["promised_m"] == tolerance
        assert 0 < record["audit"]["overlap_max_m"] <= tolerance and record["audit"]["overlaps"] > 0
        assert record["audit"]["violations"] == 0 and record["status"]["valid"]
        assert sum(step["contacts"]["total"] for step in record["steps"]) > 0
    deep = run(program, config, tmp_path / "penalty", "penalty", "--set", "/formulation/stiffness_policy/kappa_N_per_m=0.1")
    assert deep["status"]["outcome"] == "penetration" and deep["audit"]["overlaps"] == 0, "what promises nothing is judged as ever"


def test_settings_of_later_solvers_stand_in_a_config_that_has_one(program, tmp_path):
    own = {"projection": "projection_stiffness", "augmented_lagrangian": "al_tolerance_m"}
    for solver in ["line_search", *own]:
        stated = run(program, shot(tmp_path, 0), tmp_path / solver, solver)["config"]["step_solver"]
        assert "armijo" in stated
        assert {name for name in own.values() if name in stated} == ({own[solver]} if solver in own else set())


@pytest.mark.parametrize(("solver", "words", "message"), [
    ("penalty", ["/formulation/name=log"], ["/formulation/shape", "finite at contact"]),
    ("penalty", ["/formulation/name=cubic_dynamic"], ["/formulation/stiffness_policy/name", "fixed: the step solver is penalty"]),
    ("penalty", ["/formulation/argument=squared_gap"], ["/formulation/argument", "gap: the step solver is penalty"]),
    ("augmented_lagrangian", ["/step_solver/al_reduction=1"], ["/step_solver/al_reduction"]),
    ("projection", ["/step_solver/projection_stiffness=0"], ["/step_solver/projection_stiffness"]),
    ("projection", ["/step_solver/saddle=escape"], ["/step_solver/saddle", "line_search", "augmented_lagrangian"]),
    ("projection", ["/friction/lag_iterations=2"], ["/friction/lag_iterations", "penalty", "augmented_lagrangian"]),
])
def test_what_does_not_go_with_them_is_refused_by_name(program, tmp_path, solver, words, message):
    sets = [word for each in words for word in ("--set", each)]
    refused(bench(program, "check", shot(tmp_path, 0), "--set", f"/step_solver/name={solver}", *sets), *message)


def test_a_chain_of_projection_is_as_long_as_its_sweeps_make_it(program, tmp_path):
    still = ["--set", "/scene/bodies/0/pins/1/motion/velocity_m_per_s=[0,0,0]", "--set", "/time/steps=20", "--set", "/time/dt_s=0.01"]
    left = {}
    for sweeps in (10, 2000):
        record = run(program, CHAIN, tmp_path / str(sweeps), "projection", *still, "--set", f"/step_solver/max_iterations={sweeps}")
        assert record["status"]["outcome"] == "ok", record["status"]
        left[sweeps] = record["summary"]["solver"]["projection_stretch_m"]
        assert record["summary"]["convergence"] == "not_asked"
    assert 0 < left[2000] < 0.2 * left[10]  # ends that are as far apart as it is long leave it no rest
