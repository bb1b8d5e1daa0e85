"""Verdicts on made-up runs and counts: each is seen green and red, and red when nothing was judged."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.stress import verb
from barrierbench_analysis.studies.stress import exact
from barrierbench_analysis.studies.stress.entry import ROOT, ids, read_test
from barrierbench_analysis.studies.stress.geometry import Count, _judge_ccd
from barrierbench_analysis.studies.stress.geometry import judge as judge_count
from barrierbench_analysis.studies.stress.relations import relations
from barrierbench_analysis.studies.stress.report import markdown, text
from barrierbench_analysis.studies.stress.run import Row, judge
from barrierbench_analysis.studies.stress.table import FILE, Result, read, write

CASES = ("d_hat", "one ulp less", "one ulp more")


def rows(gaps=(0.5, 0.5, 0.5), formulations=("log", "cubic"), **more):
    return [Row("M09", case, f, "ok", "", gap_end_rel=gap, contacts=3, state_hash=f"{gap}", expected=("ok",), as_expected=True, **more) for f in formulations for case, gap in zip(CASES, gaps)]


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
    needy = replace(test, cases=tuple(replace(case, needs=({"pointer": "/precision", "value": "float"},)) if case.label == CASES[2] else case for case in test.cases))
    found = relations(needy, rows((0.1, 0.2, 0.9)))[0]
    assert found.judged == 6 and not found.holds and found.broken[0].startswith("log, one ulp more")
    waiting = [replace(row, outcome="waits", gap_end_rel=None) if row.case == CASES[2] else row for row in rows()]
    found = relations(needy, waiting)[0]
    assert (found.judged, found.not_judged, found.holds) == (4, 0, True)


def test_a_relation_that_judged_nothing_does_not_hold():
    found = related({"kind": "equal", "within": 1}, [replace(row, gap_end_rel=None) for row in rows()])
    assert (found.judged, found.not_judged, found.holds) == (0, 2, False)
    stalled = related({"kind": "equal", "within": 1}, [replace(row, outcome="newton_stall") for row in rows()])
    assert stalled.judged == 0 and not stalled.holds


def test_a_relation_of_some_formulations_leaves_the_others():
    assert related({"kind": "equal", "within": 0.01, "formulations": ["log"]}, rows() + rows((0.1, 0.2, 0.3), ("quadratic",))).holds


def test_outcomes_against_expectations():
    row, test = rows()[0], read_test("M09")
    assert judge(replace(row), test).as_expected and not judge(replace(row, outcome="newton_stall"), test).as_expected
    idle = judge(replace(row, contacts=0), test)
    assert not idle.as_expected and "no contact" in idle.detail
    test.data["expect"][0]["outcomes"] = ["not_valid", "unproven", "newton_stall"]
    for outcome in ("not_valid", "unproven"):  # these came to the end as well
        idle = judge(replace(row, outcome=outcome, contacts=0), test)
        assert not idle.as_expected and "no contact" in idle.detail and judge(replace(row, outcome=outcome), test).as_expected
    assert judge(replace(row, outcome="newton_stall", contacts=0), test).as_expected  # contacts are counted at step ends, and it has none
    test.data["expect"][0]["outcomes"] = ["ok"]
    test.data["contacts"] = False
    assert judge(replace(row, contacts=0), test).as_expected


def test_a_known_defect_excuses_its_outcome_and_no_other():
    test = read_test("M09")
    test.data["defects"] = [{"formulations": ["log"], "cases": ["d_hat"], "outcomes": ["not_pd"], "why": "that"}]
    found = lambda outcome, k=0: judge(replace(rows()[k], outcome=outcome), test)
    assert found("not_pd").defect == "that" and not found("not_pd").as_expected
    assert not found("ccd_cap").defect and not found("not_pd", 1).defect and not found("ok").defect
    excused = Result([found("not_pd"), *rows()[1:]])
    assert excused.as_expected and not Result([found("ccd_cap"), *rows()[1:]]).as_expected
    page = markdown({"M09": excused}, {"M09": test})
    assert "*not_pd*" in page and "1 runs | that" in page and "no run shows it any more" in markdown({"M09": Result(rows())}, {"M09": test})


def test_what_judged_nothing_is_red():
    assert Result(rows()).as_expected and not Result().as_expected
    assert not Result([replace(row, outcome="waits", as_expected=False) for row in rows()]).as_expected
    assert not Result(rows() + [replace(rows()[0], as_expected=False)]).as_expected


def test_counts_against_expectations():
    test = read_test("S02")
    case = "edge_edge offset 1 m, above 10 ulps"
    count = lambda judged, through: judge_count(Count("S02", case, "float", judged, {"let_through": through, "early": 3}), test)
    assert count(5, 0).as_expected and not count(5, 1).as_expected and not count(0, 0).as_expected
    assert judge_count(Count("S02", "x below 10 ulps", "float", 5, {"let_through": 5, "early": 0}), test).as_expected
    with pytest.raises(UserError, match="nothing is expected of half"):
        judge_count(Count("S02", case, "half", 5, {"let_through": 0, "early": 0}), test)


def moving_point(way):
    """A point 0.5 above a triangle, that moves by way."""
    x0 = [exact.point(p) for p in ((0.2, 0.2, 0.5), (0, 0, 0), (1, 0, 0), (0, 1, 0))]
    return x0, [exact.point((0.2, 0.2, 0.5 + way)), *x0[1:]]


@pytest.mark.parametrize("toi, hit, expected", [(0.499, True, (0, 0)), (0.5, True, (0, 0)), (0.501, True, (1, 0)), (0.9, False, (1, 0)), (0.3, True, (0, 1))])
def test_a_step_bound_that_lets_through_is_counted(toi, hit, expected):
    count = Count("S02", "c", "double", 0, {"let_through": 0, "early": 0})
    _judge_ccd(count, "point_triangle", *moving_point(-1.0), float(np.spacing(1.0)), {"hit": hit, "toi": toi - 1e-16 if toi == 0.5 else toi})
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


def test_the_table_is_read_as_it_was_written(tmp_path):
    result = Result(rows(newton=7), [Count("S02", "c", "float", 4, {"early": 1}, 2, "r", {"early": 2}, True)], [related({"kind": "rises"}, rows((1.0, 2.0, 3.0)))], {"date": "2024-01-31", "seconds": 1.5})
    write({"M09": result}, tmp_path / "t.json")
    assert read(tmp_path / "t.json") == {"M09": result} and read(tmp_path / "none.json") == {}


@pytest.mark.parametrize("kept", ['{"schema": "barrierbench.stress_res', '{"schema": "barrierbench.stress_results/1"}', "[]", '{"schema": "barrierbench.stress_results/1", "columns": [], "tests": {"M09": 3}}'])
def test_a_torn_table_is_refused(tmp_path, monkeypatch, capsys, kept):
    file = tmp_path / "stress.json"
    file.write_text(kept)
    with pytest.raises(UserError, match="stress.json: .*remove it, then ./bench study stress"):
        read(file)
    monkeypatch.setattr(verb, "FILE", file)
    assert verb.main(["M09", "--no-run"]) == 2 and "stress.json" in capsys.readouterr().err


def test_what_is_missing_is_named_with_its_file(tmp_path, capsys):
    assert verb.main(["M09", "--no-run", "--full", "--runs", str(tmp_path)]) == 2
    assert f"{tmp_path / 'full' / 'stress.json'}: nothing kept of M09: ./bench study stress M09 --full" in capsys.readouterr().err


def test_what_was_not_expected_stands_in_the_page_and_on_the_terminal():
    test = read_test("M09")
    bad = replace(rows()[0], outcome="ccd_cap", detail="why", as_expected=False)
    test.data["changed"] = [{"what": "log", "old": "ok", "new": "newton_stall", "why": "because of that"}]
    results = {"M09": Result([bad, *rows()[1:]], relations=[related({"kind": "rises"}, rows())], about={"date": "2024-01-31", "seconds": 2})}
    page, lines = markdown(results, {"M09": test}), text(results, {"M09": test})
    assert "ok 2, **ccd_cap**" in page and "because of that" in page and "5 of 6 runs" in page and "0 of 1 relations" in page
    assert "UNEXPECTED" in lines and "ccd_cap, expected ok: why" in lines and "rises from each to the next: log" in lines


def test_the_committed_page_is_that_of_the_committed_table():
    kept = read(FILE)
    assert kept, "results/stress.json is missing"
    assert (ROOT / "results" / "STRESS.md").read_text() == markdown(kept, {name: read_test(name) for name in ids()})
