"""Where a made barrier is better and where worse, what may be scored, and a whole score of the program."""

from pathlib import Path

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.score import judge
from barrierbench_analysis.studies.score.candidate import RIVALS, candidate

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
    assert "Nothing here" in said


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


@pytest.mark.parametrize("text, said", [("log", "held against"), ("nothing_like_it", "none of that name"), ("d_hat - d", "the unit m")])
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
