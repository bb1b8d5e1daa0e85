"""A geometric mean over scenes with its interval, as rules of studies state it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from barrierbench_analysis.tables.estimate import Cells, of_scenes, student


@dataclass(frozen=True)
class Number:
    """A mean over scenes with its interval; None without a scene, an interval without two."""

    value: float | None
    low: float | None
    high: float | None
    scenes: int

    def text(self, form: str) -> str:
        if self.value is None:
            return "-"
        interval = "" if self.low is None else f" [{self.low:{form}}, {self.high:{form}}]"
        return f"{self.value:{form}}{interval}"


def over_scenes(cells: Cells) -> Number:
    """The geometric mean over scenes of numbers whose logarithms these are."""
    values = [scene.value for scene in of_scenes({k: v for k, v in cells.items() if v})]
    if not values:
        return Number(None, None, None, 0)
    middle = sum(values) / len(values)
    low, high = student(values) if len(values) > 1 else (None, None)
    return Number(
        math.exp(middle),
        None if low is None else math.exp(low),
        None if high is None else math.exp(high),
        len(values),
    )
