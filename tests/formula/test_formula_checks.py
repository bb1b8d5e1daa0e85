"""A formula that is no barrier is refused where it fails to be one; what it does at its ends is found by limits."""

import math

import pytest

from analysis.formula import checks, symbolic
from analysis.formula.grammar import FormulaError, read


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
