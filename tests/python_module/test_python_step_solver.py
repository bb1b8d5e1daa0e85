"""A Python class as a step solver: the end states of the built-in one, what it sees, what it raises."""

import hashlib
import traceback
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

GUARANTEE = "no surface passes through another in the motion of any iteration"


class Newton:
    """Its direction by scipy, the step bound and trials of the program."""

    name, guarantee = "plain_newton", GUARANTEE
    counters = {"plain_backtracks": "trials beyond the first", "plain_slope_J": ("steepest slope", "smallest")}

    def direct(self, step):
        matrix, right_side = step.system()
        step.direction = spsolve(matrix.tocsc(), right_side)

    def advance(self, step):
        self.backtracks = self.slope = 0.0
        for _ in step.iterations():
            if failure := self.direct(step):
                return failure
            self.slope = min(self.slope, step.slope)
            alpha = bound if (bound := step.bound()) == 1 else 0.8 * bound
            while not self.goes(step, alpha):
                self.backtracks += 1
                alpha /= 2
                if alpha < 1e-14:
                    return "line_search_failed"
            step.accept()
            self.note(step)
            if step.converged():
                return "converged"
        return "iteration_cap"

    def goes(self, step, alpha):
        if not step.at_target:
            return step.feasible(alpha)
        trial = step.trial(alpha)
        return trial is not None and trial.falls_by(-1e-4 * alpha * step.slope)

    def note(self, step):
        step.counts |= {"plain_backtracks": self.backtracks, "plain_slope_J": self.slope}


class Solving(Newton):
    """Its direction by the linear solver of the program."""

    name, counters = "solving_newton", {}

    def direct(self, step):
        return step.solve()

    def note(self, step):
        pass


class Scripted(Solving):
    """Runs what a test hands it."""

    name, counters, script = "scripted", {"scripted_number": "what a test says"}, None

    def advance(self, step):
        return self.script(step) if self.script else super().advance(step)


@pytest.fixture
def scripted(bb):
    solver = Scripted()
    bb.register_step_solver(solver)
    return solver


def solved_by(config, name, **settings):
    return {**config, "step_solver": {"name": name, "tol_velocity_m_per_s": 1e-7, **settings}}


def touching(bb, config):
    """A simulation between two steps, with contacts."""
    sim = bb.Simulation(config)
    while not sim.record()["steps"] or sim.record()["steps"][-1]["contacts"]["total"] == 0:
        sim.step()
    return sim


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
    assert record["labels"]["step_solver"] == own.name
    (plugin,) = record["provenance"]["plugins"]
    assert plugin["name"] == own.name and plugin["file"].endswith("test_python_step_solver.py")
    assert plugin["sha256"] == hashlib.sha256(Path(__file__).read_bytes()).hexdigest()


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
        return Scripted.advance(scripted, step)

    sim = touching(bb, solved_by(drape, "scripted"))
    scripted.script = script
    sim.step()
    assert seen["slope"][0] == pytest.approx(seen["slope"][1], rel=1e-4) and seen["slope"][1] != 0
    assert seen["curvature"][0] == pytest.approx(seen["curvature"][1], rel=0.05) and seen["curvature"][1] > 0
    assert 0 < seen["rounding"] < 1e-3 * abs(seen["slope"][1]) and np.isfinite(seen["energy"])


def test_what_it_raises_ends_the_step_and_nothing_is_lost(bb, drape, scripted):
    def script(step):
        for iteration in step.iterations():
            assert not step.solve()
            assert step.trial(1e-3 * step.bound())
            step.accept()
            if iteration == 1:
                raise ZeroDivisionError("in my step solver")

    sim = touching(bb, solved_by(drape, "scripted"))
    before, steps = sim.state_hash, sim.record()["steps"]
    scripted.script = script
    with pytest.raises(ZeroDivisionError, match="in my step solver") as told:
        sim.step()
    assert "in script" in "".join(traceback.format_tb(told.tb))
    assert sim.state_hash == before and sim.record()["steps"] == steps and not sim.done
    scripted.script = None
    assert sim.run().state_hash == bb.Simulation(solved_by(drape, "scripted")).run().state_hash


def test_a_whole_run_leaves_a_checkpoint_of_the_steps_before(bb, drape, scripted, tmp_path):
    drape["output"] = {"checkpoint_every": 1}
    config = solved_by(drape, "scripted")
    wanted = bb.run(config, out=tmp_path / "whole")

    class Broken(Scripted):
        def advance(self, step):
            if step.index == 5:
                raise OSError("in step 5")
            return super().advance(step)

    bb.register_step_solver(Broken())
    with pytest.raises(OSError, match="in step 5"):
        bb.run(config, out=tmp_path / "run")
    assert not (tmp_path / "run/run.json").exists()
    bb.register_step_solver(scripted)
    seen = []
    record = bb.run(config, out=tmp_path / "run", resume=True, on_step=lambda row: seen.append(row["step"]))
    assert record["summary"]["state_hash"] == wanted["summary"]["state_hash"]
    assert min(seen) == 6 and wanted["steps"][-1]["contacts"]["total"] > 0


@pytest.mark.parametrize(
    "word, outcome",
    [("iteration_cap", "newton_stall"), ("non_finite", "nan"), ("linear_failed", "linear_failure")],
)
def test_a_failure_is_an_outcome(bb, drape, scripted, word, outcome):
    def script(step):
        next(step.iterations())
        step.detail = "as the test says"
        return word

    scripted.script = script
    sim = bb.Simulation(solved_by(drape, "scripted"))
    sim.step()
    assert sim.done and sim.outcome == outcome and "as the test says" in sim.detail


