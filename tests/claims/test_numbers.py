"""Rules on numbers, on runs whose verdict is known."""

import pytest
from made import SCENES, runs

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.claims.entry import read_sweep
from barrierbench_analysis.studies.claims.judge import judge_part
from barrierbench_analysis.studies.claims.numbers import _line, level, ratio, slope
from barrierbench_analysis.studies.claims.parts import check
from barrierbench_analysis.studies.claims.table import DIGITS, Table
from barrierbench_analysis.tables.numbers import rounded
from barrierbench_analysis.studies.claims.threshold import Threshold
from barrierbench_analysis.studies.claims.verdict import HOLDS, NOT, ONLY_IF, OPEN

PART = {"says": "x takes more", "sweep": "s", "metric": "newton", "case": "x", "over": "y", "above": 1.5}


SIX = ("a", "b", "c", "d", "e", "f")


def twice(scene, level, case, seed):
    return {"newton": 20.0 + seed if case == "x" else 10.0 + 0.5 * seed}


def test_a_ratio_holds_or_does_not():
    holds = ratio(PART, runs(twice))
    assert holds.verdict == HOLDS and holds.value == pytest.approx(2) and holds.lower == pytest.approx(2) == holds.upper
    assert holds.counted.startswith("45 pairs count") and len(holds.runs) == 2
    assert ratio({**PART, "above": 2.5}, runs(twice)).verdict == NOT
    below = {key: value for key, value in PART.items() if key != "above"}
    assert ratio({**below, "below": 2.5}, runs(twice)).verdict == HOLDS and ratio({**below, "below": 1.5}, runs(twice)).verdict == NOT
    assert ratio({**below, "within": 2.5}, runs(twice)).verdict == HOLDS and ratio({**below, "within": 1.5}, runs(twice)).verdict == NOT
    assert ratio({**below, "beyond": 1.5}, runs(twice)).verdict == HOLDS and ratio({**below, "beyond": 2.5}, runs(twice)).verdict == NOT


def of_gaps(same):
    """Runs of which those of the scenes in `same` are one run in both cases; the metric is the same in all."""
    return lambda scene, level, case, seed: {"newton": 10.0, "convergence": "asked", "end_error_tolerances_median": 0.5,
                                             "gaps": {"a|b": [0.1 if case == "x" or scene in same else 0.2, 0.3, 0.4, True]}}


def test_one_run_twice_decides_nothing():
    """A step solver that never does what it differs in: the ratio is 1, and it says nothing of the solver."""
    judged = ratio(PART, runs(of_gaps(SCENES)))
    assert judged.verdict == OPEN and "made the same run in every pair" in judged.missing and judged.value == 1
    assert "in 45 of 45 both cases made the same run" in judged.counted
    some = ratio(PART, runs(of_gaps(("a",))))
    assert some.verdict == NOT and "in 15 of 45 both cases made the same run" in some.counted
    assert "same run" not in ratio(PART, runs(of_gaps(()))).counted
    assert "same run" not in ratio(PART, runs(lambda s, lv, c, k: {"newton": 10.0})).counted, "numbers of before 3.5.0 have no gaps"


def test_a_pair_that_is_not_judged_is_no_subject():
    """A fourth scene, whose runs differ, has one level: it decides nothing, and does not make the other three a comparison."""
    made = runs(of_gaps(SCENES), scenes=(*SCENES, "d"))
    made.rows = [row for row in made.rows if row["scene"] != "d" or row["level"] == "1"]
    judged = ratio(PART, made)
    assert judged.verdict == OPEN and "made the same run in every pair" in judged.missing and "in 45 of 50" in judged.counted


def test_every_run_beyond_a_threshold_lies_on_either_side():
    part = {"says": "x", "sweep": "s", "metric": "newton", "case": "x", "beyond": 1, "every": True}
    of = {"a": -2.0, "b": 3.0, "c": 4.0}
    assert level(part, runs(lambda s, lv, c, k: {"newton": of[s]})).verdict == HOLDS
    assert level({**part, "beyond": 2.5}, runs(lambda s, lv, c, k: {"newton": of[s]})).verdict == NOT


