"""Where a made barrier is better and where worse, what may be scored, and a whole score of the program."""

from dataclasses import replace
from pathlib import Path

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.studies.rules import score
from barrierbench_analysis.studies.rules.score import judge
from barrierbench_analysis.studies.rules.score.candidate import RIVALS, Candidate, candidate, fixed
from barrierbench_analysis.studies.rules.score.page import page
from barrierbench_analysis.studies.rules.score.verb import study_of
from barrierbench_analysis.studies.rules.stress.entry import read_test

ROOT = Path(__file__).resolve().parents[2]


def made(shape, scene="a", theta=0.1, **more):
    return {"scene": scene, "resolution": "6", "shape": shape, "limit": "off", "theta": theta, "outcome": "ok", "gap": theta, "gap_p05": theta / 2,
            "newton": 50, "pcg": 40, "cond_p95": 100.0, "bj_p95": 10.0, "row_ns": 100.0, **more}


def rows(**more):
    return [made(label, scene) for label in RIVALS for scene in "abc"] + [made("new", scene, **more) for scene in "abc"]


def found(of, metric):
    return {one.rival: one.verdict for one in judge.comparisons(of, "new") if one.metric == metric}


@pytest.mark.parametrize("newton, verdict", [(40, judge.BETTER), (50, judge.EVEN), (54, judge.EVEN), (60, judge.WORSE)])
def test_a_difference_of_ten_percent_counts(newton, verdict):
    assert found(rows(newton=newton), "newton") == dict.fromkeys(RIVALS, verdict)


def test_scenes_that_disagree_are_even():
    mixed = rows()
    mixed[-1]["newton"], mixed[-2]["newton"] = 20, 55
    assert found(mixed, "newton") == dict.fromkeys(RIVALS, judge.EVEN)


def test_a_run_that_failed_is_in_no_ratio_and_is_said_first():
    broken = rows(newton=10)
    broken[-1]["outcome"] = "stall_overload"
    assert all(one.scenes == 2 for one in judge.comparisons(broken, "new"))
    starts = [{"method": "new", "ok": 4, "of": 5, "others": ["timeout"], "newton": []}]
    cases = [{"test": "M10", "case": "load", "method": "new", "outcome": "stall_overload"}, {"test": "M10", "case": "load", "method": "log", "outcome": "ok"},
             {"test": "S09", "case": "r", "method": "new", "outcome": "ok"}, {"test": "S09", "case": "r", "method": "log", "outcome": "timeout"}]
    said = judge.decides(broken, starts, cases, "new")
    assert "c, theta 0.1: stall_overload" in said[0]
    assert "M10 load: stall_overload" in said[1] and "S09 r: log not ok" in said[2] and "1 of 5 jittered" in said[3]
    assert "Newton iterations" in said[4] and "better" in said[4]


def test_one_scene_decides_nothing():
    few = [row for row in rows(newton=10) if row["scene"] == "a"]
    assert found(few, "newton") == dict.fromkeys(RIVALS, judge.OPEN)
    ok = [{"method": "new", "ok": 5, "of": 5, "others": [], "newton": []}]
    [said] = judge.decides(few, ok, [], "new")
    assert "It differs from no other" in said


def test_off_target_counts_in_both_directions():
    for gap in (0.05, 0.2):
        assert judge.value(made("new", gap=gap), "off_target") == pytest.approx(2)
    assert judge.value(made("new", outcome="timeout"), "newton") is None


def test_one_slow_run_does_not_make_a_row_slow():
    busy = rows()
    for one, ns in zip((row for row in busy if row["shape"] == "log"), (100.0, None, None), strict=True):
        one["row_ns"] = ns
    busy += [made("log", "c", row_ns=110.0), made("log", "d", row_ns=9000.0)]
    assert judge.row_times(busy)["log"] == (110.0, 3) and "row_ns" not in {one.metric for one in judge.comparisons(busy, "new")}


@pytest.mark.parametrize("text, said", [("log", "found log; allowed: a barrier that is none of log, quadratic"), ("nothing_like_it", "none of that name"), ("d_hat - d", "the unit m")])
def test_what_cannot_be_scored_is_said(program, monkeypatch, text, said):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    with pytest.raises(UserError, match=said):
        candidate(text)


