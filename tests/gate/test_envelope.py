"""Envelopes, chaos and distributions, on numbers whose answer is known."""

import numpy as np
import pytest

from analysis.gate import invariants, judge, metrics
from analysis.gate.baseline import Kept
from analysis.gate.envelope import Envelope, calibrate, holm, ks_p_value
from analysis.gate.finding import without_subject
from analysis.gate.metrics import COND, GAP, LOWER_BETTER, NEWTON, PHYSICS, TWO_SIDED, Metric
from analysis.gate.records import Run

COND_METRIC = Metric("log10_cond full/none median", "III", "log10", TWO_SIDED, COND)
ITERATIONS = Metric("newton_iterations", "III", "1", LOWER_BETTER, NEWTON)
GAP_METRIC = Metric("gap_min", "III", "d_hat", TWO_SIDED, GAP)


def test_the_rule():
    values = np.linspace(100.0, 120.0, 21)  # quartiles 105 and 115, q05 101, q95 119
    e = calibrate(Metric("load", "III", "N", TWO_SIDED, PHYSICS), values)
    assert (e.value, e.lower, e.upper, e.n) == pytest.approx((110, 101 - 15, 119 + 15, 21))


@pytest.mark.parametrize("metric, value, half", [
    (COND_METRIC, 5.0, 0.05), (ITERATIONS, 10.0, 2.0), (ITERATIONS, 100.0, 5.0), (GAP_METRIC, 0.3, 0.02)])
def test_no_tighter_than_the_tolerance(metric, value, half):
    e = calibrate(metric, [value] * 21)
    assert (e.lower, e.upper) == pytest.approx((value - half, value + half)) and not e.sample


def test_a_spread_of_30_percent_is_chaos():
    assert not calibrate(ITERATIONS, [100] * 10 + [129] * 11).sample
    assert len(calibrate(ITERATIONS, [100] * 11 + [131] * 10).sample) == 21
    assert not calibrate(COND_METRIC, [5.0] * 10 + [5.11] * 11).sample
    assert calibrate(COND_METRIC, [5.0] * 10 + [5.12] * 11).sample  # a factor of 1.32


def test_nothing_is_calibrated_of_nothing():
    for values in ([], [1.0, float("nan")]):
        with pytest.raises(ValueError):
            calibrate(ITERATIONS, values)


def test_a_chaotic_metric_is_judged_by_its_distribution():
    random = np.random.default_rng(1)
    sample = tuple(random.lognormal(4, 0.5, 20))
    kept = Kept("III", "1", LOWER_BETTER, Envelope(50, 0, 100, 20, sample))
    same, shifted = random.lognormal(4, 0.5, 8).tolist(), random.lognormal(6, 0.5, 8).tolist()
    verdicts = [f.verdict for f in judge.distributions([("a", "m", kept, same), ("b", "m", kept, shifted)])]
    assert verdicts == ["pass", "FAIL"] and ks_p_value(sample, shifted) < 1e-3 < ks_p_value(sample, same)


def test_holm():
    assert holm([0.0004, 0.0004, 0.5]) == [False, False, False]  # each below 1e-3, none below a third of it
    assert holm([0.0003, 0.0004, 0.5]) == [True, True, False]


def test_costs_are_judged_one_by_one_and_together():
    def of(values, here):
        kept = {n: Kept("IV", "1", LOWER_BETTER, Envelope(100, 90, 110, 21)) for n in "abc"}
        lines = judge.numbers("case", kept, {Metric(n, "IV", "1", LOWER_BETTER, PHYSICS): v for n, v in zip("abc", values)}, here)
        return {f.metric: f.verdict for f in lines}

    assert of((100, 100, 103), True) == {"a": "pass", "b": "pass", "c": "pass", "geometric mean": "pass"}
    assert of((100, 100, 104), True)["c"] == "FAIL"
    assert of((102, 102, 102), True) == {"a": "pass", "b": "pass", "c": "pass", "geometric mean": "FAIL"}
    assert of((100, 100, 109), False) == {"a": "pass", "b": "pass", "c": "pass"}
    assert of((100, 100, 111), False)["c"] == "FAIL"


def test_judging_nothing_is_a_failure():
    assert [f.gate_class for f in without_subject([])] == ["I", "II", "III", "IV"]


def test_a_cost_that_was_0_or_unknown_and_appears_is_red():
    factorizations = next(metric for metric, _ in metrics.SUMMARY if metric.name == "factorizations")
    kept = judge.around({factorizations: 0.0})
    assert [f.verdict for f in judge.numbers("a", kept, {factorizations: 0.0}, True)] == ["pass"]
    assert [f.verdict for f in judge.numbers("a", kept, {factorizations: 500.0}, True)] == ["FAIL"]
    analyses = next(metric for metric, _ in metrics.SUMMARY if metric.name == "analyses")
    other = {factorizations: 0.0, analyses: 7.0}
    assert [f.verdict for f in judge.numbers("a", kept, other, True)] == ["pass", "FAIL"]
    assert [f.verdict for f in judge.numbers("a", kept, other | {analyses: 0.0}, True)] == ["pass", "not_judged"]
    assert [f.verdict for f in judge.numbers("a", {}, other, True)] == ["not_judged", "not_judged"]  # a baseline without class IV


def test_an_audit_that_holds_no_count_is_red(tmp_path):
    for found in ({"judged": 3, "crossings": None}, {"judged": 3, "crossings": "none"}, {"judged": 3}):
        lines = invariants.judge("a", Run(tmp_path, {"audit": found}))
        line = next(line for line in lines if line.metric == "crossings")
        assert line.verdict == "FAIL" and "no count" in line.note
