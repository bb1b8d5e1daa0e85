"""Rule `outcomes`, parts together, and the sign test."""

import pytest
from made import runs

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.claims.outcomes import outcomes
from barrierbench_analysis.studies.claims.verdict import HOLDS, IN_PART, NOT, ONLY_IF, OPEN, Judged, together

PART = {"says": "x gets through", "sweep": "s", "case": "x", "over": "y"}
SIX = ("a", "b", "c", "d", "e", "f")  # fewer scenes cannot decide a sign test


def failing(where):
    """where(scene, level, case) -> whether it stalls."""
    return lambda s, lv, c, k: {"outcome": "newton_stall" if where(s, lv, c) else "ok", "unsettled": float(where(s, lv, c))}


def test_through_everything_where_the_other_fails():
    judged = outcomes(PART, runs(failing(lambda s, lv, c: c == "y" and lv != "1"), scenes=SIX))
    assert judged.verdict == HOLDS and judged.value == 1 and "won, lost, even: 6, 0, 0" in judged.counted and "12 to 0" in judged.counted
    assert (judged.lower, judged.scenes) == (pytest.approx(0.6097, abs=1e-3), 6)  # Wilson of 6 of 6 scenes, not of 90 runs


def test_only_at_some_levels():
    made = runs(failing(lambda s, lv, c: (c == "y" and lv != "1") or (c == "x" and lv == "1" and s == "a")), levels=("1", "2", "4", "8"), scenes=SIX)
    judged = outcomes(PART, made)
    assert judged.verdict == ONLY_IF and judged.condition == "level 2, 4, 8; not 1"
    assert outcomes({**PART, "needs": "more"}, made).verdict == HOLDS
    assert judged.value == pytest.approx(5 / 6) and judged.per_scene[0][:4] == ("a", 0.75, 0.0, 1.0)


def test_no_more_than_the_other():
    assert outcomes(PART, runs(failing(lambda s, lv, c: False))).verdict == NOT
    assert outcomes(PART, runs(failing(lambda s, lv, c: c == "x" and lv != "1"), scenes=SIX)).verdict == NOT


def test_a_scene_is_one_sign_whatever_levels_and_starts_it_has():
    """Three scenes that win at nine levels of nine starts each: three wins."""
    made = runs(failing(lambda s, lv, c: c == "y"), levels=tuple("123456789"), seeds=tuple(range(9)))
    judged = outcomes(PART, made)
    assert judged.verdict == OPEN and "3 scenes won, 0 lost, 0 even" in judged.missing and "of 3 scenes no outcome would, 6 are needed" in judged.missing


def test_a_scene_that_each_wins_as_often_is_even():
    even = runs(failing(lambda s, lv, c: (s, lv, c) in (("a", "1", "x"), ("a", "2", "y")) or (s != "a" and c == "y")), scenes=SIX)
    judged = outcomes(PART, even)
    assert judged.verdict == OPEN and "5 scenes won, 0 lost, 1 even" in judged.missing and "would" not in judged.missing


def test_scenes_that_are_all_even_decide_nothing():
    """Each gets through levels that the other does not: no win, and not the same either."""
    judged = outcomes(PART, runs(failing(lambda s, lv, c: (lv, c) in (("1", "x"), ("2", "y"))), scenes=SIX))
    assert judged.verdict == OPEN and "0 scenes won, 0 lost, 6 even" in judged.missing


def test_a_scene_in_which_one_start_fails_is_not_got_through():
    made = runs(lambda s, lv, c, k: {"outcome": "newton_stall" if (s, lv, c, k) == ("a", "2", "x", 3) else "ok"})
    judged = outcomes({"says": "", "sweep": "s", "case": "x"}, made)
    assert judged.value == pytest.approx(2 / 3) and judged.counted.startswith("every run in 2 of 3 scenes; 44 of 45 runs, mean share of scenes 0.978")


def test_a_case_that_is_asked_for_every_run_fails_where_all_fail():
    """It is compared with nothing there, and what it does not get through is no other's fault."""
    alone = {"says": "x gets through", "sweep": "s", "case": "x"}
    made = runs(failing(lambda s, lv, c: lv == "4"), levels=("1", "2", "4", "8"), scenes=SIX)
    judged = outcomes(alone, made)
    assert judged.verdict == ONLY_IF and judged.condition == "level 1, 2, 8; not 4" and judged.value == 0
    only = runs(failing(lambda s, lv, c: lv == "4"), levels=("1", "2", "4"), scenes=SIX, cases=("x",))
    assert outcomes(alone, only).verdict == ONLY_IF, "whatever other cases the sweep has"


def test_what_no_case_gets_through_is_left_out():
    judged = outcomes(PART, runs(failing(lambda s, lv, c: (s, lv) == ("a", "1") or (c == "y" and lv != "1")), levels=("1", "2", "4", "8"), scenes=SIX))
    assert judged.verdict == HOLDS and "a 1 left out" in judged.counted
    assert outcomes(PART, runs(failing(lambda s, lv, c: True))).verdict == OPEN


def test_another_failure_is_meant():
    made = runs(failing(lambda s, lv, c: c == "y"), scenes=SIX)
    for row in made.rows:
        row["outcome"] = "stall_overload"
    assert outcomes({**PART, "bad": "unsettled"}, made).verdict == HOLDS


