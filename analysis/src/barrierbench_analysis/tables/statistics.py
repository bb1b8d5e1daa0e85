"""Means over scenes with their interval, geometric means and slopes. Scenes are the samples: repeated
measures within one are averaged before they come here.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from .estimate import Cells, of_scenes, student
from .numbers import interval


@dataclass(frozen=True)
class Mean:
    """Mean over scenes with its 95% interval by Student's t, which one scene does not have."""

    value: float
    lower: float | None
    upper: float | None
    scenes: int

    def __str__(self) -> str:
        return interval(self.value, self.lower, self.upper)


@dataclass(frozen=True)
class Ratio(Mean):
    """Geometric mean over scenes of a ratio; its interval is Student's of the logarithms."""

    def turned(self) -> Ratio:
        """The same the other way round: what stands below goes above."""
        ends = (None, None) if self.lower is None else (_inverse(self.upper), _inverse(self.lower))
        return Ratio(_inverse(self.value), *ends, self.scenes)


def _inverse(x: float) -> float:
    """Of a number that a double holds as 0 the inverse is infinite."""
    return 1 / x if x else math.inf


def mean_over(values: Sequence[float]) -> Mean:
    """values: one a scene. Errors: ValueError without any."""
    if len(values) == 0:
        raise ValueError("a mean over scenes needs one scene")
    ends = map(float, student(values)) if len(values) > 1 else (None, None)
    return Mean(float(np.mean(values)), *ends, len(values))


def ratio_over(logs: Sequence[float]) -> Ratio:
    """logs: the logarithm of a ratio, one a scene. Errors: ValueError without any."""
    mean = mean_over(logs)
    ends = (None if end is None else _exp(end) for end in (mean.lower, mean.upper))
    return Ratio(math.exp(mean.value), *ends, mean.scenes)


def ratio_of_scenes(cells: Cells) -> Ratio | None:
    """cells: logarithms of a ratio by scene, level and start; a scene is the mean over its levels of the mean
    over starts. None without a scene.
    """
    scenes = of_scenes({name: levels for name, levels in cells.items() if levels})
    return ratio_over([scene.value for scene in scenes]) if scenes else None


def geometric(values: Iterable[float]) -> float:
    """Geometric mean of numbers above 0. Errors: ValueError without any, or for another number."""
    return spread([math.log(value) for value in values])[0]


def spread(logs: Sequence[float]) -> tuple[float, float, float]:
    """Geometric mean, least and largest of the numbers that have these logarithms: a scatter, no interval.
    Errors: ValueError without any.
    """
    if len(logs) == 0:
        raise ValueError("a geometric mean needs one number")
    return math.exp(math.fsum(logs) / len(logs)), math.exp(min(logs)), math.exp(max(logs))


def holm(p_values: Sequence[float]) -> list[float]:
    """Each p times Holm's factor, at most 1: the tests below a level may all together give one false alarm
    in 1/level.
    """
    found, least = [0.0] * len(p_values), 0.0
    for rank, k in enumerate(np.argsort(p_values, kind="stable")):
        least = max(least, min(1.0, p_values[k] * (len(p_values) - rank)))
        found[k] = least
    return found


def slope(points: Iterable[tuple[float, float]]) -> float | None:
    """Of the least-squares line through (x, y), with the same bits on every machine; None with fewer than two
    different x.
    """
    points = [(float(x), float(y)) for x, y in points]
    if len({x for x, _ in points}) < 2:
        return None
    middle, first = math.fsum(x for x, _ in points) / len(points), points[0][1]
    rise = math.fsum((x - middle) * (y - first) for x, y in points)
    return rise / math.fsum((x - middle) ** 2 for x, _ in points)


def _exp(x: float) -> float:
    """Intervals of few scenes are wide: what a double cannot hold is infinite."""
    return math.exp(x) if x < 700 else math.inf