def test_a_slope_has_no_starts_that_matter():
    with pytest.raises(UserError, match="starts: found 'matter'; a slope has none"):
        slope({**PART, "starts": "matter", "reason": "r"}, runs(twice))


def test_an_interval_round_the_threshold_decides_nothing():
    of_x = {"a": 14.0, "b": 16.0, "c": 20.0}
    judged = ratio(PART, runs(lambda s, lv, c, k: {"newton": of_x[s] if c == "x" else 10.0}))
    assert judged.verdict == OPEN and "includes the threshold" in judged.missing and judged.lower < 1.5 < judged.upper
    assert "(on the side asked for at every level: b, c; on the other at every level: a)" in judged.missing


def test_starts_and_levels_are_no_samples():
    """Noise between starts and between levels does not widen the interval over scenes, and more of them does not narrow it."""
    noise = ratio(PART, runs(lambda s, lv, c, k: {"newton": 10.0 * 2.0 ** (1 + (k - 3) / 4) if c == "x" else 10.0}))
    assert noise.verdict == HOLDS and noise.lower == pytest.approx(2) == noise.upper
    of_x = {"a": 18.0, "b": 20.0, "c": 25.0}
    few, many = (ratio(PART, runs(lambda s, lv, c, k: {"newton": of_x[s] if c == "x" else 10.0}, levels=levels, seeds=seeds))
                 for levels, seeds in ((("1", "2", "4"), (1,)), (tuple("123456789"), tuple(range(20)))))
    assert (few.lower, few.upper) == (pytest.approx(many.lower), pytest.approx(many.upper)) and few.scenes == many.scenes == 3
    assert few.starts == "one start at each place" and "up to 20 starts at each of 27 places, intraclass correlation 1.0000" in many.starts


def test_the_scatter_of_a_scene_is_that_of_its_levels():
    judged = ratio(PART, runs(lambda s, lv, c, k: {"newton": 10.0 * float(lv) if c == "x" else 10.0}))
    assert judged.per_scene[0] == ("a", pytest.approx(2), pytest.approx(1), pytest.approx(4), 3, 15)


def test_the_condition_is_found():
    by_level = ratio(PART, runs(lambda s, lv, c, k: {"newton": ((10.0 if lv == "4" else 20.0) if s != "a" else (12.0 if lv == "4" else 15.5)) if c == "x" else 10.0}, scenes=SIX))
    assert (by_level.verdict, by_level.condition) == (ONLY_IF, "level 1, 2; not 4")


def test_a_scene_that_contradicts_the_mean():
    """Scenes are a condition where the interval over scenes is decided and a scene lies on the other side with every level."""
    of_x = {**dict.fromkeys("abcdefgh", 90.0), "i": 14.0}
    decided = ratio(PART, runs(lambda s, lv, c, k: {"newton": of_x[s] if c == "x" else 10.0}, scenes=tuple(of_x)))
    assert (decided.verdict, decided.condition) == (ONLY_IF, "scene a, b, c, d, e, f, g, h; not i")
    mixed = ratio(PART, runs(lambda s, lv, c, k: {"newton": (of_x[s] if s != "a" or lv != "1" else 14.0) if c == "x" else 10.0}, scenes=tuple(of_x)))
    assert mixed.verdict == OPEN and mixed.missing == "the mean says holds, i the opposite at every level"
    one_level = ratio(PART, runs(lambda s, lv, c, k: {"newton": (90.0 if s != "i" or lv == "1" else 14.0) if c == "x" else 10.0}, scenes=tuple(of_x)))
    assert one_level.verdict == HOLDS  # a scene with levels on both sides contradicts nothing


def test_scenes_on_either_side_of_an_open_interval_are_no_condition():
    judged = ratio(PART, runs(lambda s, lv, c, k: {"newton": (10.0 if s == "b" else 20.0) if c == "x" else 10.0}))
    assert judged.verdict == OPEN and "includes the threshold" in judged.missing


