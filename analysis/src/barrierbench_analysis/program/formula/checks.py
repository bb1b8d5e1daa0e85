"""What a formula has to be before it is a barrier: defined, positive, pushing, convex on (0, d_hat),
without a jump of value or force at d_hat, and at 0 what it declares. Limits are exact (sympy), and poles of
rational parts by exact roots. Signs are looked for on a grid in 40 digits and proven between its points
(signs.py).
"""

import math
from collections.abc import Callable
from typing import NamedTuple, NoReturn

import mpmath
import sympy as sp

from . import signs
from .grammar import FormulaError
from .symbolic import HIGHEST, Terms, U

INFINITE, FINITE = "infinite", "finite"
DIGITS = 40
NAMES = ("b", "b'", "b''")
UNITS = ("d_hat^2", "d_hat", "1")


class Ends(NamedTuple):
    """Limits: at 0 those of b, b', b'' for d_hat = 1 (inf where there is none), and at d_hat the number of
    continuous derivatives; and what is not known between the two.
    """

    at_zero: tuple[float, float, float]
    smoothness: int
    unproven: tuple[str, ...] = ()  # where the sign of b, b' or b'' is neither proven nor refuted

    @property
    def kind(self) -> str:
        """What `at_zero` of a config says."""
        return INFINITE if math.isinf(self.at_zero[0]) else FINITE


def grid() -> list[mpmath.mpf]:
    """u in (0, 1), dense towards both ends."""
    ends = [mpmath.mpf(10) ** (mpmath.mpf(-k) / 20) for k in range(14, 181)]  # to 1e-9
    inner = [mpmath.mpf(k) / 1000 for k in range(1, 1000)]
    return sorted({*ends, *(1 - x for x in ends), *inner})


def check(terms: Terms, declared: str | None) -> Ends:
    """declared: "infinite", "finite", or None: unknown. Errors: FormulaError with the place, as d/d_hat."""
    with mpmath.workdps(DIGITS):
        _check_poles(terms.plain[0])
        unproven = _check_signs(terms)
    smoothness = _smoothness(terms.plain)
    at_zero = tuple(_limit(term, 0, "+", NAMES[i]) for i, term in enumerate(terms.plain))
    ends = Ends(at_zero, smoothness, unproven)
    if math.isinf(at_zero[0]) and not all(math.isinf(x) for x in at_zero):
        raise FormulaError(f"b, b', b'' -> {at_zero} at d = 0", "all three infinite, or b finite")
    if declared is not None and declared != ends.kind:
        value = "infinity" if ends.kind == INFINITE else f"{at_zero[0]:g} d_hat^2"
        raise FormulaError(f'at_zero "{declared}" of a formula with b -> {value} at d = 0', f'"{ends.kind}"')
    return ends


def _check_poles(b: sp.Expr) -> None:
    for part in b.atoms(sp.Pow):
        base = part.base
        if not part.exp.is_negative or not base.has(U):
            continue
        inside = sorted(root for root in _roots(base) if 0 < root < 1)
        if inside:
            raise FormulaError(
                f"a division by 0 at d = {_number(inside[0])} d_hat", "no division by 0 in (0, d_hat)"
            )


def _roots(base: sp.Expr) -> list:
    """Exact where it is a polynomial; else where the sign changes on the grid."""
    top = sp.fraction(sp.together(base))[0]
    if top.is_polynomial(U):
        return [mpmath.mpf(str(sp.N(root, DIGITS))) for root in sp.real_roots(sp.Poly(top, U))]
    value = sp.lambdify(U, base, "mpmath")

    def sign(u: mpmath.mpf) -> mpmath.mpf:
        return mpmath.sign(mpmath.re(value(u)))

    points = grid()
    signs = [sign(u) for u in points]
    changes = [k for k in range(1, len(points)) if signs[k] != signs[k - 1]]
    return [_first(points[k - 1], points[k], lambda u, k=k: sign(u) != signs[k - 1]) for k in changes]


def _first(good: mpmath.mpf, bad: mpmath.mpf, is_bad: Callable) -> mpmath.mpf:
    """By bisection."""
    for _ in range(60):
        middle = (good + bad) / 2
        good, bad = (good, middle) if is_bad(middle) else (middle, bad)
    return bad


