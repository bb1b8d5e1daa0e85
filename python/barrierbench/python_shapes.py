"""A Python class as a barrier shape, for small scenes: every evaluation calls Python."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from .given import reals
from .python_sources import is_name, remember
from .shape import Shape

Terms3 = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
# Gaps over d_hat, 10^-k, at which b shows whether it is infinite at 0: from each to the next log(d) doubles.
_DECADES = (9, 18, 36, 72, 144, 288)
# Of b from one of them to the next, against that before: 2 for -log(d), 1.41 for its root, 1 for log(-log(d)), 0.5 for
# 2 - 1/(1 - log(d)), and next to 0 for 2 - d^0.05. What ends more slowly passes for infinite: 2 - d^p with p of at
# most 0.0036, or 2 - (1 - log(d))^-p with p of at most 0.23.
LEAST_GROWTH = 0.85
_NEAR = np.array([0.05, 0.2, 0.4, 0.6, 0.8, 0.95])  # gaps over d_hat at which a declaration is tested


def _error(name: str, found: str, allowed: str) -> _core.ConfigError:
    return _core.ConfigError(f"shape {name}: found {found}; allowed: {allowed}")


def _callable_of(shape: Any, name: str) -> Callable[[np.ndarray, np.ndarray], Terms3]:
    if callable(getattr(shape, "terms", None)):
        return shape.terms
    three = [getattr(shape, part, None) for part in ("value", "d1", "d2")]
    if all(map(callable, three)):
        return lambda d, d_hat: tuple(part(d, d_hat) for part in three)
    raise _error(
        name, type(shape).__name__, "an object with value, d1 and d2 of (d, d_hat), or terms, which returns all three"
    )


def _three(name: str, terms: Callable, d: np.ndarray, d_hat: np.ndarray) -> list[np.ndarray]:
    """b, b', b'' of gaps in (0, d_hat), finite or not. Errors: what terms raises; ConfigError for no three columns."""
    found = terms(d, d_hat)
    if not isinstance(found, tuple) or len(found) != 3:
        raise _error(name, type(found).__name__, "a tuple of b, b', b''")
    out = []
    for what, column in zip(("b", "b'", "b''"), found):
        numbers = reals(column, f"shape {name}: {what}")
        try:
            out.append(np.broadcast_to(numbers, d.shape))
        except ValueError:
            raise _error(name, f"{what} of shape {numbers.shape}", f"shape {d.shape}, that of d") from None
    return out


def _columns(name: str, terms: Callable, d: np.ndarray, d_hat: np.ndarray, infinite=False) -> list[np.ndarray]:
    """The same where they are finite; where b is beyond the largest double and may be, all three are as at d = 0.
    Errors: those of _three; ConfigError with the gap where one is not finite.
    """
    out = _three(name, terms, d, d_hat)
    beyond = infinite & (out[0] == np.inf)
    for k, (what, limit) in enumerate((("b", np.inf), ("b'", -np.inf), ("b''", np.inf))):
        wrong = np.flatnonzero(~np.isfinite(out[k]) & ~beyond)
        if len(wrong):
            at = wrong[0]
            raise _error(
                name, f"{what} = {out[k][at]} at d = {d[at]:.6g} m, d_hat = {d_hat[at]:.6g} m", "finite numbers"
            )
        out[k] = np.where(beyond, limit, out[k])
    return out


def _filler(name: str, terms: Callable, infinite: bool) -> Callable:
    def fill(d, d_hat, b, db, d2b):  # arrays of the run, which are gone when this returns
        with np.errstate(all="ignore"):
            inside = (d < d_hat) & ((d > 0) | (not infinite))
            b[:], db[:], d2b[:] = 0.0, 0.0, 0.0
            if infinite:
                at_zero = d <= 0
                b[at_zero], db[at_zero], d2b[at_zero] = np.inf, -np.inf, np.inf
            if inside.any():
                b[inside], db[inside], d2b[inside] = _columns(name, terms, d[inside], d_hat[inside], infinite)

    return fill