@pytest.mark.parametrize("less", [{"scenes": SCENES[:2]}, {"levels": ("1", "2")}, {"scenes": SCENES[:1]}])
def test_too_little_is_an_indication(less):
    judged = ratio(PART, runs(twice, **less))
    assert judged.verdict == OPEN and judged.missing.startswith("indication") and judged.value == pytest.approx(2)
    assert (judged.lower is None) == (less.get("scenes") == SCENES[:1])


def test_one_start_is_enough_unless_starts_matter():
    assert ratio(PART, runs(twice, seeds=(1,))).verdict == HOLDS
    matter = {**PART, "starts": "matter", "reason": "chaotic"}
    assert ratio(matter, runs(twice, seeds=(1, 2, 3, 4))).missing.startswith("indication: 0 scenes have 3 levels of 5 starts that count")
    assert ratio(matter, runs(twice)).verdict == HOLDS


def test_runs_that_are_not_comparable_do_not_count():
    def one_scene_off(s, lv, c, k):
        return {**twice(s, lv, c, k), "comparability": "not_comparable" if s == "c" and c == "y" else "comparable"}

    judged = ratio(PART, runs(one_scene_off))
    assert judged.verdict == OPEN and "15 not_comparable" in judged.missing
    assert ratio({**PART, "counts": "valid"}, runs(one_scene_off)).verdict == HOLDS
    # Neither is the reference of the other: their own gaps decide.
    far = ratio(PART, runs(lambda s, lv, c, k: {**twice(s, lv, c, k), "gap_rel": 0.06 if c == "x" else 0.13}))
    assert far.verdict == OPEN and "45 not_comparable" in far.missing


GAPS = {"cloth|cloth": [0.3, 0.5, 0.8, True], "cloth|floor": [0.1, 0.2, 0.4, True], "cloth|pin": [0.001, 0.9, 0.9, False]}


def with_gaps(change: dict, gap_rel: float = 0.1):
    """x has these pairs of bodies where y has GAPS."""
    return runs(lambda s, lv, c, k: {**twice(s, lv, c, k), "gaps": GAPS | (change if c == "x" else {}), "gap_rel": gap_rel if c == "x" else 0.1})


def test_two_runs_are_compared_pair_of_bodies_by_pair_of_bodies():
    """By the rule of the records: neither run is the reference of the other. One smallest gap may belong to a pair that hardly carries anything."""
    other_smallest = with_gaps({"cloth|pin": [0.0001, 0.9, 0.9, False]}, gap_rel=0.0001)
    assert ratio(PART, other_smallest).verdict == HOLDS
    for change, pair in (({"cloth|floor": [0.1, 0.2, 0.81, True]}, "cloth|floor"), ({"cloth|cloth": [0.14, 0.5, 0.8, True]}, "cloth|cloth"),
                         ({"cloth|ball": [0.4, 0.9, 0.9, True]}, "cloth|ball")):
        judged = ratio(PART, with_gaps(change))
        assert judged.verdict == OPEN and f"left out: 45 not_comparable ({pair})" in judged.missing, judged
        assert ratio({**PART, "counts": "valid"}, with_gaps(change)).verdict == HOLDS
    assert ratio(PART, with_gaps({"cloth|floor": [0.051, 0.11, 0.79, True]})).verdict == HOLDS


def test_the_pair_of_a_run_that_its_record_calls_not_comparable_is_named():
    judged = ratio(PART, runs(lambda s, lv, c, k: {**twice(s, lv, c, k), **({"comparability": "not_comparable", "pair": "cloth|floor"} if c == "x" else {})}))
    assert "left out: 45 not_comparable (cloth|floor)" in judged.missing


def test_a_record_without_such_gaps_is_compared_with_none_that_has_them():
    mixed = with_gaps({})
    for row in mixed.rows:
        row |= {"gaps": None} if row["case"] == "y" else {}
    assert "45 not_comparable (one record is of before 3.5.0)" in ratio(PART, mixed).missing


def test_runs_that_failed_or_lack_the_number_do_not_count():
    judged = ratio({**PART, "counts": "valid"}, runs(lambda s, lv, c, k: {**twice(s, lv, c, k), **({"outcome": "newton_stall"} if s == "a" else {}),
                                                                      **({"newton": None} if s == "b" else {})}))
    assert judged.verdict == OPEN and "15 newton_stall" in judged.missing and "15 no newton" in judged.missing


