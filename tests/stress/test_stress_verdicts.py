"""Verdicts on made-up rows and counts: each is seen green and red, and red when nothing was judged."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.kit.study import page
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.studies.rules import stress
from barrierbench_analysis.studies.rules.stress import exact
from barrierbench_analysis.studies.rules.stress.entry import read_test
from barrierbench_analysis.studies.rules.stress.geometry import Count, judge_ccd
from barrierbench_analysis.studies.rules.stress.geometry import judge as judge_count
from barrierbench_analysis.studies.rules.stress.relations import relations
from barrierbench_analysis.studies.rules.stress.results import Result, result_of, run_of

CASES = ("d_hat", "one ulp less", "one ulp more")
NAMES = ("detail", "seconds", "newton", "linear", "contacts", "gap_min_rel", "gap_min_ulps", "gap_end_rel", "state_hash", "counts")
ORIGIN = {"date": "2024-01-31", "machine": "m", "commit": "c", "build": "b"}


def row(case, formulation, outcome="ok", **values):
    of = {**dict.fromkeys(NAMES), "detail": "", "contacts": 3, **values}
    return Row(f"{formulation} {case}", {"test": "M09", "formulation": formulation, "case": case}, outcome, of, dict.fromkeys(of, ""), 9, 1.0, "r", ORIGIN)


def rows(gaps=(0.5, 0.5, 0.5), formulations=("log", "cubic"), **more):
    return [row(case, f, gap_end_rel=gap, state_hash=f"{gap}", **more) for f in formulations for case, gap in zip(CASES, gaps)]


def with_values(one, **values):
    return replace(one, values={**one.values, **values})


def ended(one, outcome, **values):
    return replace(with_values(one, **values), outcome=outcome)


def related(entry, made):
    test = read_test("M09")
    test.data["relations"] = [{"metric": "gap_end_rel", "reason": "r", **({} if entry["kind"] == "bound" else {"groups": [list(CASES)]}), **entry}]
    return relations(test, made)[0]


@pytest.mark.parametrize("entry, good, bad", [
    ({"kind": "equal", "within": 0.01}, (0.5, 0.501, 0.502), (0.5, 0.5, 0.52)), ({"kind": "differs", "beyond": 0.1}, (0.5, 0.6, 0.5), (0.5, 0.5, 0.51)),
    ({"kind": "rises"}, (0.1, 0.2, 0.3), (0.1, 0.3, 0.2)), ({"kind": "equal", "metric": "state_hash", "within": 0}, (0.5, 0.5, 0.5), (0.5, 0.5, 0.6)),
    ({"kind": "differs", "metric": "state_hash", "beyond": 0}, (0.1, 0.2, 0.3), (0.1, 0.2, 0.2)),
    ({"kind": "ratio", "above": 1, "below": 2, "groups": [["one ulp less", "d_hat"]]}, (0.1, 0.15, 0), (0.1, 0.3, 0)), ({"kind": "bound", "below": 0.5}, (0.1, 0.2, 0.5), (0.1, 0.2, 0.6))])
def test_relations(entry, good, bad):
    assert related(entry, rows(good)).holds and related(entry, rows(good)).judged >= 2
    found = related(entry, rows(bad))
    assert not found.holds and found.broken[0].startswith("log")


def test_zeros_that_are_equal_differ_by_nothing():
    none = rows((0.0, 0.0, 0.0))
    assert related({"kind": "equal", "within": 0}, none).holds
    differs = related({"kind": "differs", "beyond": 0.1}, none)
    assert differs.judged == 2 and differs.broken[0] == "log, d_hat, then one ulp less, then one ulp more: 0"
    some = rows((0.0, 0.0, 0.5))
    assert related({"kind": "differs", "beyond": 0.1}, some).holds and not related({"kind": "equal", "within": 10}, some).holds


@pytest.mark.parametrize("gaps", [(0.0, 0.1, 0.2), (0.1, 0.0, 0.2), (0.1, 0.2, 0.0), (0.0, 0.0, 0.0)])
@pytest.mark.parametrize("entry", [{"kind": "rises"}, {"kind": "ratio", "above": 0, "below": 2}])
def test_what_is_over_zero_is_not_judged(entry, gaps):
    found = related(entry, rows(gaps))
    if entry["kind"] == "rises" or 0 in gaps[:2]:
        assert (found.judged, found.not_judged, found.holds) == (0, 2, False)
    mixed = related(entry, rows(gaps, ("log",)) + rows((0.1, 0.2, 0.3), ("cubic",)))
    assert mixed.holds and mixed.judged >= 1


def test_a_bound_on_every_run_takes_all_that_ran():
    test = read_test("M09")
    test.data["relations"] = [{"metric": "gap_end_rel", "kind": "bound", "below": 0.5, "reason": "r"}]
    found = relations(test, rows((0.1, 0.2, 0.9)))[0]
    assert found.judged == 6 and not found.holds and found.broken[0].startswith("log, one ulp more")
    found = relations(test, [one for one in rows() if one.place["case"] != CASES[2]])[0]
    assert (found.judged, found.not_judged, found.holds) == (4, 0, True)


def test_a_relation_that_judged_nothing_does_not_hold():
    found = related({"kind": "equal", "within": 1}, [with_values(one, gap_end_rel=None) for one in rows()])
    assert (found.judged, found.not_judged, found.holds) == (0, 2, False)
    stalled = related({"kind": "equal", "within": 1}, [ended(one, "newton_stall") for one in rows()])
    assert stalled.judged == 0 and not stalled.holds


def test_a_relation_of_some_formulations_leaves_the_others():
    assert related({"kind": "equal", "within": 0.01, "formulations": ["log"]}, rows() + rows((0.1, 0.2, 0.3), ("quadratic",))).holds


def test_a_relation_of_cases_that_were_not_all_run_is_left_out():
    test = read_test("M09")
    test.data["relations"] = [{"metric": "gap_end_rel", "kind": "rises", "groups": [list(CASES)], "reason": "r"}]
    assert relations(test, rows()) and not relations(test, [one for one in rows() if one.place["case"] != CASES[2]])


def test_outcomes_against_expectations():
    one, test = rows()[0], read_test("M09")
    assert run_of(one, test).as_expected and not run_of(ended(one, "newton_stall"), test).as_expected
    idle = run_of(with_values(one, contacts=0), test)
    assert not idle.as_expected and "no contact" in idle.detail
    test.data["expect"][0]["outcomes"] = ["not_valid", "unproven", "newton_stall"]
    for outcome in ("not_valid", "unproven"):  # these came to the end as well
        idle = run_of(ended(one, outcome, contacts=0), test)
        assert not idle.as_expected and "no contact" in idle.detail and run_of(ended(one, outcome), test).as_expected
    assert run_of(ended(one, "newton_stall", contacts=0), test).as_expected  # contacts are counted at step ends, and it has none
    test.data["expect"][0]["outcomes"] = ["ok"]
    test.data["contacts"] = False
    assert run_of(with_values(one, contacts=0), test).as_expected


def result(test, made):
    return result_of(test, made)


def page_of(test, made, monkeypatch):
    """The page of a study of this test alone."""
    study = read_study("stress")
    monkeypatch.setattr(stress, "tests", lambda study: [test])
    return page.text_of(study, made, stress.rule(study, made))


def test_a_known_defect_excuses_its_outcome_and_no_other(monkeypatch):
    test = read_test("M09")
    test.data["defects"] = [{"formulations": ["log"], "cases": ["d_hat"], "outcomes": ["not_pd"], "why": "that"}]
    found = lambda outcome, k=0: run_of(ended(rows()[k], outcome), test)
    assert found("not_pd").defect == "that" and not found("not_pd").as_expected
    assert not found("ccd_cap").defect and not found("not_pd", 1).defect and not found("ok").defect
    excused = [ended(rows()[0], "not_pd"), *rows()[1:]]
    assert result(test, excused).as_expected and not result(test, [ended(rows()[0], "ccd_cap"), *rows()[1:]]).as_expected
    text = page_of(test, excused, monkeypatch)
    assert "| ok 2, *not_pd* |" in text and "1 runs | that" in text and "1 show a known defect" in text
    assert "no run shows it any more" in page_of(test, rows(), monkeypatch)


def test_what_judged_nothing_is_red():
    test = read_test("M09")
    assert result(test, rows()).as_expected and not Result(test).as_expected
    assert not result(test, [*rows(), ended(rows()[0], "ccd_cap")]).as_expected


def test_counts_against_expectations():
    test = read_test("S02")
    case = "edge_edge offset 1 m, above 10 ulps"
    holds = lambda judged, through, case=case: judge_count(Count(case, judged, 0, {"let_through": through, "early": 3}), "float", test)[1]
    assert holds(5, 0) and not holds(5, 1) and not holds(0, 0)
    assert holds(5, 5, "x below 10 ulps")
    with pytest.raises(UserError, match="nothing is expected of half"):
        judge_count(Count(case, 5), "half", test)
    test.data["expect"][1]["most"] = {"late": 0}
    with pytest.raises(UserError, match="S02.json#/expect/1/most: found 'late'; one of let_through, early is needed"):
        holds(5, 0)


def moving_point(way):
    """A point 0.5 above a triangle, that moves by way."""
    x0 = [exact.point(p) for p in ((0.2, 0.2, 0.5), (0, 0, 0), (1, 0, 0), (0, 1, 0))]
    return x0, [exact.point((0.2, 0.2, 0.5 + way)), *x0[1:]]


@pytest.mark.parametrize("toi, hit, expected", [(0.499, True, (0, 0)), (0.5, True, (0, 0)), (0.501, True, (1, 0)), (0.9, False, (1, 0)), (0.3, True, (0, 1))])
def test_a_step_bound_that_lets_through_is_counted(toi, hit, expected):
    count = Count("c", numbers={"let_through": 0, "early": 0})
    judge_ccd(count, "point_triangle", *moving_point(-1.0), float(np.spacing(1.0)), {"hit": hit, "toi": toi - 1e-16 if toi == 0.5 else toi})
    assert (count.judged, tuple(count.numbers.values())) == (1, expected)


def test_exact_distances_and_times():
    x0, x1 = moving_point(-1.0)
    assert exact.point_triangle(x0) == Fraction(1, 4) and abs(exact.time_of_impact("point_triangle", x0, x1) - Fraction(1, 2)) < Fraction(1, 2**90)
    assert exact.time_of_impact("point_triangle", *moving_point(-0.25)) is None
    beside = [exact.point(p) for p in ((2, -1, 1), (0, 0, 0), (1, 0, 0), (0, 1, 0))]
    assert exact.point_triangle(beside) == 3
    crossing = [exact.point(p) for p in ((-1, 0, 0.5), (1, 0, 0.5), (0, -1, 0), (0, 1, 0))]
    assert exact.edge_edge(crossing) == Fraction(1, 4)
    apart = [exact.point(p) for p in ((0, 0, 0), (1, 0, 0), (3, 0, 1), (4, 0, 1))]  # parallel
    assert exact.edge_edge(apart) == 5


def test_exact_shapes_are_derivatives_of_each_other():
    step = 2.0**-20
    for name in ("log", "log_squared", "quadratic", "cubic", "two_stage", "exponential"):
        for d in (0.2, 0.7):
            low, here, high = (exact.shape(name, d + k * step, 1.0) for k in (-1, 0, 1))
            for order in (0, 1):
                assert float((high[order] - low[order]) / 2) / step == pytest.approx(float(here[order + 1]), rel=1e-9)
        assert abs(exact.shape(name, 1 - 1e-12, 1.0)[0]) < 1e-20


def test_what_was_not_expected_stands_in_the_page_and_on_the_terminal(monkeypatch):
    test = read_test("M09")
    bad = ended(rows()[0], "ccd_cap", detail="why | not")
    test.data["changed"] = [{"what": "log", "old": "ok", "new": "newton_stall", "why": "because of that"}]
    test.data["relations"] = [{"metric": "gap_end_rel", "kind": "rises", "groups": [list(CASES)], "reason": "r"}]
    made = [bad, *rows()[1:]]
    text = page_of(test, made, monkeypatch)
    assert "| ok 2, **ccd_cap** |" in text and "because of that" in text and "5 of 6 runs" in text and "0 of 1 relations" in text
    assert "| M09 | log | d_hat | ccd_cap | ok | why / not |" in text and "**cubic, d_hat, then one ulp less, then one ulp more: 1**" in text
    lines, passed = stress.judged(read_study("stress"), made)
    assert not passed and lines[0] == "M09 log, d_hat: ccd_cap, expected ok: why | not" and "rises from each to the next: cubic" in lines[1]


def test_a_test_without_rows_is_not_on_the_page(monkeypatch):
    text = page_of(read_test("M09"), rows()[:2], monkeypatch)
    assert "2 of 2 runs ended" in text and "runs of the tests were not made" in text and "0 of 0 relations" in text
    assert "## Relations" not in text and "## Geometry" not in text and "## Known defects" not in text and "Nothing." in text
