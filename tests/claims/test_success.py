"""The success that all methods share: simulated time, residual, gap, audit; each failure is named and counted, and unequal times are refused."""

import json

import pytest
from made import runs

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.kit import success
from barrierbench_analysis.studies.claims.entry import FOLDER, ids, read_claim, read_sweep, settings_of
from barrierbench_analysis.io.places import METHODS
from barrierbench_analysis.studies.claims.frontiers import has_runs, trials
from barrierbench_analysis.studies.claims.inputs import asked
from barrierbench_analysis.studies.kit.metrics import METRICS
from barrierbench_analysis.studies.claims.outcomes import hopeless, outcomes
from barrierbench_analysis.studies.claims.registry import rule_of
from barrierbench_analysis.studies.kit.success import COMMON, FAILURES, RESIDUAL, TIME
from barrierbench_analysis.studies.claims.table import Table, used_metrics
from barrierbench_analysis.studies.claims.verdict import HOLDS, NOT

PART = {"says": "x gets through", "sweep": "s", "case": "x", "over": "y", "bad": COMMON}
SIX = ("a", "b", "c", "d", "e", "f")


def step(t: float, **more) -> dict:
    return {"t_s": t, "status": "converged", "end_error_tolerances": 17.0, "gap_min_rel": 0.2, **more}


def record(steps=None, audit=None, **time) -> dict:
    return {"status": {"outcome": "ok", "valid": True}, "config": {"time": {"dt_s": 0.01, "steps": 2, **time}}, "steps": steps or [step(0.01), step(0.02)],
            "audit": {"enabled": True, "judged": 9, "crossings": 0, "violations": 0, "unproven": 0, "scene_faults": 0, **(audit or {})}}


def failed(made: dict) -> list[str]:
    return [name for name in FAILURES if METRICS[name][3](made)]


def test_a_success_fails_in_nothing():
    assert failed(record()) == []
    assert failed(record([step(0.01, gap_min_rel=None), step(0.02)])) == []  # no contact is beyond d_hat


@pytest.mark.parametrize("made, name", [
    (record([step(0.01)]), "short_of_time"),
    (record([step(0.01), step(0.02, status="step_collapse")]), "short_of_time"),
    (record([step(0.01), step(0.01999)]), "short_of_time"),
    (record([step(0.01), step(0.02)], duration_s=0.021), "short_of_time"),
    (record([step(0.01, end_error_tolerances=None), step(0.02)]), "without_residual"),
    (record([step(0.01, gap_min_rel=0.0499), step(0.02)]), "close_gap"),
    *((record(audit={key: 1}), "failed_audit") for key in ("crossings", "violations", "unproven", "scene_faults")),
    (record(audit={"judged": 0}), "failed_audit"), (record(audit={"enabled": False}), "failed_audit"),
    (record() | {"status": {"outcome": "ok", "valid": False}}, "not_valid")])
def test_what_falls_short_is_named(made, name):
    assert failed(made) == [name]


def test_the_sides_of_the_thresholds():
    assert failed(record([step(0.01, gap_min_rel=0.05), step(0.02 * (1 - 1e-10))])) == []
    assert failed(record([step(0.01), step(0.0295)], duration_s=0.0295)) == []  # a duration is requested, not steps of dt
    assert failed(record([step(0.01), step(0.0295)], duration_s=0.03)) == ["short_of_time"]
    assert success.residual_max(record([step(0.01, end_error_tolerances=3.0), step(0.02, end_error_tolerances=None)])) == 3 and success.residual_max({}) is None
    assert success.time_asked({"config": {"time": {"steps": 3}}}) is None and success.time_asked({}) is None


def good(**more) -> dict:
    return {**dict.fromkeys(FAILURES, 0.0), TIME: 0.4, RESIDUAL: 0.5, **more}


def test_runs_that_are_judged_are_counted_with_what_they_fail_in():
    made = runs(lambda s, lv, c, k: good(close_gap=float(c == "y"), failed_audit=float(c == "y" and s == "a"), **{RESIDUAL: 240.0 if c == "x" else None}), scenes=SIX)
    judged = outcomes(PART, made)
    assert judged.verdict == HOLDS and "; x: 90 judged, residuals up to 2.4e+02 tolerances; y: 90 judged, 90 close_gap, 15 failed_audit;" in judged.counted
    assert "gaps of at least 0.05 d_hat and a clean audit of the whole surface: x" in judged.measures
    assert outcomes({**PART, "case": "y", "over": "x"}, made).verdict == NOT