@pytest.mark.parametrize("more", ["x", "y"])
def test_equal_numbers_are_asked_for_whichever_run_has_more(more):
    made = runs(lambda s, lv, c, k: {**twice(s, lv, c, k), "stretch": 0.01 if c != more and s == "a" else 0.02 if s == "a" or c == more else 0.0185})
    judged = ratio({**PART, "equal": {"metric": "stretch", "factor": 1.1}}, made)
    assert judged.verdict == OPEN and "15 stretch differs by more than 1.1" in judged.missing and "30 pairs count" in judged.missing


def test_a_level():
    part = {"says": "", "sweep": "s", "metric": "climb_of_limit", "case": "x", "above": 0.5}
    made = runs(lambda s, lv, c, k: {"climb_of_limit": 0.7 + 0.01 * k})
    assert level(part, made).verdict == HOLDS and level({**part, "above": 0.9}, made).verdict == NOT


def test_every_single_value():
    part = {"says": "", "sweep": "s", "metric": "stretch_of_limit", "case": "x", "below": 1, "every": True}
    made = runs(lambda s, lv, c, k: {"stretch_of_limit": 0.99})
    assert level(part, made).verdict == HOLDS
    for value, verdict in ((1.01, NOT), (1.0, NOT), (1 - 1e-12, HOLDS)):
        made.rows[0]["stretch_of_limit"] = value
        assert level(part, made).verdict == verdict, value
    above = {key: value for key, value in part.items() if key != "below"}
    assert level({**above, "above": 0.99}, made).verdict == NOT  # the others are 0.99


def test_a_slope():
    part = {"says": "", "sweep": "s", "metric": "gap_end", "case": "x", "beyond": 0.05}
    half = slope(part, runs(lambda s, lv, c, k: {"gap_end": 0.1 * float(lv) ** 0.5}))
    assert (half.verdict, half.value, half.scenes) == (HOLDS, pytest.approx(0.5), 3)
    assert slope(part, runs(lambda s, lv, c, k: {"gap_end": 0.1})).verdict == NOT
    uneven = slope(part, runs(lambda s, lv, c, k: {"gap_end": 0.1 * float(lv) ** 0.5}, levels=("3", "24", "1000")))  # a power law has one slope, wherever its levels are
    assert uneven.value == pytest.approx(0.5) and uneven.per_scene[0][2:4] == (pytest.approx(0.5), pytest.approx(0.5))
    assert slope(part, runs(lambda s, lv, c, k: {"gap_end": 0.1 * float(lv)}, scenes=("a", "b"))).missing.startswith("indication")
    assert slope({**part, "scenes": ["a", "b"]}, runs(lambda s, lv, c, k: {"gap_end": 0.1 * float(lv)})).missing.startswith("indication")


def test_the_slope_of_equal_values_is_zero_and_not_rounding():
    for value in (0.1, -7.3e-5, 1e300):
        assert _line([(x, value) for x in (0.1, 0.7, 1.9, 2.3)]) == (0, 0, 0)
    slope, least, largest = _line([(3, 7), (1, 2), (2, 4)])
    assert slope == 2.5 and (least, largest) == (2, 3)


def test_two_levels_make_no_line():
    part = {"says": "", "sweep": "s", "metric": "gap_end", "case": "x", "beyond": 0.05}
    judged = slope(part, runs(lambda s, lv, c, k: {"gap_end": 0.1 * float(lv), "outcome": "newton_stall" if (s, lv) == ("a", "4") else "ok"}))
    assert judged.missing.startswith("indication: 2 scenes") and [name for name, *_ in judged.per_scene] == ["b", "c"] and "5 newton_stall" in judged.counted


def test_a_line_counts_once():
    """Five starts of three levels are five lines of one scene, whose value is their mean; scatter is that between neighbouring levels."""
    bent = {"1": 1.0, "2": 2.0, "4": 8.0}  # slopes 1 and 2, line 1.5
    judged = slope({"says": "", "sweep": "s", "metric": "gap_end", "case": "x", "above": 1}, runs(lambda s, lv, c, k: {"gap_end": bent[lv] ** (k / 3)}))
    assert judged.counted == "15 lines count" and judged.per_scene[0] == ("a", pytest.approx(1.5), pytest.approx(1), pytest.approx(2), 3, 5)


