"""Envelopes, chaos and distributions, on numbers whose answer is known."""

import numpy as np
import pytest

from barrierbench_analysis.studies.gate import baseline, invariants, judge, metrics, shares
from barrierbench_analysis.studies.gate import calibrate as calibration
from barrierbench_analysis.studies.gate.baseline import Kept
from barrierbench_analysis.studies.gate.drift import First
from barrierbench_analysis.studies.gate.envelope import KS_LEVEL, Envelope, calibrate, ks_p_value
from barrierbench_analysis.studies.gate.finding import without_subject
from barrierbench_analysis.studies.gate.metrics import COND, COST, GAP, LOWER_BETTER, NEWTON, PCG, PHYSICS, TWO_SIDED, Metric
from barrierbench_analysis.studies.gate.records import Run
from barrierbench_analysis.tables.statistics import holm

COND_METRIC = Metric("log10_cond full/none median", "III", "log10", LOWER_BETTER, COND)
ITERATIONS = Metric("newton_iterations", "III", "1", LOWER_BETTER, NEWTON)
PCG_METRIC = Metric("probe_pcg_median", "III", "1", LOWER_BETTER, PCG)
GAP_METRIC = Metric("gap_min", "III", "d_hat", TWO_SIDED, GAP)


def test_the_rule():
    values = np.linspace(100.0, 120.0, 21)  # quartiles 105 and 115, q05 101, q95 119
    e = calibrate(Metric("load", "III", "N", TWO_SIDED, PHYSICS), values)
    assert (e.value, e.lower, e.upper, e.n) == pytest.approx((110, 101 - 15, 119 + 15, 21))


@pytest.mark.parametrize("metric, value, half", [
    (COND_METRIC, 5.0, 0.05), (ITERATIONS, 10.0, 2.0), (ITERATIONS, 100.0, 5.0), (ITERATIONS, 2.0, 1.0), (PCG_METRIC, 9.0, 4.5)])
def test_no_tighter_than_the_tolerance(metric, value, half):
    e = calibrate(metric, [value] * 21)
    assert (e.lower, e.upper) == pytest.approx((value - half, value + half)) and not e.sample


@pytest.mark.parametrize("gap", [0.3, 0.015, 1e-6])
def test_a_gap_moves_by_a_factor(gap):
    e = calibrate(GAP_METRIC, [gap] * 21)
    assert (e.lower, e.upper) == pytest.approx((gap / 10**0.02, gap * 10**0.02))
    near = calibrate(GAP_METRIC, [0.9] * 21)
    assert (near.lower, near.upper) == pytest.approx((0.88, 0.92))  # no wider than 0.02 d_hat


def test_no_scatter_lets_a_gap_reach_0():
    e = calibrate(GAP_METRIC, [0.01] * 10 + [0.015] * 11)
    assert 0 < e.lower < 0.01 and e.sample  # chaotic: judged by its distribution
    assert calibrate(GAP_METRIC, [0.0] * 21).lower == -0.02  # 0 has no logarithm


def test_a_small_count_with_honest_scatter_is_green_and_its_double_is_red():
    random = np.random.default_rng(2)
    values = random.choice([8.0, 9.0, 10.0], 21)
    for k, value in enumerate(values):  # each held against the others
        kept = baseline.keep(PCG_METRIC, calibrate(PCG_METRIC, np.delete(values, k)))
        lines = judge.numbers("case", {PCG_METRIC.name: kept}, {PCG_METRIC: value}, False)
        assert [f.verdict for f in lines] == ["pass"]
        assert [f.verdict for f in judge.numbers("case", {PCG_METRIC.name: kept}, {PCG_METRIC: 18.0}, False)] == ["FAIL"]


