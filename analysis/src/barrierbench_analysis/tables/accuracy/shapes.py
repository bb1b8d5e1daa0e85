"""Barrier shapes b(d; d_hat), written anew from their definitions: closed forms must not share code with the
program that they judge.

A test compares them with `barrierbench eval`. Lengths in m, b in m^2, b' in m.
"""

from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from barrierbench_analysis.io.errors import UserError

TINY = 1e-300  # u below which a logarithm is not evaluated


def _log(u: float) -> tuple[float, float]:
    e = 1 - u
    return -e * e * np.log(u), 2 * e * np.log(u) - e * e / u


def _log_squared(u: float) -> tuple[float, float]:
    e, log = 1 - u, np.log(u)
    return e * e * log * log, -2 * e * log * log + 2 * e * e * log / u


def _quadratic(u: float) -> tuple[float, float]:
    return (1 - u) ** 2, -2 * (1 - u)


def _cubic(u: float) -> tuple[float, float]:
    return 2 / 3 * (1 - u) ** 3, -2 * (1 - u) ** 2


def _two_stage(u: float) -> tuple[float, float]:
    return ((1 - u) ** 2, -2 * (1 - u)) if u >= 0.5 else (0.25 - 0.5 * np.log(2 * u), -0.5 / u)


def _exponential(u: float, a: float = 6.0) -> tuple[float, float]:
    t = a * (1 - u)
    p2 = np.expm1(t) - t
    return (p2 - t * t / 2) / (a * np.exp(a)), -p2 / np.exp(a)


def _minimax_bounded(u: float, a: float = 7.0) -> tuple[float, float]:
    t, c = a * (1 - u), np.exp(2.5 - a)
    if t <= 1:
        return c * t**3 / 6 / a, -c * t * t / 2
    if t <= 1.5:
        return c * (1 / 6 + t * (t - 1) / 2) / a, -c * (t - 0.5)
    return (np.exp(1 - a * u) - 11 / 24 * c) / a, -np.exp(1 - a * u)


def _minimax(u: float, a: float = 7.0) -> tuple[float, float]:
    if a * u >= 1:
        return _minimax_bounded(u, a)
    return _minimax_bounded(1 / a, a)[0] - np.log(a * u) / a, -1 / (a * u)


# u = d/d_hat in (0, 1] -> b/d_hat^2 and its derivative in u.
SHAPES: dict[str, Callable[[float], tuple[float, float]]] = {
    "log": _log,
    "log_squared": _log_squared,
    "quadratic": _quadratic,
    "cubic": _cubic,
    "two_stage": _two_stage,
    "exponential": _exponential,
    "minimax_bounded": _minimax_bounded,
    "minimax": _minimax,
}


def barrier(shape: str, argument: str, d: float, d_hat: float) -> tuple[float, float]:
    """b (m^2) and b' (m) at the gap d > 0; (0, 0) from d_hat on. argument squared_gap: f(d^2;
    d_hat^2)/d_hat^2 with f the same formula.

    Errors: UserError for a name that is not in SHAPES. Cost O(1). Source: docs/theory/barriers.md, Shapes and
    arguments.
    """
    if shape not in SHAPES or argument not in ("gap", "squared_gap"):
        raise UserError(
            f"shape {shape!r} of {argument!r}: closed forms are there for {', '.join(SHAPES)} of gap or"
            " squared_gap"
        )
    if d >= d_hat:
        return 0.0, 0.0
    u = max(d / d_hat, TINY)
    if argument == "gap":
        b, slope = SHAPES[shape](u)
        return d_hat * d_hat * b, d_hat * slope
    b, slope = SHAPES[shape](u * u)
    return d_hat * d_hat * b, d_hat * slope * 2 * u


def gap_of_load(shape: str, argument: str, kappa: float, d_hat: float, load: float) -> float:
    """The gap d (m) at which kappa |b'(d)| = load (N): where one contact rests. kappa in N/m, load > 0.

    Errors: UserError when the shape cannot carry the load at any gap. By bisection to rounding.
    """

    def missing(log_u: float) -> float:
        return kappa * -barrier(shape, argument, float(np.exp(log_u)) * d_hat, d_hat)[1] - load

    low, high = np.log(1e-12), 0.0
    if missing(low) <= 0:
        raise UserError(
            f"{shape} with kappa {kappa:g} N/m and d_hat {d_hat:g} m carries at most"
            f" {load + missing(low):.6g} N; {load:.6g} N are required"
        )
    return float(np.exp(brentq(missing, low, high, xtol=1e-15, rtol=1e-15))) * d_hat