def test_alone_and_too_little():
    alone = {"says": "", "sweep": "s", "case": "x"}
    assert outcomes(alone, runs(failing(lambda s, lv, c: False))).verdict == HOLDS
    assert outcomes(alone, runs(failing(lambda s, lv, c: s == "a" and c == "x"))).verdict == NOT
    assert outcomes(alone, runs(failing(lambda s, lv, c: False), scenes=("a", "b"))).missing.startswith("indication")
    assert outcomes(alone, runs(failing(lambda s, lv, c: False), seeds=(1,))).verdict == HOLDS


def test_starts_count_where_a_part_says_that_they_matter():
    matter = {"says": "", "sweep": "s", "case": "x", "starts": "matter", "reason": "chaotic"}
    assert outcomes(matter, runs(failing(lambda s, lv, c: False), seeds=(1, 2, 3, 4))).missing.startswith("indication: 0 scenes have 3 levels of 5 starts")
    assert outcomes(matter, runs(failing(lambda s, lv, c: False))).verdict == HOLDS
    for bad in ({"starts": "matter", "reason": ""}, {"starts": "5", "reason": "many"}):
        with pytest.raises(UserError, match='"matter" with a reason is needed'):
            outcomes({**matter, **bad}, runs(failing(lambda s, lv, c: False)))


@pytest.mark.parametrize("verdicts, expected", [
    ([HOLDS, HOLDS], HOLDS), ([NOT, NOT], NOT), ([HOLDS, NOT], IN_PART), ([ONLY_IF, HOLDS], ONLY_IF), ([HOLDS, OPEN], OPEN), ([NOT, OPEN], NOT),
    ([HOLDS, NOT, OPEN], IN_PART), ([ONLY_IF, NOT], IN_PART), ([ONLY_IF, OPEN], OPEN)])
def test_parts_together(verdicts, expected):
    parts = [Judged(v, says=v, condition="level 1", missing="more") for v in verdicts]
    assert together(parts).verdict == expected
    assert together([*parts, Judged(NOT, beside=True)]).verdict == expected
    assert together(parts, "solids").verdict == OPEN and "waits for solids" in together(parts, "solids").missing


def test_what_holds_is_no_condition_for_what_does_not():
    parts = [Judged(HOLDS, says="a"), Judged(NOT, says="b"), Judged(ONLY_IF, says="c", condition="level 1"), Judged(OPEN, says="d", missing="more")]
    assert together(parts).condition == "holds: a; c (level 1). does not hold: b. not decided: d"
    assert together([parts[0], parts[2]]).condition == "c (level 1)"  # a holds everywhere: no condition


def failing_by_start(where):
    """where(scene, level, case, start) -> whether it stalls."""
    return lambda s, lv, c, k: {"outcome": "newton_stall" if where(s, lv, c, k) else "ok"}


def test_a_scene_without_enough_levels_is_in_no_sign_and_no_share():
    """Six scenes win; three of them with the one level that is left where others are hopeless."""
    made = runs(failing(lambda s, lv, c: c == "y" or (s in "def" and lv != "1")), scenes=SIX)
    judged = outcomes({**PART, "needs": "more"}, made)
    assert judged.verdict == OPEN and "3 scenes won, 0 lost, 0 even" in judged.missing
    assert judged.scenes == 3 and "every run in 3 of 3 scenes; 45 of 45 runs" in judged.counted
    assert "without 3 levels that count, so not judged: d, e, f" in judged.counted and "y: 0 of 45" in judged.counted


def test_a_level_without_enough_starts_is_in_no_sign_and_no_share():
    """A fourth level of one start, in which every scene fails."""
    made = runs(failing(lambda s, lv, c: lv == "8"), levels=("1", "2", "4", "8"))
    made.rows = [row for row in made.rows if row["level"] != "8" or row["seed"] == 1]
    next(row for row in made.rows if row["level"] == "8" and row["case"] == "y")["outcome"] = "ok"  # so that it is not hopeless
    judged = outcomes({"says": "", "sweep": "s", "case": "x", "starts": "matter", "reason": "chaotic"}, made)
    assert judged.verdict == HOLDS and "not judged: a 8" in judged.counted and "45 of 45 runs" in judged.counted


def test_a_case_that_is_ahead_in_every_scene_is_not_refuted():
    """Neither gets any level through with every start: four starts in five against none."""
    ahead = runs(failing_by_start(lambda s, lv, c, k: c == "y" or k == 1), scenes=SIX)
    judged = outcomes({**PART, "needs": "more"}, ahead)
    assert judged.verdict == HOLDS and "6, 0, 0 (scenes x levels that only one gets through: 0 to 0)" in judged.counted
    assert outcomes({**PART, "case": "y", "over": "x", "needs": "more"}, ahead).verdict == NOT
    few = runs(failing_by_start(lambda s, lv, c, k: c == "y" or k == 1))
    assert outcomes({**PART, "needs": "more"}, few).verdict == OPEN
    same = runs(failing_by_start(lambda s, lv, c, k: k == (1 if c == "x" else 2)), scenes=SIX)
    assert outcomes({**PART, "needs": "more"}, same).verdict == NOT
