"""A Python class as a step solver: the end states of the built-in one, and what it sees."""

import hashlib
from pathlib import Path

import numpy as np
import pytest
import python_newton
from python_newton import Newton, Solving, solved_by, touching


@pytest.mark.parametrize("own", [Newton, Solving])
def test_its_steps_end_where_those_of_line_search_end(bb, drape, own):
    bb.register_step_solver(own())
    drape["time"]["steps"] = 28
    near = {"tol_velocity_m_per_s": 1e-9}
    built = bb.Simulation(solved_by(drape, "line_search", **near)).run()
    mine = bb.Simulation(solved_by(drape, own.name, **near)).run()
    assert mine.outcome == built.outcome == "ok"
    tolerance = 1e-9 * 0.01  # m, of a step
    assert np.abs(mine.positions - built.positions).max() < 2 * 28 * tolerance
    assert np.abs(mine.positions - mine.scene.x0).max() > 0.1
    record, wanted = mine.record(), built.record()
    contacts = [step["contacts"]["total"] for step in record["steps"]]
    assert contacts == [step["contacts"]["total"] for step in wanted["steps"]] and contacts[-1] >= 50
    assert record["audit"]["enabled"] and record["audit"]["motions"] > 28
    assert record["audit"]["crossings"] == record["audit"]["unproven"] == 0
    assert max(step["end_error_m"] for step in record["steps"]) < 2 * tolerance
    assert record["summary"]["convergence"] == "not_asked"
    solves = record["summary"]["newton_iterations"] if own is Solving else 0
    assert record["summary"]["linear_solves"] >= solves and (solves > 0 or record["summary"]["linear_solves"] == 0)
    assert record["summary"]["hessian_fallbacks"] == record["summary"]["linear_solves"] - solves
    assert record["labels"]["step_solver"] == own.name
    (plugin,) = record["provenance"]["plugins"]
    assert plugin["name"] == own.name and plugin["file"].endswith("python_newton.py")
    assert plugin["sha256"] == hashlib.sha256(Path(python_newton.__file__).read_bytes()).hexdigest()


def test_its_counters_are_in_the_record(bb, drape):
    bb.register_step_solver(Newton())
    record = bb.Simulation(solved_by(drape, "plain_newton")).run().record()
    steps = [step["solver"] for step in record["steps"]]
    assert all(set(step) == {"plain_backtracks", "plain_slope_J"} for step in steps)
    assert record["summary"]["solver"]["plain_slope_J"] == min(step["plain_slope_J"] for step in steps) < 0
    trials = sum(step["line_search_trials"] for step in record["steps"])
    backtracks = sum(step["plain_backtracks"] for step in steps)
    assert record["summary"]["solver"]["plain_backtracks"] == backtracks
    assert backtracks == trials - sum(step["newton_iterations"] for step in record["steps"])


def driven_sheet():
    """Four of its vertices move by 3 mm a step."""
    body = {
        "name": "sheet",
        "mesh": {"generator": "grid", "n_x": 5, "n_y": 5, "size_x_m": 0.1, "size_y_m": 0.1},
        "material": {"youngs_N_per_m": 300, "density_kg_per_m2": 0.2, "bending_J": 1e-5},
        "pins": [{"indices": [0, 5, 18, 23], "motion": {"velocity_m_per_s": [0, 0, 0.3]}}],
    }
    return {
        "scene": {"name": "bodies", "bodies": [body]},
        "formulation": {"name": "cubic", "d_hat_m": 0.005, "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 500}},
        "matching": {"rule": "as_given"},
        "time": {"dt_s": 0.01, "steps": 3},
        "passes": {"time": False, "audit": True},
        "threads": 1,
    }


def test_prescribed_motion_is_lifted(bb, scripted):
    """The first direction of a step whose pins move, by scipy and by the program."""
    found = []

    def script(solve):
        def advance(step):
            scripted.script = None
            next(step.iterations())
            assert not step.at_target and not step.free.all()
            solve(step)
            given = ~step.free
            assert np.array_equal(step.direction[given], (step.target - step.x)[given])
            found.append(step.direction)
            return "iteration_cap"

        return advance

    for solve in (Newton().direct, Solving().direct):
        scripted.script = script(solve)
        bb.Simulation(solved_by(driven_sheet(), "scripted")).step()
    assert np.allclose(*found, rtol=0, atol=1e-12) and np.abs(found[0]).max() == pytest.approx(0.003)
    inner = np.abs(found[0][6:12, 2])  # pulled along by the pins
    assert inner.max() > 1e-4


def test_a_driven_run_ends_where_that_of_line_search_ends(bb):
    bb.register_step_solver(Newton())
    built = bb.Simulation(solved_by(driven_sheet(), "line_search")).run()
    mine = bb.Simulation(solved_by(driven_sheet(), "plain_newton")).run()
    assert mine.outcome == built.outcome == "ok"
    assert np.allclose(mine.positions, built.positions, rtol=0, atol=1e-8)
    assert np.abs(mine.positions[0] - mine.scene.x0[0]).max() == pytest.approx(0.009)


def test_what_it_sees_are_the_derivatives_of_the_energy(bb, drape, scripted):
    """E by trials along a small motion, against gradient and matrix, with contacts."""
    seen = {}

    def script(step):
        scripted.script = None
        for _ in step.iterations():
            matrix, right_side = step.system()
            free, gradient = step.free, step.gradient
            assert np.array_equal(right_side, -gradient[free]) and np.abs(right_side).max() > 0
            assert abs(matrix - matrix.T).max() == 0 and matrix.shape == (free.sum(),) * 2
            dx = np.random.default_rng(1).normal(size=free.sum()) * 1e-7
            step.direction = dx
            assert step.slope == pytest.approx(gradient[free] @ dx)
            change, rounding = step.trial(0.5)
            half, whole = change, step.trial(1.0).change
            curvature = 4 * (whole - 2 * half)
            seen.update(slope=(4 * half - whole, step.slope), curvature=(curvature, dx @ matrix @ dx))
            seen.update(rounding=rounding, energy=step.energy)
            step.accept()
            assert np.array_equal(step.x[free], (step.x - 0)[free])
            break
        return scripted.advance(step)

    sim = touching(bb, solved_by(drape, "scripted"))
    scripted.script = script
    sim.step()
    assert seen["slope"][0] == pytest.approx(seen["slope"][1], rel=1e-4) and seen["slope"][1] != 0
    assert seen["curvature"][0] == pytest.approx(seen["curvature"][1], rel=0.05) and seen["curvature"][1] > 0
    assert 0 < seen["rounding"] < 1e-3 * abs(seen["slope"][1]) and np.isfinite(seen["energy"])