def test_a_step_that_fails_is_tried_again_shorter(bb, drape, scripted):
    lengths = []

    def script(step):
        lengths.append(step.h)
        if len(lengths) > 1:
            scripted.script = None
            return Scripted.advance(scripted, step)
        next(step.iterations())
        return "line_search_failed"

    scripted.script = script
    sim = bb.Simulation(solved_by(drape, "scripted", retries=2))
    assert sim.step()["retries"] == 1 and lengths == [0.01, 0.005]


@pytest.mark.parametrize(
    "script, error, told",
    [
        (lambda step: None if next(step.iterations()) == 0 else "", "ConfigError", "None returned by advance; allowed: one of conv"),
        (lambda step: "done" if next(step.iterations()) == 0 else "", "ConfigError", "'done' returned by advance"),
        (lambda step: "converged", "RuntimeError", "before its first iteration"),
        (lambda step: step.solve(), "RuntimeError", "no iteration is under way"),
        (lambda step: [step.bound() for _ in step.iterations()], "RuntimeError", "no direction"),
        (lambda step: [(step.solve(), step.accept()) for _ in step.iterations()], "RuntimeError", "not feasible"),
        (lambda step: [(step.solve(), step.solve()) for _ in step.iterations()], "RuntimeError", "a direction already"),
        (lambda step: [(step.solve(), step.trial(1.5)) for _ in step.iterations()], "ValueError", "alpha = 1.5"),
        (lambda step: [setattr(step, "direction", [1.0]) for _ in step.iterations()], "ConfigError", r"shape \(1,\)"),
        (
            lambda step: [setattr(step, "direction", step.x * np.nan) for _ in step.iterations()],
            "ConfigError",
            "not finite at vertex 0, x",
        ),
        (
            lambda step: step.counts.update(scripted_number=np.nan) or [*step.iterations()] and "converged",
            "ConfigError",
            r"counts\['scripted_number'\] = nan",
        ),
        (
            lambda step: step.counts.update(other=1) or [*step.iterations()] and "converged",
            "ConfigError",
            "counts of other, scripted_number; allowed: counts of scripted_number",
        ),
    ],
)
def test_what_is_wrong_in_a_step_is_named(bb, drape, scripted, script, error, told):
    drape["step_solver"] = {"name": "scripted", "max_iterations": 2}
    scripted.script = script
    sim = bb.Simulation(drape)
    before = sim.state_hash
    errors = {"ConfigError": bb.ConfigError, "RuntimeError": RuntimeError, "ValueError": ValueError}
    with pytest.raises(errors[error], match=told):
        sim.step()
    assert sim.state_hash == before and sim.steps == 0


def test_a_step_that_is_over_answers_nothing(bb, drape, scripted):
    kept = []

    def script(step):
        kept.extend([step, step.x, step.gradient])
        next(step.iterations())
        return "iteration_cap"

    scripted.script = script
    sim = bb.Simulation(solved_by(drape, "scripted"))
    sim.step()
    sim.close()
    step, x, _ = kept
    for call in (lambda: step.energy, step.solve, lambda: step.error, lambda: next(step.iterations())):
        with pytest.raises(RuntimeError, match="the step is over"):
            call()
    assert np.isfinite(x).all() and not x.flags.writeable


def test_an_error_of_a_hook_is_not_swallowed(bb, drape, scripted):
    def script(step):
        try:
            for _ in step.iterations():
                step.solve()
        except BaseException:
            pass
        return "converged"

    def hook(row):
        raise KeyError("of the hook")

    scripted.script = script
    sim = bb.Simulation(solved_by(drape, "scripted"), on_iteration=hook)
    with pytest.raises(RuntimeError, match="went on after an error(?s:.*)of the hook"):
        sim.step()
    assert sim.steps == 0


@pytest.mark.parametrize(
    "fault, told",
    [
        ({"advance": 3}, r"an object with advance\(step\)"),
        ({"name": "My Solver"}, "snake_case"),
        ({"guarantee": ""}, "guarantee ''; allowed: a sentence"),
        ({"counters": ["a"]}, r"counters \['a'\]; allowed: a dict"),
        ({"counters": {"No": "x"}}, "the counter 'No'"),
        ({"counters": {"number": ("x", "mean")}}, "of the counter number; allowed"),
        ({"counters": {"toi": "x"}}, 'the counter "toi"; allowed: one that no other'),
    ],
)
def test_a_declaration_that_does_not_hold_is_refused(bb, fault, told):
    with pytest.raises(bb.ConfigError, match=told):
        bb.register_step_solver(type("Bad", (Newton,), {"name": "bad_solver", **fault})())
    with pytest.raises(bb.ConfigError, match="bad_solver"):
        bb.resolve({"scene": "hang", "step_solver": {"name": "bad_solver"}})


def test_a_class_without_advance_is_refused(bb):
    with pytest.raises(bb.ConfigError, match=r"Nothing; allowed: an object with advance\(step\)"):
        bb.register_step_solver(type("Nothing", (), {"name": "nothing", "guarantee": "none"})())


def test_a_name_of_the_program_is_taken(bb):
    with pytest.raises(bb.ConfigError, match="not yet taken"):
        bb.register_step_solver(type("Mine", (Newton,), {"name": "line_search", "counters": {}})())


def test_the_same_name_again_keeps_its_declaration(bb):
    bb.register_step_solver(Newton())
    with pytest.raises(bb.ConfigError, match="other counters or another guarantee"):
        bb.register_step_solver(type("Other", (Newton,), {"counters": {"plain_other": "x"}})())


@pytest.mark.parametrize("device", ["host", "cuda"])
def test_a_device_refuses_it(bb, drape, device):
    bb.register_step_solver(Newton())
    with pytest.raises(bb.ConfigError, match="device"):
        bb.Simulation({**solved_by(drape, "plain_newton"), "device": device})