class Sign(NamedTuple):
    """What one of b, b', b'' must be: of a number, and of bounds of it."""

    found: str
    allowed: str
    good: Callable
    proven: Callable


SIGNS = (
    Sign("b <= 0", "b > 0 in (0, d_hat)", lambda x: x > 0, lambda y: y.a > 0),
    Sign("b' >= 0", "b' < 0 in (0, d_hat): the force pushes apart", lambda x: x < 0, lambda y: y.b < 0),
    Sign(
        "b'' < 0",
        "b'' >= 0 in (0, d_hat): a force that never falls as the gap closes",
        lambda x: x >= 0,
        lambda y: y.a >= 0,
    ),
)


def _check_signs(terms: Terms) -> tuple[str, ...]:
    """From d_hat down, so that the place is the first one that closing bodies meet: on the grid, then between
    its points. What could not be proven there, in words.
    """
    values = [sp.lambdify(U, term, "mpmath") for term in terms.plain]

    def fails(i: int, u: mpmath.mpf) -> bool:
        y = values[i](u)
        return abs(mpmath.im(y)) > 0 or not mpmath.isfinite(y) or not SIGNS[i].good(mpmath.re(y))

    points = grid()[::-1]
    for i in range(len(SIGNS)):
        bad = next((k for k, u in enumerate(points) if fails(i, u)), None)
        if bad is not None:
            above = points[bad - 1] if bad > 0 else points[bad]
            _refuse_sign(i, values[i], _first(above, points[bad], lambda u, i=i: fails(i, u)))
    bad, unknown = signs.refute_or_prove(terms.plain, terms.precise, [one.proven for one in SIGNS], fails)
    if bad is not None:
        i, u = bad
        above = min((x for x in points if x > u), default=u)
        _refuse_sign(i, values[i], _first(above, u, lambda u: fails(i, u)))
    return tuple(
        f"{NAMES[one.term]} for d/d_hat from {_number(one.low)} to {_number(one.high)}" for one in unknown
    )


def _refuse_sign(i: int, value: Callable, u: mpmath.mpf) -> NoReturn:
    y, found, allowed = value(u), SIGNS[i].found, SIGNS[i].allowed
    if mpmath.isfinite(y) and abs(mpmath.im(y)) > 0:
        found, allowed = f"no real {NAMES[i]}", "a formula that is real in (0, d_hat)"
    raise FormulaError(f"{found} at d = {_number(u)} d_hat", allowed)


def _number(x: mpmath.mpf) -> str:
    return mpmath.nstr(x, 6)


def _smoothness(plain: tuple) -> int:
    """Errors: FormulaError where b or b' is not 0 at d_hat, or b'' not finite."""
    for i, found in ((0, "a value"), (1, "a force")):
        limit = _limit(plain[i], 1, "-", NAMES[i])
        if limit != 0:
            text = f"{found} that jumps at d_hat: {NAMES[i]} -> {limit:g} {UNITS[i]} at d = d_hat"
            raise FormulaError(text, "b = b' = 0 at d = d_hat, as beyond it")
    if math.isinf(_limit(plain[2], 1, "-", NAMES[2])):
        raise FormulaError("b'' -> infinity at d = d_hat", "a finite b'' at d = d_hat")
    continuous, term = 1, plain[2]
    while continuous < HIGHEST and _limit(term, 1, "-", f"derivative {continuous + 1} of b") == 0:
        continuous, term = continuous + 1, sp.diff(term, U)
    return continuous


def _limit(term: sp.Expr, at: int, side: str, name: str) -> float:
    """Errors: FormulaError where the library finds none."""
    try:
        limit = sp.limit(term, U, at, side)
        value = complex(limit) if limit.is_number and not limit.is_infinite else None
    except (NotImplementedError, ValueError, TypeError, AttributeError):
        limit, value = None, None
    if limit in (sp.oo, -sp.oo):
        return math.copysign(math.inf, 1 if limit == sp.oo else -1)
    if value is None or value.imag != 0:
        raise FormulaError(
            f"no limit of {name} at d = {at} d_hat", "a formula whose limits exist at 0 and d_hat"
        )
    return value.real
