"""Tests on one value a scene, by Student's t, and how likely they are to find what there is (power)."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from barrierbench_analysis.tables.estimate import student

LEVEL = 0.05
TRIALS = 4000  # of a power, which they tell to 0.016


def p_above(values: Sequence[float], bound: float) -> float:
    """One-sided p of a mean that is not above a bound; 1 below two scenes."""
    from scipy.stats import t

    n = len(values)
    if n < 2:
        return 1.0
    error = float(np.std(values, ddof=1)) / math.sqrt(n)
    gap = float(np.mean(values)) - bound
    if error == 0:
        return 0.0 if gap > 0 else 1.0
    return float(t.sf(gap / error, n - 1))


def p_below(values: Sequence[float], bound: float) -> float:
    return p_above([-value for value in values], -bound)


def p_within(values: Sequence[float], low: float, high: float) -> float:
    """Of two one-sided tests that a mean lies between two bounds."""
    return max(p_above(values, low), p_below(values, high))


def p_other(values: Sequence[float], bound: float = 0.0) -> float:
    """Two-sided p of a mean that is the bound."""
    return min(1.0, 2 * min(p_above(values, bound), p_below(values, bound)))


def within(values: Sequence[float], low: float, high: float) -> bool:
    """Whether the 95% interval over scenes lies between two bounds."""
    if len(values) < 2:
        return False
    lower, upper = student(values)
    return low <= lower and upper <= high


def simulated(
    p: Callable[[list[float]], float], effect: float, scatter: float, scenes: int, seed: int
) -> np.ndarray:
    """p of simulated studies: one value a scene, normal with this mean and standard deviation. The share of
    them below a level is the power. Cost O(TRIALS). Seeded.
    """
    drawn = np.random.default_rng(seed).normal(effect, scatter, (TRIALS, scenes))
    return np.array([p(list(values)) for values in drawn])
