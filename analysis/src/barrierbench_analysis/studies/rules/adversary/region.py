"""Where a search may go: of each scene what may change in it, and how far. A draw is a scene and a point."""

import math
import random
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

BASE_SHARE = 0.5  # of the draws that leave a parameter as the scene has it, so that few change everything
NEAR_SHARE = 0.5  # of the values that a draw close to another one changes
NEAR = 0.15  # standard deviation of a step of the local search, in widths of a range
DIGITS = 4  # of a drawn number, so that pages and labels can show it whole
SEEDS = 2**31 - 1
Value = float | int | str


@dataclass(frozen=True)
class Range:
    """Numbers between two, uniform in the logarithm if `log`. base: what the scene has without the change."""

    low: float
    high: float
    log: bool = False
    base: float | None = None
    whole: bool = False

    def _to(self, x: float) -> float:
        return math.log(x) if self.log else x

    def _number(self, at: float) -> float | int:
        """The number at a place between 0 and 1, rounded, and within the range after that."""
        low, high = self._to(self.low), self._to(self.high)
        x = low + min(max(at, 0.0), 1.0) * (high - low)
        x = math.exp(x) if self.log else x
        rounded = round(x) if self.whole else float(f"{x:.{DIGITS}g}")
        return min(max(rounded, self.low), self.high)

    def draw(self, rng: random.Random) -> float | int:
        at, keeps = rng.random(), rng.random() < BASE_SHARE
        return self.base if keeps and self.base is not None else self._number(at)

    def near(self, x: float, rng: random.Random) -> float | int:
        low, high = self._to(self.low), self._to(self.high)
        at = (self._to(x) - low) / (high - low) if high > low else 0.0
        return self._number(at + rng.gauss(0.0, NEAR))

    def holds(self, x: Value) -> bool:
        return isinstance(x, (int, float)) and self.low <= x <= self.high


@dataclass(frozen=True)
class Choice:
    """One of some words; the first is what the scene has without the change."""

    words: tuple[str, ...]

    def draw(self, rng: random.Random) -> str:
        return rng.choice(self.words)

    def near(self, _: str, rng: random.Random) -> str:
        return rng.choice(self.words)

    def holds(self, x: Value) -> bool:
        return x in self.words


class Start(Range):
    """The seed of a start. A draw that is close to another one has another start all the same, so that no two
    draws are one run."""

    def near(self, _: float, rng: random.Random) -> float | int:
        return self.draw(rng)


SEED = Start(1, SEEDS, whole=True)
Axes = dict[str, Range | Choice]


@dataclass(frozen=True)
class Point:
    """A scene and a value of each of its axes."""

    scene: str
    values: dict[str, Value]

    @property
    def text(self) -> str:
        numbers = (
            f"{name} {x:g}" if isinstance(x, float) else f"{name} {x}" for name, x in self.values.items()
        )
        return ", ".join([self.scene, *numbers])


@dataclass(frozen=True)
class Region:
    """scenes: label -> axes. settings: point and arm -> base config and all settings of the run."""

    scenes: dict[str, Axes]
    settings: Callable[[Point, str], tuple[Path, dict]] = field(repr=False, compare=False)

    def draw(self, rng: random.Random) -> Point:
        """Of the whole region: the scene first, each as likely."""
        scene = rng.choice(list(self.scenes))
        return Point(scene, {name: axis.draw(rng) for name, axis in self.scenes[scene].items()})

    def near(self, point: Point, rng: random.Random) -> Point:
        """A point of the same scene with another start, in which some values are drawn again close to
        those of `point`."""
        axes = self.scenes[point.scene]
        others = [name for name, axis in axes.items() if not isinstance(axis, Start)]
        changed = {name for name in others if rng.random() < NEAR_SHARE} or set(
            rng.sample(others, min(1, len(others)))
        )
        changed |= axes.keys() - set(others)
        values = {
            name: axis.near(point.values[name], rng) if name in changed else point.values[name]
            for name, axis in axes.items()
        }
        return Point(point.scene, values)

    def holds(self, point: Point) -> bool:
        axes = self.scenes.get(point.scene, {})
        return axes.keys() == point.values.keys() and all(axes[n].holds(x) for n, x in point.values.items())
