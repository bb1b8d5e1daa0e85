"""Signs of b, b', b'' between the points of the grid, by interval arithmetic: an interval of gaps is halved
until bounds of the value prove its sign, its middle fails, or the work that is allowed is done.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import mpmath
import sympy as sp
from mpmath import iv

from .symbolic import E, L, U

CLOSEST = 15  # decades of d/d_hat and of 1 - d/d_hat that are proven
MOST_INTERVALS = 3000  # of each of b, b', b''
DIGITS = 40
NARROWEST = mpmath.mpf("1e-12")  # width over the distance to the nearer end; narrower ones are not halved


class Unproven(NamedTuple):
    """Gaps over d_hat between which a sign is neither proven nor refuted."""

    term: int  # of b, b', b''
    low: mpmath.mpf
    high: mpmath.mpf


Interval = tuple[mpmath.mpf, mpmath.mpf]


def refute_or_prove(
    plain: tuple[sp.Expr, ...],
    precise: tuple[sp.Expr, ...],
    good: tuple[Callable, ...],
    fails: Callable[[int, mpmath.mpf], bool],
) -> tuple[tuple[int, mpmath.mpf] | None, list[Unproven]]:
    """The largest gap at which a term failed, with its number, and the ranges where nothing is known.

    plain and precise: the terms in u, and in u, e, l. good: of each term, whether bounds of its value prove
    the sign that it must have. fails: whether a term fails at a gap.
    """
    with mpmath.workdps(DIGITS):
        before, iv.dps = iv.dps, DIGITS
        try:
            unknown: list[list[Interval]] = []
            for i, (one, other) in enumerate(zip(plain, precise, strict=True)):
                bad, left = _searched(_bounds_of(one, other), good[i], lambda u, i=i: fails(i, u))
                if bad is not None:
                    return (i, bad), []
                unknown.append(_joined(left))
            left = _without_implied(unknown)
            return None, [Unproven(i, *one) for i, ranges in enumerate(left) for one in ranges]
        finally:
            iv.dps = before


def _without_implied(unknown: list[list[Interval]]) -> list[list[Interval]]:
    """b and b' are 0 at d_hat (checks.py), so each has the sign that its slope gives it, down to where the
    sign of the slope is unknown.
    """
    out = list(unknown)
    for i in reversed(range(len(unknown) - 1)):
        known_from = max((high for _, high in out[i + 1]), default=mpmath.mpf(0))
        out[i] = [(low, min(high, known_from)) for low, high in unknown[i] if low < known_from]
    return out


def _starts() -> list[Interval]:
    """(0, 1) by decades of the distance to the nearer end, the largest gaps last."""
    near = [mpmath.mpf(10) ** -k for k in range(CLOSEST, 0, -1)]
    ends = [*near, mpmath.mpf(1) / 2, *(1 - x for x in reversed(near))]
    return list(zip(ends, ends[1:], strict=False))


def _searched(bounds: Callable, good: Callable, fails: Callable) -> tuple[mpmath.mpf | None, list[Interval]]:
    """A gap that fails, the largest of those that are found with the coarsest intervals; or what stays
    unproven.
    """
    left: list[Interval] = []
    waiting, work = _starts(), 0
    while waiting:
        work += len(waiting)
        open_ones = [one for one in waiting if not any(map(good, bounds(*one)))]
        middles = [_middle(*one) for one in open_ones]
        bad = next((u for u in reversed(middles) if fails(u) and _in_more_digits(fails, u)), None)
        if bad is not None:
            return bad, []
        waiting = []
        for (low, high), middle in zip(open_ones, middles, strict=True):
            if high - low < NARROWEST * min(low, 1 - high) or work > MOST_INTERVALS:
                left.append((low, high))
            else:
                waiting += [(low, middle), (middle, high)]
    return None, left


def _in_more_digits(fails: Callable, u: mpmath.mpf) -> bool:
    """Whether it is more than rounding: near d_hat a difference may have lost all of its digits."""
    with mpmath.workdps(3 * DIGITS):
        return fails(u)


def _middle(low: mpmath.mpf, high: mpmath.mpf) -> mpmath.mpf:
    """Of the distances to the nearer end the geometric mean."""
    if high <= 0.5:
        return mpmath.sqrt(low * high)
    return 1 - mpmath.sqrt((1 - low) * (1 - high))


def _joined(intervals: list[Interval]) -> list[Interval]:
    """Neighbours as one; in ascending order."""
    out: list[Interval] = []
    for low, high in sorted(intervals):
        if out and out[-1][1] == low:
            out[-1] = (out[-1][0], high)
        else:
            out.append((low, high))
    return out


def _monotone(name: str) -> Callable:
    """A function that never falls, from its values at both ends, wider by more than their rounding."""

    def bounds(x):
        x = iv.convert(x)
        low, high = (getattr(mpmath, name)(mpmath.mpf(end)) for end in (x.a, x.b))
        wide = mpmath.mpf(10) ** (2 - DIGITS)
        return iv.mpf([low - abs(low) * wide, high + abs(high) * wide])

    return bounds


def _cosh(x):
    """Even, and rising from 0 on."""
    ends = [(iv.exp(end) + iv.exp(-end)) / 2 for end in (abs(iv.convert(x)).a, abs(iv.convert(x)).b)]
    return iv.mpf([ends[0].a, ends[1].b])


FUNCTIONS = {
    **{name: getattr(iv, name) for name in ("log", "exp", "sqrt", "sin", "cos", "tan")},
    **{name: _monotone(name) for name in ("atan", "sinh", "tanh")},
    "cosh": _cosh,
    "pi": iv.pi,
    "mpf": iv.mpf,  # so that a quotient of two whole numbers has bounds too
}


def _bounds_of(plain: sp.Expr, precise: sp.Expr) -> Callable:
    """Bounds over an interval of gaps: of each of the two forms, and of the value in the middle with the
    slope, which are the closest for narrow intervals; without those that are not defined all over it.
    """
    of_gap, slope = (sp.lambdify(U, x, [FUNCTIONS, "mpmath"]) for x in (plain, sp.diff(plain, U)))
    of_ends = sp.lambdify([U, E, L], precise, [FUNCTIONS, "mpmath"])

    def bounds(low: mpmath.mpf, high: mpmath.mpf) -> Iterator:
        u, e, middle = iv.mpf([low, high]), iv.mpf([1 - high, 1 - low]), iv.mpf((low + high) / 2)
        forms = (
            lambda: of_ends(u, e, -iv.log(u)),
            lambda: of_gap(u),
            lambda: of_gap(middle) + slope(u) * (u - middle),
        )
        for form in forms:
            try:
                yield iv.convert(form())
            except (ValueError, ArithmeticError):
                continue

    return bounds