def test_shares_of_words():
    """Of 100 condition numbers 2 may change their status; a word that nobody has seen is judged against 0, and one that is gone is 0."""
    def of(**words):
        return {shares.metric("status full/none", word): n / 100 for word, n in words.items()}

    kept = judge.around(of(ok=98, lower_bound=2))
    verdicts = {f.metric.split(": ")[1]: f.verdict for f in judge.numbers("case", kept, of(ok=50, failed=50), False)}
    assert verdicts == {"ok": "FAIL", "lower_bound": "pass", "failed": "FAIL"}
    assert {f.verdict for f in judge.numbers("case", kept, of(ok=97, lower_bound=2, failed=1), False)} == {"pass"}
    half = judge.around(of(ok=50, lower_bound=50))
    assert {f.verdict for f in judge.numbers("case", half, of(ok=100), False)} == {"better"}
    assert {f.verdict for f in judge.numbers("case", kept, {}, False)} == {"FAIL"}  # the family is gone


def test_a_word_that_a_few_copies_have_is_a_share_of_0_in_the_others(monkeypatch):
    ok, bound = shares.metric("status a", "ok"), shares.metric("status a", "bound")
    load = Metric("load", "III", "N", TWO_SIDED, PHYSICS)
    monkeypatch.setattr(calibration, "measure", lambda run: run)
    values, unsteady = calibration.samples([{ok: 1.0, load: 3.0}, {ok: 0.9, bound: 0.1}])
    assert values == {ok: [1.0, 0.9], bound: [0.0, 0.1]} and unsteady == ["load"]


@pytest.mark.parametrize("metric, first, last, run, verdict", [
    (COND_METRIC, 5.0, 5.04, 5.09, "pass"), (COND_METRIC, 5.0, 5.08, 5.12, "drift"), (COND_METRIC, 5.0, 4.9, 4.86, "pass"),  # better is no drift
    (GAP_METRIC, 1e-3, 0.93e-3, 0.9e-3, "drift"), (GAP_METRIC, 1e-3, 0.96e-3, 0.93e-3, "pass"),
    (Metric("solves", "IV", "1", LOWER_BETTER, COST), 100.0, 106.0, 107.0, "drift"), (Metric("solves", "IV", "1", LOWER_BETTER, COST), 100.0, 103.0, 105.0, "pass")])
def test_a_drift_is_twice_the_tolerance_from_the_first(metric, first, last, run, verdict):
    kept = baseline.keep(metric, calibrate(metric, [last]))
    kept.first = First(first, here=True)
    lines = [f for f in judge.numbers("case", {metric.name: kept}, {metric: run}, True) if f.metric == metric.name]
    assert [f.verdict for f in lines] == [verdict]


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
    assert [p < KS_LEVEL for p in holm([0.0004, 0.0004, 0.5])] == [False, False, False]  # each below 1e-3, none below a third of it
    assert [p < KS_LEVEL for p in holm([0.0003, 0.0004, 0.5])] == [True, True, False]
    assert holm([0.2, 0.01, 0.02]) == pytest.approx([0.2, 0.03, 0.04]) and holm([0.5, 0.9]) == [1.0, 1.0] and holm([]) == []


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


def test_a_cost_may_be_what_copies_of_one_program_reach():
    probes = Metric("ccd_probes", "IV", "1", LOWER_BETTER, COST)
    kept = calibration.envelopes({probes: [100.0, *np.linspace(96, 106, 20)]})
    assert kept["ccd_probes"].scatter > 112 and kept["ccd_probes"].envelope.value == 100

    def of(value):
        return {f.verdict for f in judge.numbers("case", kept, {probes: value}, True)}

    assert of(109.0) == {"pass"} and of(120.0) == {"FAIL"}


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
    assert [f.verdict for f in judge.numbers("a", {}, other, True)] == ["not_judged", "FAIL"]  # 0 of something is nothing


def test_an_audit_that_holds_no_count_is_red(tmp_path):
    for found in ({"judged": 3, "crossings": None}, {"judged": 3, "crossings": "none"}, {"judged": 3}):
        lines = invariants.judge("a", Run(tmp_path, {"audit": found}))
        line = next(line for line in lines if line.metric == "crossings")
        assert line.verdict == "FAIL" and "no count" in line.note