def test_a_bad_entry_says_what_is_allowed():
    with pytest.raises(UserError, match="no case 'z'; it has x, y"):
        ratio({**PART, "over": "z"}, runs(twice))
    with pytest.raises(UserError, match="one of above, below, within, beyond"):
        ratio({**PART, "below": 2}, runs(twice))


@pytest.mark.parametrize("kind, lower, upper, verdict", [
    ("above", 1, 1, NOT), ("below", 1, 1, NOT), ("above", 1, 2, OPEN), ("below", 0, 1, OPEN), ("below", 0, 0.999, HOLDS), ("below", 1, 2, NOT), ("above", 0, 1, NOT), ("above", 1.001, 2, HOLDS),
    ("within", -1, 1, HOLDS), ("beyond", -1, 1, NOT), ("beyond", 1, 1, NOT), ("within", 1, 1, HOLDS), ("beyond", 1.001, 2, HOLDS), ("within", 1.001, 2, NOT)])
def test_a_number_on_the_threshold(kind, lower, upper, verdict):
    """Above, below and beyond are strict; within is what is not beyond."""
    assert Threshold({kind: 1}, False).judge(lower, upper) == verdict


def test_a_metric_keeps_the_digits_that_a_threshold_needs():
    assert rounded(0.9999999, DIGITS) < 1 < rounded(1.0000001, DIGITS) and rounded({"a": [0.12345678]}) == {"a": [0.123457]}


def test_a_number_without_a_logarithm_is_left_out_of_a_slope():
    part = {"says": "", "sweep": "s", "metric": "gap_end", "case": "x", "beyond": 0.05}
    judged = slope(part, runs(lambda s, lv, c, k: {"gap_end": 0.0 if (s, lv) == ("a", "2") else 0.1 * float(lv)}, levels=("1", "2", "4", "8")))
    assert judged.verdict == HOLDS and "5 gap_end is not above 0" in judged.counted
    for bad in ("fine", "0"):
        with pytest.raises(UserError, match=f"sweep s: level '{bad}': a slope needs levels that are numbers above 0"):
            slope(part, runs(lambda s, lv, c, k: {"gap_end": 0.1}, levels=("1", "2", "4", bad)))


def test_two_rules_of_comparability_are_not_pooled():
    """Level and slope take runs one by one, so that no pair says it."""
    sweep, mixed = read_sweep("policies"), with_gaps({})
    mixed.check_one_rule(sweep)
    for row in mixed.rows:
        row |= {"gaps": None} if row["case"] == "y" else {}
    with pytest.raises(UserError, match="policies: 45 records of before 3.5.0 .* beside 45 later ones.*./bench sweep claims/sweeps/policies.json"):
        mixed.check_one_rule(sweep)
    with pytest.raises(UserError, match="two rules|of before 3.5.0"):
        judge_part({**PART, "rule": "ratio", "sweep": "policies"}, Table({"policies": mixed}), None)
    for row in mixed.rows:
        row |= {"outcome": "newton_stall"} if row["case"] == "y" else {}
    mixed.check_one_rule(sweep)  # a run that failed is not compared


@pytest.mark.parametrize("more, said", [({"scenes": ["strip", "stackk"]}, "scenes: found 'stackk'; .* has ball, pile, stack, strip"), ({"scenes": []}, "scenes: found none"),
                                        ({"abowe": 1}, "abowe: unknown; allowed: above"), ({"theta": 0.1, "lim": "off"}, "lim: unknown")])
def test_a_part_of_words_that_nobody_reads_is_refused(more, said):
    part = {"says": "x", "rule": "ratio", "sweep": "policies", "metric": "newton", "case": "published", "over": "fixed_log", "above": 1}
    check(part, read_sweep("policies"))
    with pytest.raises(UserError, match=said):
        judge_part({**part, **more}, Table({"policies": runs(twice)}), None)
