"""Rule `outcomes`, parts together, and the sign test."""

import pytest
from made import runs

from analysis.claims.estimate import interval, sign_test, wilson
from analysis.claims.outcomes import outcomes
from analysis.claims.verdict import HOLDS, NOT, ONLY_IF, OPEN, Judged, together

PART = {"says": "x gets through", "sweep": "s", "case": "x", "over": "y"}


def failing(where):
    """where(scene, level, case) -> whether it stalls."""
    return lambda s, lv, c, k: {"outcome": "newton_stall" if where(s, lv, c) else "ok", "unsettled": float(where(s, lv, c))}


def test_through_everything_where_the_other_fails():
    judged = outcomes(PART, runs(failing(lambda s, lv, c: c == "y" and lv != "1")))
    assert judged.verdict == HOLDS and judged.value == 1 and "6 to 0" in judged.counted


def test_only_at_some_levels():
    made = runs(failing(lambda s, lv, c: (c == "y" and lv != "1") or (c == "x" and lv == "1" and s == "a")), levels=("1", "2", "4", "8"))
    judged = outcomes(PART, made)
    assert judged.verdict == ONLY_IF and judged.condition == "level 2, 4, 8; not 1"
    assert outcomes({**PART, "needs": "more"}, made).verdict == HOLDS


def test_no_more_than_the_other():
    assert outcomes(PART, runs(failing(lambda s, lv, c: False))).verdict == NOT
    assert outcomes(PART, runs(failing(lambda s, lv, c: c == "x" and lv != "1"))).verdict == NOT


def test_few_wins_tell_nothing():
    judged = outcomes(PART, runs(failing(lambda s, lv, c: c == "y" and lv == "1")))
    assert judged.verdict == OPEN and "3 wins and 0 losses" in judged.missing


def test_what_no_case_gets_through_is_left_out():
    judged = outcomes(PART, runs(failing(lambda s, lv, c: (s, lv) == ("a", "1") or (c == "y" and lv != "1")), levels=("1", "2", "4", "8")))
    assert judged.verdict == HOLDS and "a 1 left out" in judged.counted
    assert outcomes(PART, runs(failing(lambda s, lv, c: True))).verdict == OPEN


def test_another_failure_is_meant():
    made = runs(failing(lambda s, lv, c: c == "y"))
    for row in made.rows:
        row["outcome"] = "stall_overload"
    assert outcomes({**PART, "bad": "unsettled"}, made).verdict == HOLDS


def test_alone_and_too_little():
    alone = {"says": "", "sweep": "s", "case": "x"}
    assert outcomes(alone, runs(failing(lambda s, lv, c: False))).verdict == HOLDS
    assert outcomes(alone, runs(failing(lambda s, lv, c: s == "a" and c == "x"))).verdict == NOT
    assert outcomes(alone, runs(failing(lambda s, lv, c: False), scenes=("a", "b"))).missing.startswith("indication")


@pytest.mark.parametrize("verdicts, expected", [
    ([HOLDS, HOLDS], HOLDS), ([NOT, NOT], NOT), ([HOLDS, NOT], ONLY_IF), ([ONLY_IF, HOLDS], ONLY_IF), ([HOLDS, OPEN], OPEN), ([NOT, OPEN], NOT),
    ([HOLDS, NOT, OPEN], ONLY_IF)])
def test_parts_together(verdicts, expected):
    parts = [Judged(v, says=v, condition="level 1", missing="more") for v in verdicts]
    assert together(parts).verdict == expected
    assert together([*parts, Judged(NOT, beside=True)]).verdict == expected
    assert together(parts, "solids").verdict == OPEN and "waits for solids" in together(parts, "solids").missing


def test_intervals():
    cells = {s: {lv: [1.0, 2.0, 3.0, 4.0, 5.0] for lv in "123"} for s in "abc"}
    low, high = interval(cells)
    assert 2 < low < 3 < high < 4 and interval(cells) == (low, high)
    spread = interval({"a": cells["a"], "b": {lv: [10.0] * 5 for lv in "123"}, "c": cells["c"]})
    assert spread[1] - spread[0] > 3 * (high - low)  # scenes that differ widen it
    assert sign_test(6, 0) == pytest.approx(2 / 64) and sign_test(0, 0) == 1
    assert wilson(10, 10)[1] == pytest.approx(1) and wilson(10, 10)[0] == pytest.approx(0.722, abs=1e-3)
