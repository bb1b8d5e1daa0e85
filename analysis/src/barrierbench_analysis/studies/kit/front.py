"""Paths of one formulation over its stiffness, and their comparison at equal reached gap.

A point of a path is one run: the gap it reached and what that took. The stiffness itself is no coordinate,
since the same number means different forces in different formulas (docs/results/method/pareto.md).
"""

import math
from dataclasses import dataclass

import numpy as np

from barrierbench_analysis.tables.statistics import spread

LEAST_OVERLAP = 1.25  # largest over smallest shared gap: two paths that share less are not compared
SHARED_GAPS = 9  # gaps at which paths are compared, evenly spaced in the logarithm over what they share


@dataclass(frozen=True)
class Point:
    """One run. gap: d/d_hat; value: what is compared; both None where the run failed or has no such
    number."""

    scale: float
    gap: float | None
    value: float | None

    @property
    def counts(self) -> bool:
        return self.gap is not None and self.value is not None and self.gap > 0 and self.value > 0


def segments(points: list[Point]) -> list[tuple[Point, Point]]:
    """Neighbours in stiffness that both count. A run that failed in between breaks the path: nothing is
    interpolated across it.

    Errors: ValueError when a stiffness occurs twice or a number is not finite. Cost O(n log n).
    """
    path = sorted(points, key=lambda p: p.scale)
    for before, after in zip(path, path[1:]):
        if before.scale == after.scale:
            raise ValueError(f"two runs with scale {after.scale:g}")
    for point in path:
        if not all(math.isfinite(x) for x in (point.scale, point.gap or 0.0, point.value or 0.0)):
            raise ValueError(
                f"scale {point.scale:g}: gap {point.gap}, value {point.value}; finite numbers are needed"
            )
    return [(a, b) for a, b in zip(path, path[1:]) if a.counts and b.counts]


def reached(points: list[Point]) -> tuple[float, float] | None:
    """Smallest and largest gap on the path; None without a segment."""
    gaps = [p.gap for pair in segments(points) for p in pair]
    return (min(gaps), max(gaps)) if gaps else None


def _on(segment: tuple[Point, Point], gap: float) -> float | None:
    """log value at a gap, linear between the logarithms of both ends; None where the gap lies beyond them."""
    a, b = sorted(segment, key=lambda p: p.gap)
    if not a.gap <= gap <= b.gap:
        return None
    if a.gap == b.gap:
        return 0.5 * (math.log(a.value) + math.log(b.value))
    t = math.log(gap / a.gap) / math.log(b.gap / a.gap)
    return (1 - t) * math.log(a.value) + t * math.log(b.value)


def value_at(points: list[Point], gap: float) -> float | None:
    """The value with which the path reaches this gap; None where it does not reach it. Where the path comes
    back to a gap it reached with less stiffness, the geometric mean of all its passes.
    """
    passes = [y for segment in segments(points) if (y := _on(segment, gap)) is not None]
    return spread(passes)[0] if passes else None


def shared(a: list[Point], b: list[Point]) -> np.ndarray:
    """Gaps that both paths reach, SHARED_GAPS of them; empty when they share less than a factor
    LEAST_OVERLAP.
    """
    ranges = reached(a), reached(b)
    if None in ranges:
        return np.array([])
    low, high = max(r[0] for r in ranges), min(r[1] for r in ranges)
    return np.geomspace(low, high, SHARED_GAPS) if high >= LEAST_OVERLAP * low else np.array([])


def log_ratio(a: list[Point], b: list[Point]) -> float | None:
    """Mean over the shared gaps of log(value of a / value of b); None unless the gaps at which both have a
    value, which failed runs may leave holes in, span a factor LEAST_OVERLAP.
    """
    found = [(gap, value_at(a, gap), value_at(b, gap)) for gap in shared(a, b)]
    both = [(gap, math.log(x / y)) for gap, x, y in found if x is not None and y is not None]
    return (
        float(np.mean([ratio for _, ratio in both]))
        if both and both[-1][0] >= LEAST_OVERLAP * both[0][0]
        else None
    )