def test_an_outcome_that_is_ok_is_no_success_by_itself():
    made = runs(lambda s, lv, c, k: good(short_of_time=1.0) if s == "a" else good())
    assert all(row["outcome"] == "ok" for row in made.rows) and hopeless(made, COMMON) == {("a", level) for level in ("1", "2", "4")} and not hopeless(made)
    assert [trial.ok for trial in trials(runs(lambda s, lv, c, k: good(close_gap=float(k == 1), newton=3.0)), "x", "newton", COMMON)].count(False) == 9


def test_unequal_times_compare_nothing():
    made = runs(lambda s, lv, c, k: good(**{TIME: 0.4 if c == "x" else 0.04}))
    with pytest.raises(UserError, match=r"a 1: x is asked for 0.4 s and y for 0.04 s; equal simulated times are needed"):
        outcomes(PART, made)
    outcomes(PART, runs(lambda s, lv, c, k: good(**{TIME: 0.4 if s == "a" else 0.3})))  # scenes may differ
    with pytest.raises(UserError, match="no close_gap"):
        outcomes(PART, runs(lambda s, lv, c, k: good(close_gap=None)))


def test_all_that_it_reads_is_collected_and_registered():
    claim = read_claim("K4")
    assert {*FAILURES, TIME, RESIDUAL, "newton"} <= set(used_metrics([claim])["policies"]) and {*FAILURES, TIME, RESIDUAL} <= set(used_metrics([claim])["shells_policies"])
    assert {*FAILURES, TIME, RESIDUAL} <= rule_of(claim)["metrics"].keys()
    whole = runs(lambda s, lv, c, k: good(newton=3.0))
    assert has_runs(claim, Table({"policies": whole})) and not has_runs(claim, Table({"policies": runs(lambda s, lv, c, k: {"newton": 3.0})}))


def published() -> list:
    """Sweeps of claims with a case that stands for a publication."""
    names = {name for claim in map(read_claim, ids()) for name in (*claim.sweeps, *claim.confirmation_sweeps)}
    return [sweep for sweep in map(read_sweep, sorted(names)) if "published" in {place[2] for place in sweep.cases.values()}]


def test_what_is_called_published_is_a_whole_method():
    """No setting of the sweep, and none of its scenes, is one of the method's; all cases of a place have one simulated time."""
    assert {sweep.name for sweep in published()} == {"tight_limits", "policies", "shells_tight", "shells_policies"}
    for sweep in published():
        data = json.loads(sweep.path.read_text())
        case = next(case["set"] for case in data["axes"][1]["cases"] if case["label"] == "published")
        method = json.loads((METHODS / f"{case['/method']}.json").read_text())["set"]
        given = [case, data.get("set", {}), *(settings for axis in (data["axes"][0], *data["axes"][2:]) for _, settings in settings_of(axis, sweep.path))]
        assert not [pointer for settings in given for pointer in settings if any(pointer == own or own.startswith(pointer + "/") for own in method)], sweep.name
        assert sweep.solvers["published"] == "accumulated_toi"
        times = {}
        for note, config in asked(sweep):
            assert "steps" not in config["time"] and config["time"]["dt_s"] == (0.001 if sweep.cases[note][2] == "published" else 0.01), note
            times.setdefault(sweep.cases[note][:2], set()).add(config["time"]["duration_s"])
        assert all(len(found) == 1 for found in times.values()), sweep.name


def test_outcomes_beside_the_published_method_are_judged_by_the_common_success():
    parts = [part for claim in map(read_claim, ids()) for part in claim.parts if part.get("rule") == "outcomes" and "published" in (part.get("case"), part.get("over"))]
    deciding = [part for part in parts if not part.get("beside")]
    assert len(deciding) >= 4 and all(part.get("bad") == COMMON for part in deciding) and FOLDER.is_dir()


def test_a_bound_on_the_residual_is_a_failure_of_its_own():
    made = runs(lambda s, lv, c, k: good(**{RESIDUAL: 240.0 if c == "x" else 1.0}), scenes=SIX)
    assert "large_residual" not in outcomes(PART, made).counted
    bound = outcomes({**PART, "residual_at_most": 100}, made)
    assert bound.verdict == "does not hold" and "large_residual" in bound.counted and "at most 100 tolerances" in bound.measures
    assert outcomes({**PART, "residual_at_most": 240}, made).counted == outcomes(PART, made).counted
    with pytest.raises(UserError, match=RESIDUAL):
        outcomes({**PART, "residual_at_most": 100}, runs(lambda s, lv, c, k: good(**{RESIDUAL: None}), scenes=SIX))
