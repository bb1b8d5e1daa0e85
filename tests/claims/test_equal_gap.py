"""Rule `at_equal_gap`, on sweeps over stiffness whose ratio at equal gap is known."""

import pytest
from made import runs

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.claims.equal_gap import at_equal_gap
from barrierbench_analysis.studies.claims.verdict import HOLDS, NOT, OPEN

SCALES = ("0.01", "0.1", "1", "10", "100")
CASES = tuple(f"{name} x{scale}" for name in ("log", "cubic") for scale in SCALES)
PART = {"says": "the log takes more", "sweep": "s", "metric": "newton", "case": "log", "over": "cubic", "above": 2}


def at(case: str, factor: dict, shift: float = 1.0) -> dict:
    """newton = factor gap^-1; the cubic reaches three times the gap at equal scale, so that at equal kappa it looks three times cheaper still."""
    name, scale = case.split(" x")
    gap = 0.02 * float(scale) ** 0.35 * (3 * shift if name == "cubic" else 1)
    return {"gap_rel": gap, "newton": factor[name] / gap, "comparability": "not_comparable"}


def test_gaps_are_made_equal():
    judged = at_equal_gap(PART, runs(lambda s, lv, c, k: at(c, {"log": 5.0 + 0.1 * k, "cubic": 1.0 + 0.02 * k}), cases=CASES))
    assert judged.verdict == HOLDS and judged.value == pytest.approx(5), judged
    assert judged.counted.startswith("45 pairs of paths over stiffness count") and len(judged.runs) == 2
    assert "at equal reached gap: log / cubic" in judged.measures
    same = runs(lambda s, lv, c, k: at(c, {"log": 1.0, "cubic": 1.0}), cases=CASES)
    assert at_equal_gap(PART, same).verdict == NOT and at_equal_gap(PART, same).value == pytest.approx(1)


def test_runs_that_failed_are_no_part_of_a_path():
    def failing(s, lv, c, k):
        made = at(c, {"log": 5.0, "cubic": 1.0})
        return made | ({"outcome": "stall_overload", "newton": 1.0} if c in ("cubic x0.01", "cubic x0.1") else {})

    assert at_equal_gap(PART, runs(failing, cases=CASES)).value == pytest.approx(5)
    only_one = at_equal_gap(PART, runs(lambda s, lv, c, k: at(c, {"log": 5.0, "cubic": 1.0}) | {"outcome": "ok" if c != "x" and not c.startswith("cubic") else "newton_stall"}, cases=CASES))
    assert only_one.verdict == OPEN and "45 where one has no two neighbouring stiffnesses" in only_one.missing


def test_without_a_shared_gap_nothing_is_compared():
    judged = at_equal_gap(PART, runs(lambda s, lv, c, k: at(c, {"log": 5.0, "cubic": 1.0}, 1000.0), cases=CASES))
    assert judged.verdict == OPEN and judged.value is None and "45 without a shared gap" in judged.missing


def test_too_few_scenes_are_an_indication():
    judged = at_equal_gap(PART, runs(lambda s, lv, c, k: at(c, {"log": 5.0, "cubic": 1.0}), scenes=("a", "b"), cases=CASES))
    assert judged.verdict == OPEN and judged.missing.startswith("indication") and judged.value == pytest.approx(5)


def test_a_sweep_without_the_paths():
    made = runs(lambda s, lv, c, k: at(c, {"log": 5.0, "cubic": 1.0}), cases=CASES)
    with pytest.raises(UserError, match="has no 5 cases 'quadratic xSCALE'; it has cubic, log"):
        at_equal_gap({**PART, "over": "quadratic"}, made)
    made.rows = [row for row in made.rows if row["case"] != "log x1"]
    with pytest.raises(UserError, match="has no 5 cases 'log xSCALE'"):
        at_equal_gap(PART, made)