def test_presets_shapes_and_plugins(program, monkeypatch, build_folder):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    assert candidate("cubic_dynamic_lagged").formulation == {"name": "cubic_dynamic_lagged"}
    assert candidate("exponential:8").formulation["shape"] == "exponential:8"
    plugin = build_folder / "examples/plugins/plugin_inverse_shape.so"
    if not plugin.exists():
        pytest.skip("the examples of plugins are not built")
    of = candidate(str(plugin))
    assert of.formulation["shape"] == "inverse" and of.plugins == (str(plugin),)
    with pytest.raises(UserError, match="inverse"):
        candidate(f"{plugin}:another")


# --- the study of a candidate


@pytest.fixture
def study(program, monkeypatch, tmp_path):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    return study_of(Candidate("new", fixed("new", "exponential"), "a shape"), tmp_path)


def test_every_method_is_in_every_scene_start_and_hard_case(study):
    counts = {part: [cell for cell in study.cells if cell.place["part"] == part] for part in score.PARTS}
    assert {part: len(cells) for part, cells in counts.items()} == {"matched": 3 * 3 * 5, "start": 5 * 5, "hard": 12 * 5}
    for cells in counts.values():
        assert {cell.place["method"] for cell in cells} == {"new", *RIVALS}
    start = counts["start"][0]
    assert start.settings["/seeds/main"] == 1 and start.settings["/matching/theta"] == 0.1 and start.settings["/passes"]["diagnose"] is False
    assert counts["matched"][0].settings["/passes"]["diagnose"] is True


def test_a_hard_case_gives_the_candidate_the_stiffness_of_equal_capacity(study):
    by = {one.label: one for one in score.of_test(read_test("M10"), study)}
    cubic, new = by["cubic"].set[score.GIVEN_KAPPA], by["new"].set[score.GIVEN_KAPPA]
    assert cubic == 1000 and new == pytest.approx(2035.3, rel=1e-4)
    assert by["new"].set["/formulation"] == study.about["candidate"]["formulation"] and "/formulation/name" not in by["new"].set
    assert by["consistent"].set["/formulation/name"] == "cubic_dynamic_consistent"


def test_the_page_is_of_the_rows(study, unpainted):
    origin = {"date": "2026-01-01", "machine": "m", "commit": "c", "build": "b"}
    names = [*study.data["metrics"], *score.MEASURED]

    def of(cell):
        values = dict.fromkeys(names) | {"detail": "", "newton": 20 if cell.place["method"] == "new" else 40}
        if cell.place["part"] == score.MATCHED:
            values |= {"gap": float(cell.place["case"]), "gap_p05": 0.01, "pcg": 30, "cond_p95": 10.0, "bj_p95": 5.0, "row_ns": 70.0}
        return Row(cell.key, cell.place, "ok", values, dict.fromkeys(names, ""), 9, 1.0, "r", origin)

    rows = [of(cell) for cell in study.cells]
    rows[-1] = replace(rows[-1], outcome="crash")  # of the consistent stiffness
    lost = next(k for k, row in enumerate(rows) if row.place["method"] == "new")
    rows[lost] = replace(rows[lost], values={**rows[lost].values, "gap": None})
    found = score.rule(study, rows)
    assert found["decides"][0] == "It does not reach every target: stack, theta 0.5: no contact."
    assert found["decides"][1] == "It comes to the end where another fails: S18 n=8: consistent not ok."
    assert any("0.50 times those of log" in line for line in found["decides"]) and len(found["rows"]) == 45
    assert found["starts"][0] == {"method": "new", "ok": 5, "of": 5, "others": [], "newton": [20] * 5}
    content = {"candidate": {"label": "new", "about": "a < b"}, "command": "c", "machine": "m", "seconds": 1.0, **found}
    text = page(content)
    assert "a &lt; b" in text and "<td>0.50 better (3)</td>" in text and "<td>crash (40)</td>" in text
    assert text.count("<tr><td>stack</td>") == 15 and "<td class=n>20</td>" in text and '<th scope="col">over log</th>' in text