def _check(name: str, terms: Callable, smoothness: int) -> None:
    """Unit, derivatives, sign and smoothness at d_hat. Errors: ConfigError with the place where one does not hold."""
    one = np.ones_like(_NEAR)
    b, db, d2b = _columns(name, terms, _NEAR * 0.01, one * 0.01)
    larger = _columns(name, terms, _NEAR * 0.02, one * 0.02)
    for what, small, large, factor in zip(("b", "b'", "b''"), (b, db, d2b), larger, (4, 2, 1)):
        off = np.abs(large - factor * small) > 1e-9 * np.abs(large).max()
        if off.any():
            u = _NEAR[off][0]
            raise _error(
                name,
                f"{what} at d = {u:g} d_hat changes by {large[off][0] / small[off][0]:.6g} when d and d_hat double",
                f"{factor}: b(s d; s d_hat) = s^2 b(d; d_hat), so that kappa is in N/m",
            )
    h = 1e-6 * 0.01
    up, down = (_columns(name, terms, _NEAR * 0.01 + sign * h, one * 0.01) for sign in (1, -1))
    for what, given, order in (("b'", db, 0), ("b''", d2b, 1)):
        differences = (up[order] - down[order]) / (2 * h)
        off = np.abs(differences - given) > 1e-4 * np.abs(given).max()
        if off.any():
            at = int(np.flatnonzero(off)[0])
            raise _error(
                name,
                f"{what} = {given[at]:.6g} at d = {_NEAR[at]:g} d_hat",
                f"the derivative, {differences[at]:.6g} by differences",
            )
    if (db > 0).any():
        raise _error(
            name, f"b' = {db.max():.6g} > 0 at d = {_NEAR[np.argmax(db)]:g} d_hat", "b' <= 0: a barrier pushes apart"
        )
    edge = _columns(name, terms, np.array([0.01 * (1 - 1e-7)]), np.array([0.01]))
    for order, (what, size) in enumerate((("b", 1e-4), ("b'", 1e-2), ("b''", 1.0))):
        if order <= smoothness and abs(edge[order][0]) > 1e-3 * size:
            raise _error(
                name,
                f"{what} = {edge[order][0]:.3g} just below d_hat",
                f"0 in the limit: smoothness_at_d_hat is {smoothness}",
            )


def _towards_zero(name: str, terms: Callable) -> list[float]:
    """b at the gaps of _DECADES, as far as it is a number or +inf: squares of the last ones are 0 in doubles."""
    found = []
    for k in _DECADES:
        try:
            b = float(_three(name, terms, np.array([0.01 * 10.0**-k]), np.array([0.01]))[0][0])
        except ArithmeticError:
            break
        if not b > -np.inf:
            break
        found.append(b)
    return found


def _check_zero(name: str, terms: Callable, infinite: bool) -> None:
    """What b does as d -> 0, by its growth. Errors: ConfigError where it is the other thing."""
    with np.errstate(all="ignore"):
        if not infinite:
            _columns(name, terms, np.array([0.0]), np.array([0.01]))
            return
        b = _towards_zero(name, terms)
    if np.inf in b:
        return
    if len(b) < 3:
        raise _error(name, f"no number b at d = 1e-{_DECADES[len(b)]} d_hat", "numbers, or +inf, as d -> 0")
    before, then = b[-2] - b[-3], b[-1] - b[-2]
    if not then > LEAST_GROWTH * before > 0:
        first, second, third = _DECADES[len(b) - 3 : len(b)]
        raise _error(
            name,
            f"infinite_at_zero True of a b that grows by {before:.3g} m^2 from d = 1e-{first} to 1e-{second} d_hat and"
            f" by {then:.3g} m^2 from there to 1e-{third} d_hat (d_hat = 0.01 m)",
            f"False, or a b without bound as d -> 0: each time that log(d) doubles it grows by {LEAST_GROWTH} of the"
            " growth before, or more",
        )


def register_shape(shape: Any) -> Shape:
    """Makes a Python object a shape that configs name, until the process ends; returns it as a Shape.

    shape: has `name` (snake_case), `smoothness_at_d_hat` (number of continuous derivatives at d_hat) and
    `infinite_at_zero`; and `value(d, d_hat)` in m^2, `d1` in m, `d2` without unit, or `terms(d, d_hat)` which returns
    the three. They get float64 arrays of gaps 0 < d < d_hat (0 too, where it is finite) and return arrays. What is
    declared is tested at a few gaps. It is called from several threads, one at a time; what it raises ends the step
    that called it, and the run is where it was before that step. The same name again replaces the object.
    Errors: ConfigError that names what does not hold, and where.

    >>> class Quartic:
    ...     name, smoothness_at_d_hat, infinite_at_zero = "quartic", 3, False
    ...     def terms(self, d, d_hat):
    ...         s = d_hat - d
    ...         return s**4 / d_hat**2, -4 * s**3 / d_hat**2, 12 * s**2 / d_hat**2
    >>> round(float(register_shape(Quartic())(0.0, 0.01).db), 9)
    -0.04
    """
    name = getattr(shape, "name", None)
    if not is_name(name):
        raise _error(str(name), f"name {name!r}", "a snake_case word")
    smoothness, infinite = getattr(shape, "smoothness_at_d_hat", None), getattr(shape, "infinite_at_zero", None)
    if not isinstance(smoothness, int) or isinstance(smoothness, bool) or not 0 <= smoothness <= 1000:
        raise _error(name, f"smoothness_at_d_hat {smoothness!r}", "an integer from 0 to 1000")
    if not isinstance(infinite, bool):
        raise _error(name, f"infinite_at_zero {infinite!r}", "True or False")
    terms = _callable_of(shape, name)
    _check(name, terms, smoothness)
    _check_zero(name, terms, infinite)
    doc = inspect.getdoc(shape) or "a shape of Python"
    _core.register_shape(name, doc.splitlines()[0], smoothness, infinite, _filler(name, terms, infinite))
    remember(shape, name)
    return Shape(name)
