"""What would be wrong from its first step on is refused with its place, and what is requested is done or refused, never passed over."""

import json

import pytest
from test_cli import bench, refused, write

SHEET = {"name": "sheet", "mesh": {"generator": "grid", "n_x": 4, "n_y": 4, "size_x_m": 0.3, "size_y_m": 0.3}, "transform": {"translate_m": [0, 0, 0.02]},
         "material": {"youngs_N_per_m": 300, "density_kg_per_m2": 0.3, "bending_J": 1e-5}}
PLATE = {"name": "plate", "kind": "rigid", "mesh": {"generator": "grid", "n_x": 2, "n_y": 2, "size_x_m": 1, "size_y_m": 1}}
SOFT = {"name": "log", "d_hat_m": 0.01, "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 50}}


def config(tmp_path, bodies=(SHEET,), scene=None, **more):
    data = {"schema": "barrierbench.config/1", "scene": {"name": "bodies", "gravity_m_per_s2": [0, 0, -9.81], "bodies": list(bodies)} | (scene or {}),
            "formulation": SOFT, "time": {"dt_s": 0.01, "steps": 3}, **more}
    return write(tmp_path / "c.json", data)


def resolved(program, file):
    """The settings of the record of a run."""
    out = file.parent / "out"
    done = bench(program, "run", file, "--out", out)
    assert (out / "run.json").is_file(), done.stderr
    return json.loads((out / "run.json").read_text())


def test_what_is_prescribed_does_not_jump_to_where_an_earlier_start_had_led(program, tmp_path):
    early = PLATE | {"motion": {"velocity_m_per_s": [0, 0, 1], "start_s": -1}}
    refused(bench(program, "check", config(tmp_path, (SHEET, early))), "/motion/start", "do not jump")
    for good in (PLATE | {"motion": {"velocity_m_per_s": [0, 0, 0.1], "start_s": 0}}, PLATE | {"motion": {"velocity_m_per_s": [0, 0, 0.1], "start_s": 0.01}}):
        assert bench(program, "check", config(tmp_path, (SHEET, good))).returncode == 0


@pytest.mark.parametrize("motion, message", [
    ({"velocity_m_per_s": [0, 0, 1]}, "a way with a z component"),
    ({"keyframes": [{"time_s": 0}, {"time_s": 1, "translate_m": [0, 0, 1]}]}, "a way with a z component"),
    ({"angular_velocity_rad_per_s": 1, "axis": [1, 0, 0]}, "a rotation out of the plane")])
@pytest.mark.parametrize("of", ["rigid", "pin", "pull"])
def test_nothing_leaves_the_plane_of_a_planar_scene(program, tmp_path, motion, message, of):
    plane = {"planar": True, "gravity_m_per_s2": [0, -9.81, 0]}
    flat = SHEET | {"transform": {"translate_m": [0, 0.5, 0]}}
    pin = {"box_m": [[-1, 0.6, -1], [1, 1, 1]], "motion": motion} | ({"pull_N_per_m": 5} if of == "pull" else {})
    bodies = (flat, PLATE | {"motion": motion}) if of == "rigid" else (flat | {"pins": [pin]},)
    refused(bench(program, "check", config(tmp_path, bodies, plane)), message, "the scene is planar")


def test_a_start_beyond_the_strain_limit_is_no_scene(program, tmp_path):
    longer = SHEET | {"rest_mesh": SHEET["mesh"] | {"size_x_m": 0.2}}
    file = config(tmp_path, (longer,), strain_limit={"limit": 0.1, "stiffness_policy": {"name": "fixed", "k_s_N_per_m": 5}})
    done = bench(program, "check", file)
    assert done.returncode != 0 and 'body "sheet": element 0 of the strain limit is stretched by 0.5 at the start, and its limit is 0.1' in done.stdout + done.stderr
    assert resolved(program, file)["status"]["outcome"] == "invalid_scene"


def test_a_formula_of_inertia_has_none_without_it(program, tmp_path):
    policy = {"name": "formula", "formula": "m/(c*h^2)+k", "refresh": "per_step"}
    file = config(tmp_path, formulation={"shape": "cubic", "d_hat_m": 0.01, "stiffness_policy": policy}, integrator={"name": "quasi_static"})
    refused(bench(program, "check", file), "/formulation/stiffness_policy/formula", "a formula without c", "quasi_static")


@pytest.mark.parametrize("matching, rule", [({}, "as_given"), ({"load_N": 1}, "equal_force"), ({"theta": 0.2, "load_N": 1}, "equal_force"), ({"load_N": 1, "rule": "as_given"}, "as_given")])
def test_a_load_without_a_rule_is_matched(program, tmp_path, matching, rule):
    """A preset has a kappa of its own, which is no reason to pass over a load that is given."""
    floor = {"obstacles": [{"name": "floor", "kind": "plane"}]}
    record = resolved(program, config(tmp_path, scene=floor, formulation={"name": "cubic", "d_hat_m": 0.01}, matching=matching))
    assert record["matching"]["rule"] == rule and (record["matching"]["load_N"] == 1) == (rule == "equal_force")


def test_gravity_that_comes_later_counts(program, tmp_path):
    """The tolerance is of the largest gravity, and a calibration run can start on it."""
    keys = [{"time_s": 0, "gravity_m_per_s2": [0, 0, 0]}, {"time_s": 0.1, "gravity_m_per_s2": [0, 0, -9.81]}]
    made = json.loads(config(tmp_path, formulation={"name": "cubic", "d_hat_m": 0.01}, matching={"rule": "equal_force"}).read_text())
    del made["scene"]["gravity_m_per_s2"]
    made["scene"] |= {"gravity_schedule": keys, "obstacles": [{"name": "floor", "kind": "plane"}]}
    late = resolved(program, write(tmp_path / "late.json", made))
    made["scene"]["gravity_schedule"] = keys[1:]
    (tmp_path / "at_once").mkdir()
    at_once = resolved(program, write(tmp_path / "at_once/c.json", made))
    assert late["status"]["outcome"] == "ok" and late["config"]["step_solver"]["tol_velocity_m_per_s"] == at_once["config"]["step_solver"]["tol_velocity_m_per_s"] > 1e-6


def test_a_record_is_no_config_and_says_what_takes_it(program, tmp_path):
    file = config(tmp_path)
    resolved(program, file)
    for verb in ("check", "explain"):
        done = bench(program, verb, tmp_path / "out/run.json")
        refused(done, "#/schema", "./bench run FILE repeats it")
        assert len(done.stderr.strip().splitlines()) == 1


def test_a_run_that_was_cut_off_goes_on_though_its_audit_has_found_something(program, tmp_path):
    """A crossing is reported, and is no end: the steps that are missing are made, and then the outcome is that of the whole run."""
    falling = SHEET | {"transform": {"translate_m": [0, 0, 0.05]}, "velocity_m_per_s": [0, 0, -20]}
    soft = {"shape": "quadratic", "d_hat_m": 0.01, "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 50}}
    file = config(tmp_path, (falling, PLATE), formulation=soft, time={"dt_s": 0.01, "steps": 20}, output={"checkpoint_every": 5}, step_solver={"name": "penalty"},
                  passes={"time": False, "diagnose": False, "audit": True})
    whole, out = resolved(program, file), tmp_path / "cut"
    assert whole["status"]["outcome"] == "penetration" and whole["audit"]["first_bad_step"] == 0 and len(whole["steps"]) == 20
    bench(program, "run", file, "--out", out, "--step-limit", "8")
    cut = json.loads((out / "run.json").read_text())
    assert cut["status"]["outcome"] == "timeout" and "penetration so far" in cut["status"]["detail"]
    assert (out / "checkpoint.bin").is_file() and len(cut["steps"]) == 8
    done = bench(program, "run", file, "--out", out, "--resume")
    cut = json.loads((out / "run.json").read_text())
    assert cut["status"]["outcome"] == "penetration", done.stderr
    assert len(cut["steps"]) == 20 and cut["summary"]["state_hash"] == whole["summary"]["state_hash"]
