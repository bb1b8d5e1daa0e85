"""A formula that is no barrier is refused where it fails to be one; what it does at its ends is found by limits."""

import math

import pytest

from barrierbench_analysis.program.formula import checks, symbolic
from barrierbench_analysis.program.formula.grammar import FormulaError, read


def judged(text, declared=None):
    return checks.check(symbolic.terms_of(read(text)), declared)


@pytest.mark.parametrize("text, kind, smoothness", [
    ("-(d - d_hat)^2*log(d/d_hat)", "infinite", 2),
    ("(d - d_hat)^2*log(d/d_hat)^2", "infinite", 3),
    ("(d - d_hat)^2", "finite", 1),
    ("2/(3*d_hat)*(d_hat - d)^3", "finite", 2),
    ("(d_hat - d)^3/d", "infinite", 2),
])
def test_ends_are_those_of_the_shapes_that_stand(text, kind, smoothness):
    ends = judged(text, kind)
    assert (ends.kind, ends.smoothness) == (kind, smoothness)


def test_limits_at_zero():
    assert judged("2/(3*d_hat)*(d_hat - d)^3").at_zero == pytest.approx((2 / 3, -2, 4))
    assert judged("-(d - d_hat)^2*log(d/d_hat)").at_zero == (math.inf, -math.inf, math.inf)


@pytest.mark.parametrize("text, found, place", [
    ("d_hat^2*exp(-d/d_hat)", "a value that jumps at d_hat: b -> 0.367879 d_hat^2", 1),
    ("(d_hat - d)*d_hat", "a force that jumps at d_hat: b' -> -1 d_hat", 1),
    ("sqrt(d_hat)*(d_hat - d)^(3/2)", "b'' -> infinity at d = d_hat", 1),
    ("(d_hat - d)^4/(d - d_hat/3)^2", "a division by 0 at d = ", 1 / 3),
    ("(d_hat - d)^4*d_hat^2/(d^2 - d_hat^2/4)^2", "a division by 0 at d = ", 1 / 2),
    ("-(d_hat - d)^2", "b <= 0 at d = ", 1),
    ("(d_hat - d)^2*d/d_hat", "b' >= 0 at d = ", 1 / 3),
    ("(d_hat - d)^2*(2 + cos(20*d/d_hat))", "at d = ", None),
    ("d_hat^2*(1 - d/d_hat)^3*(d/d_hat + 1/10)", "b' >= 0 at d = ", 0.175),
    ("d_hat^2*((1 - d/d_hat)^2 - 3/5*(1 - d/d_hat)^3)", "b'' < 0 at d = ", 1 - 1 / 1.8),
])
def test_refused_where_it_fails(text, found, place):
    with pytest.raises(FormulaError) as error:
        judged(text)
    assert found in error.value.found
    if place is not None and "d = " in error.value.found and "d = d_hat" not in error.value.found:
        assert float(error.value.found.split("d = ")[1].split()[0]) == pytest.approx(place, rel=2e-5)


CUBIC = "d_hat^2*(1 - d/d_hat)^3"


def spike(term, place, width):
    """A cubic, less a spike between two points of the grid."""
    return f"{CUBIC} - d_hat^2*{term}*exp(-(({place} - d/d_hat)*{width})^2)"


@pytest.mark.parametrize("text, found, low, high", [
    (spike("2*(1 - d/d_hat)^3", 0.50037, 100000), "b <= 0", 0.5003, 0.5004),
    (spike("0.001*(1 - d/d_hat)^3", 0.50037, 100000), "b' >= 0", 0.5003, 0.5005),
    (spike("1e-8*(1 - d/d_hat)^3", 0.50037, 100000), "b'' < 0", 0.5003, 0.5004),
    (spike("1e-12*(1 - d/d_hat)^3", 0.000123, 10000000), "b'' < 0", 0.000122, 0.000124),
])
def test_a_spike_between_two_points_of_the_grid_is_found(text, found, low, high):
    with pytest.raises(FormulaError) as error:
        judged(text)
    assert error.value.found.startswith(f"{found} at d = ")
    assert low < float(error.value.found.split("d = ")[1].split()[0]) < high


@pytest.mark.parametrize("text", [
    "-(d - d_hat)^2*log(d/d_hat)", CUBIC, "(d_hat - d)^3/d", "d_hat^2*(cosh(1 - d/d_hat) - 1)", "d_hat^2*(1 - d/d_hat)^3*(1 + atan(1 - d/d_hat))",
    "d_hat^2*(1 - d/d_hat)^3*(2 - tanh(d/d_hat))", "d_hat^2*(d_hat/d - 1 - log(d_hat/d))", "d_hat^2*(1 - d/d_hat)^6*(2 + exp(-((d/d_hat - 0.7)*3)^2)/10)",
])
def test_signs_are_proven_between_the_points(text):
    assert judged(text).unproven == ()


def test_what_is_not_proven_is_said():
    """b'' = e (e - 1/2)^2 touches 0, and no interval around that place proves that it does not cross it."""
    (left,) = judged("d_hat^2*((1 - d/d_hat)^3/24 - (1 - d/d_hat)^4/12 + (1 - d/d_hat)^5/20)").unproven
    assert left == "b'' for d/d_hat from 0.5 to 0.5"


def test_bounds_hold_the_values():
    """Of every function of the grammar, at seeded places."""
    import random

    import mpmath
    import sympy as sp

    from barrierbench_analysis.program.formula import signs
    from barrierbench_analysis.program.formula.grammar import FUNCTIONS

    seeded = random.Random(7)
    assert len(FUNCTIONS) == 10
    for name in FUNCTIONS:
        term = getattr(sp, name)(sp.Rational(1, 3) * symbolic.U + sp.pi / 7)
        bounds, value = signs._bounds_of(term, term), sp.lambdify(symbolic.U, term, "mpmath")
        with mpmath.workdps(40):
            for _ in range(50):
                low, high = sorted(mpmath.mpf(seeded.random()) for _ in range(2))
                inside = [low, high, low + (high - low) * mpmath.mpf(seeded.random())]
                found = list(bounds(low, high))
                assert len(found) == 3 and all(b.a <= value(u) <= b.b for b in found for u in inside), name


def test_a_formula_that_does_not_do_what_it_declares():
    with pytest.raises(FormulaError, match='"infinite" of a formula with b -> 1 d_hat'):
        judged("(d_hat - d)^2", "infinite")
    with pytest.raises(FormulaError, match='"finite" of a formula with b -> infinity'):
        judged("-(d - d_hat)^2*log(d/d_hat)", "finite")


@pytest.mark.parametrize("text", ["-(d - d_hat)^2*log(d/d_hat)", "(d_hat - d)^3/d", "2/3/d_hat*(d_hat^3 - 3*d_hat^2*d + 3*d_hat*d^2 - d^3)", "d_hat^2*tan(1 - d/d_hat)^2"])
def test_precise_terms_are_the_derivatives(text):
    """Those that are compiled, in u, e, l, beside those that sympy makes of the formula itself, in 40 digits."""
    import mpmath

    terms = symbolic.terms_of(read(text))
    with mpmath.workdps(40):
        for u in (mpmath.mpf(x) for x in ("1e-6", "0.1", "0.5", "0.999999")):
            values = {symbolic.U: u, symbolic.E: 1 - u, symbolic.L: -mpmath.log(u)}
            for plain, precise in zip(terms.plain, terms.precise, strict=True):
                a, b = (mpmath.mpf(x.evalf(40, subs=values)) for x in (plain, precise))
                assert a != 0 and abs(a - b) <= mpmath.mpf("1e-25") * abs(a)
