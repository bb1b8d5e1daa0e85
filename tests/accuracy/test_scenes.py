"""The scenes with a closed form, run by the program and measured against it."""

import json
import subprocess
from dataclasses import replace

import pytest

from barrierbench_analysis.tables.accuracy.reference import CLOSED_FORMS, NoReference, measure, refined
from barrierbench_analysis.tables.accuracy.state import read_motion
from bounce import BarrierBounce
from motions import ROOT


def scene(program, tmp_path, name: str, every: int, **settings):
    """Its last frame is its end: frames are of the steps 0, every, 2 every and so on."""
    out = tmp_path / name
    words = [program, "run", str(ROOT / f"configs/scenes/{name}.json"), "--out", str(out), "--progress", "none", "--set", f"/output/frames_every={every}",
             "--set", "/threads=1", "--set", "/passes/time=false"]
    for pointer, value in settings.items():
        words += ["--set", f"{pointer}={json.dumps(value)}"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    motion = read_motion(out)
    assert motion.record["status"]["outcome"] == "ok" and motion.record["status"]["valid"]
    return motion


@pytest.mark.parametrize("formulation", ["log", "log_squared", "quadratic", "cubic", "two_stage", "exponential", "minimax_bounded", "minimax", "ipc2020"])
def test_stack_gaps_carry_the_weight_above(program, tmp_path, formulation):
    extra = {"/matching/rule": "as_given"} if formulation == "ipc2020" else {"/matching/rule": "equal_force", "/matching/load_N": 10}
    motion = scene(program, tmp_path, "stack", 39, **{"/formulation": {"name": formulation, "d_hat_m": 0.004}, **extra})
    assert motion.record["steps"][-1]["contacts"]["total"] == 12 and motion.record["steps"][-1]["contact_load_sum_N"] == pytest.approx(10 * 0.3 * 9.81, rel=1e-6)
    found, skipped = measure(motion, CLOSED_FORMS["rigid_stack"]())
    assert 1e-4 < found["e_offset"] < 4 * 0.004
    if formulation == "ipc2020":
        assert "kappa" in skipped["e_gap"]
    else:
        assert found["e_gap"] < 1e-6


def test_impact_keeps_momentum_and_exchanges_velocities(program, tmp_path):
    motion = scene(program, tmp_path, "impact", 5, **{"/time/steps": 61})
    assert any(step["contacts"]["total"] == 3 for step in motion.record["steps"]) and motion.record["steps"][-1]["contacts"]["total"] == 0
    found, skipped = measure(motion, CLOSED_FORMS["free_impact"]())
    assert found["e_momentum"] < 1e-12 and found["e_energy"] < 1e-3 and 0 < found["e_traj"] < 0.01 and "e_offset" in skipped
    slow = scene(program, tmp_path / "euler", "impact", 5, **{"/time/steps": 61, "/integrator/name": "implicit_euler"})
    lossy, _ = measure(slow, CLOSED_FORMS["free_impact"]())
    assert lossy["e_momentum"] < 1e-12 and lossy["e_energy"] > 0.01


def test_bounce_follows_the_quadrature_of_its_own_barrier(program, tmp_path):
    """Newmark, second order: the error falls by four from one time step to half of it, with the barrier met on the way."""
    errors = []
    for steps in (400, 800):
        motion = scene(program, tmp_path / str(steps), "bounce", steps // 100, **{"/time/dt_s": 0.4 / steps, "/time/steps": steps + 1,
                                                                                  "/formulation": {"name": "log", "d_hat_m": 0.02}})
        exact = BarrierBounce("log", "gap", 1000.0, 0.02, 0.3, 3, 9.81, 0.05)
        assert sum(step["contacts"]["total"] == 3 for step in motion.record["steps"]) > 20
        errors.append(max(abs(x[0, 2] - exact.gap(t)) for x, t in zip(motion.x, motion.times)))
    assert 1e-6 < errors[1] < 1e-3 and 3 < errors[0] / errors[1] < 5, errors


def test_chain_comes_to_rest_as_the_discrete_catenary(program, tmp_path):
    motion = scene(program, tmp_path, "chain", 199)
    found, _ = measure(motion, CLOSED_FORMS["catenary"]())
    assert found["e_traj"] < 1e-9 and motion.x[-1, :, 2].min() < -0.3


def test_refined_reference_is_the_middle_and_its_band_the_distance(program, tmp_path):
    a, b = (scene(program, tmp_path / f, "impact", 20, **{"/time/steps": 61, "/formulation": {"name": f, "d_hat_m": 0.005, "stiffness_policy": {"kappa_N_per_m": 10000}}})
            for f in ("log", "cubic"))
    reference = refined(a, b, "middle")
    for motion in (a, b):
        found, skipped = measure(motion, reference)
        assert found["e_traj"] == pytest.approx(reference.band["e_traj"] / 2) and found["e_traj"] > 0
        assert {"e_gap", "e_momentum", "e_energy"} <= set(skipped)
    with pytest.raises(NoReference, match="other frames"):
        refined(a, scene(program, tmp_path / "other", "impact", 30, **{"/time/steps": 61}), "middle")


def test_the_last_frame_is_the_end_whatever_the_frames_between(program, tmp_path):
    """The last state of a run has a frame of its own; a motion that lacks it is reported and measured by nothing."""
    motion = scene(program, tmp_path, "stack", 25)
    last = motion.record["steps"][-1]
    assert last["step"] % 25 != 0 and motion.times[-1] == last["t_s"] and len(motion.times) == 2 + last["step"] // 25 + 1
    assert 1e-4 < measure(motion, CLOSED_FORMS["rigid_stack"]())[0]["e_offset"] < 4 * 0.004
    with pytest.raises(NoReference, match=r"the last frame is of \S+ s and the run ends at \S+ s"):
        measure(replace(motion, frames=motion.frames[:-1], times=motion.times[:-1]), CLOSED_FORMS["rigid_stack"]())
