"""The adversary: what its draws say of a statement, and its page."""

import json
import math

import pytest
from adversary_rows import keep, named, said, there

from barrierbench_analysis.studies.kit.study import page
from barrierbench_analysis.studies.rules.adversary import (
    draws,
)
from barrierbench_analysis.studies.rules.adversary.page import rule, verdict
from barrierbench_analysis.studies.rules.adversary.statement import (
    Side,
    contrary,
)

pytestmark = pytest.mark.usefixtures("no_rows_of_the_study_at_size")


# ---- what draws say


@pytest.mark.parametrize(
    ("side", "x", "expected"),
    [
        (Side("above", 2.0), 1.5, 0.5),
        (Side("below", high=2.0), 1.5, -0.5),
        (Side("within", -1.0, 1.0), 1.5, 0.5),
        (Side("within", -1.0, 1.0), 0.75, -0.25),
        (Side("beyond", -1.0, 1.0), 0.75, 0.25),
        (Side("beyond", -1.0, 1.0), -1.5, -0.5),
    ],
)
def test_a_number_is_contrary_by_its_distance_from_the_threshold(side, x, expected):
    assert contrary(side, x) == pytest.approx(expected)


def test_a_ratio_on_the_threshold_contradicts_above_and_not_within():
    assert named("N2-1").contradicts(0.0) and not named("law-3").contradicts(0.0)
    assert not named("K6-1").contradicts(-0.0)


def test_a_ratio_needs_two_runs_that_end_ok():
    assert said("N2-1", newton=(20, 10)).margin == pytest.approx(-math.log(2))
    assert said("N2-1", newton=(10, 20)).margin == pytest.approx(math.log(2))
    failed = said("N2-1", ("ok", "newton_stall"), newton=(10, 20))
    assert failed.margin is None and failed.why == "absolute newton_stall"
    assert said("N2-1", newton=(10, None)).why == "no newton above 0"


def test_the_growth_of_a_ratio_is_of_four_runs():
    found = said("question-2", size_newton=(30, 10, 20, 10))
    assert found.margin == pytest.approx(-math.log(1.5)) and found.numbers.startswith("1.5 (log@S 30")
    assert said("question-2", size_newton=(10, 10, 20, 10)).margin == pytest.approx(math.log(2))


def test_runs_at_other_gaps_make_no_ratio_where_the_claim_asks_for_comparable_ones():
    def gaps(x):
        return json.dumps({"a|b": [x, x, x, True]})

    assert said("H3-1", cond_p95=(8, 10), gaps=(gaps(0.5), gaps(0.4))).margin == pytest.approx(math.log(0.9 / 0.8))
    assert "not_comparable" in said("H3-1", cond_p95=(8, 10), gaps=(gaps(0.5), gaps(0.1))).why


def test_who_gets_through_counts_runs_that_fail():
    through = {"failed_audit": (0.0, 1.0)}
    assert said("K6-2", **through).margin == -0.5  # the smaller its gap, the nearer to a failure
    assert said("K6-2", failed_audit=(1.0, 0.0)).margin == 1.0
    assert said("K6-2", failed_audit=(1.0, 1.0)).why == "no run gets through"
    assert said("K6-1", failed_audit=(1.0,)).margin == 1.0
    assert said("K5-2", ("newton_stall",)).margin == 1.0 and said("K5-2").margin < 0
    assert said("K6-1", ("timeout",), failed_audit=(None,)).margin == 1.0


def test_a_level_is_that_of_the_most_contrary_run():
    assert said("law-2", size_bj_lambda_max=(3.0, 4.5)).margin == pytest.approx(0.5)
    assert said("law-2", ("ok", "newton_stall"), size_bj_lambda_max=(3.0, 9.0)).margin == pytest.approx(-1.0)
    assert said("law-2", ("nan", "nan"), size_bj_lambda_max=(3.0, 9.0)).margin is None
    assert said("H2-1", climb_of_limit=(0.4,)).margin == pytest.approx(0.1)


def test_the_first_law_is_contradicted_by_the_wrong_sign_where_contact_makes_the_largest_eigenvalue():
    more = {"made": (5.0, 5.0), "load_high": (4.0, 4.0), "load_low": (1.0, 1.0), "theta": (0.01, 0.01)}
    assert said("law-1", size_cond_most=(30, 10), **more).margin == pytest.approx(-math.log(3))  # 100 > 2 sqrt(4)
    assert said("law-1", size_cond_most=(10, 30), **more).margin == pytest.approx(math.log(3))
    wide = {**more, "load_high": (1e4, 1e4)}  # 100 < 2 sqrt(1e4)
    assert said("law-1", size_cond_most=(10, 30), **wide).margin == pytest.approx(-math.log(3))
    assert "largest eigenvalue" in said("law-1", size_cond_most=(10, 30), **{**more, "made": (5.0, 1.0)}).why


def test_a_planted_contradiction_refutes_and_leads_the_search(adversary):
    keep(adversary, "K6-1", lambda number, arm: {"failed_audit": float(number == 2), "gap_min": 0.01 * (number + 1)})
    found = rule(adversary, page.rows_of(adversary))
    assert found["refuted"] == ["K6-1"] and "**refuted in 1 scene**" in found["every"]
    assert "`K6-1`, draw 2 contradicts: line_search fails (ok)" in found["best_every"]
    assert "--again --only statement=K6-1 --only draw=2`" in found["best_every"]
    assert [draw.label for draw in draws.next_draws(adversary, named("K6-1"), there(adversary, "K6-1"))] == ["4", "5of2", "6", "7of2"]


def test_a_mean_is_refuted_by_no_draw_and_draws_without_a_ratio_are_listed(adversary):
    keep(adversary, "N2-1", lambda number, arm: {"newton": 10.0 if arm == "clamped" else 20.0} | ({"outcome": "nan"} if number == 3 else {}))
    found = rule(adversary, page.rows_of(adversary))
    assert found["refuted"] == [] and "**3 draws of 4 on the other side**" in found["mean"]
    assert "| `N2-1` | clamped nan, absolute nan | 1 |" in found["nothing"] and found["draws"] == 4


def test_the_third_law_is_refuted_by_two_scenes(adversary):
    def ratio(number, arm):
        return {"size_newton": 30.0 if arm.startswith("log") else 10.0}

    new = keep(adversary, "law-3", ratio)
    scenes = {draw.point.scene for draw in new}
    assert len(scenes) > 1 and "law-3" in rule(adversary, page.rows_of(adversary))["refuted"]
    one = [draw for draw in there(adversary, "law-3") if draw.point.scene == min(scenes)]
    assert verdict(named("law-3"), one) == "contradicted in 1 scene"


def test_the_page_is_written_from_any_rows(adversary):
    keep(adversary, "K6-1", lambda *_: {})
    text = page.write_page(adversary).read_text()
    assert "no counterexample" in text and "not attacked yet" in text and "`at_size`, question 6" in text
