"""A Python class as a step solver: what it raises, what of it is wrong, what it may not do."""

import traceback

import numpy as np
import pytest
from python_newton import Newton, Scripted, solved_by, touching


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
    with pytest.raises(ZeroDivisionError, match="in my step solver") as reported:
        sim.step()
    assert "in script" in "".join(traceback.format_tb(reported.tb))
    assert sim.state_hash == before and sim.record()["steps"] == steps and not sim.done
    scripted.script = None
    assert sim.run().state_hash == bb.Simulation(solved_by(drape, "scripted")).run().state_hash


def test_a_whole_run_leaves_a_checkpoint_of_the_steps_before(bb, drape, scripted, tmp_path):
    drape["output"] = {"checkpoint_every": 1}
    config = solved_by(drape, "scripted")
    wanted = bb.run(config, out=tmp_path / "whole")

    def script(step):
        if step.index == 5:
            raise OSError("in step 5")
        return super(Scripted, scripted).advance(step)

    scripted.script = script
    with pytest.raises(OSError, match="in step 5"):
        bb.run(config, out=tmp_path / "run")
    assert not (tmp_path / "run/run.json").exists()
    scripted.script = None
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
            return scripted.advance(step)
        next(step.iterations())
        return "line_search_failed"

    scripted.script = script
    sim = bb.Simulation(solved_by(drape, "scripted", retries=2))
    assert sim.step()["retries"] == 1 and lengths == [0.01, 0.005]


@pytest.mark.parametrize(
    "script, error, reported",
    [
        (lambda step: None if next(step.iterations()) == 0 else "", "ConfigError", "None returned by advance; allowed: one of conv"),
        (lambda step: "done" if next(step.iterations()) == 0 else "", "ConfigError", "'done' returned by advance"),
        (lambda step: "converged", "RuntimeError", "before its first iteration"),
        (lambda step: step.solve(), "RuntimeError", "no iteration is under way"),
        (lambda step: [step.bound() for _ in step.iterations()], "RuntimeError", "no direction"),
        (lambda step: [(step.solve(), step.accept()) for _ in step.iterations()], "RuntimeError", "not feasible"),
        (lambda step: [(step.solve(), step.solve()) for _ in step.iterations()], "RuntimeError", "a direction already"),
        (lambda step: [(step.solve(), step.trial(1.5)) for _ in step.iterations()], "ValueError", "alpha = 1.5"),
        (lambda step: [step._core.set_direction(np.zeros(1)) for _ in step.iterations()], "ValueError", "found 1 numbers; allowed: "),
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
def test_what_is_wrong_in_a_step_is_named(bb, drape, scripted, script, error, reported):
    drape["step_solver"] = {"name": "scripted", "max_iterations": 2}
    scripted.script = script
    sim = bb.Simulation(drape)
    before = sim.state_hash
    errors = {"ConfigError": bb.ConfigError, "RuntimeError": RuntimeError, "ValueError": ValueError}
    with pytest.raises(errors[error], match=reported):
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
    "fault, reported",
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
def test_a_declaration_that_does_not_hold_is_refused(bb, fault, reported):
    with pytest.raises(bb.ConfigError, match=reported):
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


def test_a_trial_does_not_outlive_the_bound_that_comes_after_it(bb, drape, scripted):
    """What was tried without a bound may have passed through a surface."""
    seen = []

    def script(step):
        next(step.iterations())
        assert not step.solve()
        assert step.trial(1e-3) is not None
        assert step.bound() > 0
        with pytest.raises(RuntimeError, match="the last trial was not feasible, or there was none"):
            step.accept()
        assert step.feasible(1e-3 * step.bound())
        step.accept()
        seen.append(step.index)
        return "iteration_cap"

    sim = touching(bb, solved_by(drape, "scripted"))
    scripted.script = script
    sim.step()
    assert sim.outcome == "newton_stall" and len(seen) == 1
