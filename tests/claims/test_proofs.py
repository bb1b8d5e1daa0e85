"""Proofs evaluate by the program, or by kept answers."""

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.claims.proofs import Eval, force_falls, light_touch, rho_above, unit_change
from barrierbench_analysis.studies.claims.verdict import HOLDS, NOT, ONLY_IF


@pytest.fixture
def asker(program):
    return Eval(program)


RHO = {"left": {"shape": "cubic", "derivative": "included"}, "right": {"shape": "log"}, "u": [0.1, 0.5], "above": 1}


def test_rho(asker):
    judged = rho_above(RHO, asker)
    assert judged.verdict == HOLDS and judged.proof and judged.upper == pytest.approx(22.22 / 9.93, abs=0.01)
    assert rho_above({**RHO, "above": 30}, asker).verdict == NOT
    some = rho_above({**RHO, "above": 2}, asker)
    assert some.verdict == ONLY_IF and some.condition == "u in 0.1 of 0.1, 0.5"
    # The cubic's own curvature, kappa'(d) left out, is below the log's near contact.
    assert rho_above({"left": {"shape": "cubic"}, "right": {"shape": "log"}, "u": [0.05, 0.1], "above": 1}, asker).verdict == NOT


def test_kept_answers_stand_in_for_the_program(asker):
    rho_above(RHO, asker)
    assert rho_above(RHO, Eval(None, asker.answers)).verdict == HOLDS
    with pytest.raises(UserError, match="./bench study claims asks it"):
        rho_above({**RHO, "u": [0.3]}, Eval(None, asker.answers))
    broken = {query: {"rho": 1.0} for query in asker.answers}
    assert rho_above(RHO, Eval(asker.program, broken, fresh=True)).verdict == HOLDS  # evaluated again


def test_a_light_touch(asker):
    part = {"shape": "quadratic", "over": ["cubic", "log"], "theta": 0.1, "loads": [0.1, 0.001], "above": 5}
    assert light_touch(part, asker).verdict == HOLDS
    assert light_touch({**part, "shape": "log", "over": ["cubic"]}, asker).verdict == NOT


def test_units(asker):
    published = unit_change({"mass_term": "paper", "changes": True}, asker)
    assert published.verdict == HOLDS and published.value == pytest.approx(1e6)
    assert unit_change({"mass_term": "inertia", "changes": True}, asker).verdict == NOT
    assert unit_change({"mass_term": "scaled", "changes": False}, asker).verdict == HOLDS


def test_a_force_that_falls(asker):
    part = {"shape": "cubic", "argument": "squared_gap", "u": [0.01, 0.1, 0.3, 0.447, 0.6, 0.9]}
    judged = force_falls(part, asker)
    assert judged.verdict == HOLDS and judged.value == pytest.approx(16 / 25 * 4 / 5**0.5 / 2, rel=1e-3)
    assert force_falls({**part, "argument": "gap"}, asker).verdict == NOT
