"""Shapes beside each other, in the places that all of them share: no number of a shape is put beside one of
another that is of other places.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np

from barrierbench_analysis.studies.kit.front import Point, value_at
from barrierbench_analysis.tables.outcomes import OK
from barrierbench_analysis.tables.statistics import Ratio, ratio_over
from barrierbench_analysis.tables.words import counted

from .spec import REFERENCE
from .table import CANNOT, NOT_RUN

Place = tuple[str, str]  # scene, resolution
Key = TypeVar("Key", bound=Hashable)
Value = TypeVar("Value")
METRICS = ("cond_p95", "bj_p95", "pcg", "newton")  # of a run, as the page has them
# Scenes that are one sample. Both are the same sheet with the same steps and unknowns; only the sphere below
# it is exact in the one and made of triangles in the other, so they are not independent.
FAMILY = {"cloth_mesh": "cloth"}


def samples(by_scene: dict[str, float]) -> list[float]:
    """One value a sample: the mean over its scenes."""
    found: dict[str, list[float]] = {}
    for scene, value in by_scene.items():
        found.setdefault(FAMILY.get(scene, scene), []).append(value)
    return [float(np.mean(values)) for values in found.values()]


def counted_once(scenes: Iterable[str]) -> str:
    """Which of these scenes count as one, as sentences that begin with a blank."""
    return "".join(
        f" {scene} and {first} are the same sheet over the same sphere, which {scene} has as triangles: they"
        " are averaged and count as one scene."
        for scene, first in FAMILY.items()
        if {scene, first} <= set(scenes)
    )


def count(scenes: Iterable[str]) -> int:
    """How many samples these scenes are."""
    return len({FAMILY.get(scene, scene) for scene in scenes})


@dataclass(frozen=True)
class Common:
    """of: series -> place -> value, all in the same places. left_out: series -> in how many of the places
    where it was tried it has a value."""

    of: dict
    places: tuple[Place, ...]
    left_out: dict[Hashable, tuple[int, int]]

    @property
    def words(self) -> str:
        scenes = count(scene for scene, _ in self.places)
        return f"{counted(len(self.places), 'place')} of {counted(scenes, 'scene')}"


def common(found: dict[Key, dict[Place, Value | None]]) -> Common:
    """The one way in which series are put beside each other. found: series -> place where it was tried ->
    its value, None where it has none. A series with a value in half of its places or fewer is left out
    where there are others: it would leave few places to them. The rest is cut to the places in
    which every one has a value.
    """
    there = {name: {p: v for p, v in of.items() if v is not None} for name, of in found.items()}
    alone = len(found) == 1
    kept = {name: of for name, of in there.items() if of and (alone or 2 * len(of) > len(found[name]))}
    first, *others = kept.values() if kept else ({},)
    places = tuple(place for place in first if all(place in of for of in others))
    return Common(
        {name: {place: of[place] for place in places} for name, of in kept.items()} if places else {},
        places,
        {name: (len(of), len(found[name])) for name, of in there.items() if name not in kept},
    )


def over_scenes(logs: dict[Place, float]) -> Ratio:
    """logs: logarithms of a ratio by place; the resolutions of a scene and the scenes of a FAMILY are
    averaged first. Errors: ValueError without any.
    """
    by_scene: dict[str, list[float]] = {}
    for (scene, _), value in logs.items():
        by_scene.setdefault(scene, []).append(value)
    return ratio_over(samples({scene: float(np.mean(values)) for scene, values in by_scene.items()}))


def runs_of(rows: list[dict], limit: str, shape: str) -> dict[Place, list[dict]]:
    """place -> runs that are there, of a shape; those whose target it cannot reach are none."""
    found: dict[Place, list[dict]] = {}
    for r in rows:
        if r["limit"] == limit and r["shape"] == shape and r["outcome"] not in (NOT_RUN, CANNOT):
            found.setdefault((r["scene"], r["resolution"]), []).append(r)
    return found


def _logs(of_shape: list[float | None], of_log: list[float | None]) -> tuple[float, ...] | None:
    """Logarithms of the ratios of all metrics; None unless every one is there."""
    if not all(of_shape) or not all(of_log):
        return None
    return tuple(math.log(a / b) for a, b in zip(of_shape, of_log))


def _beside_the_log(rows: list[dict], limit: str, shapes: Iterable[str], numbers: Callable) -> Beside:
    """numbers(runs of a shape in a place) -> its METRICS there, None where it was not tried."""
    logs, found = runs_of(rows, limit, REFERENCE), {}
    for shape in shapes:
        of: dict[Place, tuple[float, ...] | None] = {}
        for place, runs in runs_of(rows, limit, shape).items():
            mine, log = numbers(runs), numbers(logs.get(place, []))
            if mine is not None and log is not None:
                of[place] = _logs(mine, log)
        if of:
            found[shape] = of
    return Beside(common(found))


@dataclass(frozen=True)
class Beside:
    """Shapes beside the log. cut: the logarithms of all METRICS over those of the log."""

    cut: Common

    @cached_property
    def ratios(self) -> dict[str, dict[str, Ratio]]:
        """shape -> metric -> over that of the log."""
        return {
            shape: {
                metric: over_scenes({place: logs[k] for place, logs in of.items()})
                for k, metric in enumerate(METRICS)
            }
            for shape, of in self.cut.of.items()
        }


def at_theta(rows: list[dict], limit: str, theta: float, shapes: Iterable[str]) -> Beside:
    """At equal target, so under the same loads, each shape at the gap that it reaches."""

    def numbers(runs: list[dict]) -> list[float | None] | None:
        mine = next((r for r in runs if r["theta"] == theta), None)
        if mine is None:
            return None
        return [mine[metric] if mine["outcome"] == OK else None for metric in METRICS]

    return _beside_the_log(rows, limit, shapes, numbers)


def path(runs: list[dict], metric: str) -> list[Point]:
    """Of a shape in one place. theta is the parameter: a smaller target means a softer contact. A run that
    failed breaks the path.
    """
    return [
        Point(r["theta"], r["gap"], r[metric]) if r["outcome"] == OK else Point(r["theta"], None, None)
        for r in runs
    ]


def at_gap(rows: list[dict], limit: str, gap: float, shapes: Iterable[str]) -> Beside:
    """At equal reached gap, each along its own path over theta."""

    def numbers(runs: list[dict]) -> list[float | None] | None:
        return [value_at(path(runs, metric), gap) for metric in METRICS] if runs else None

    return _beside_the_log(rows, limit, shapes, numbers)


def deepest(rows: list[dict], limit: str, shapes: Iterable[str], theta: float | None = None) -> Common:
    """shape -> place -> smallest gap that some run of it reached there, at a target where one is given."""
    found: dict[str, dict[Place, float | None]] = {}
    for shape in shapes:
        for place, runs in runs_of(rows, limit, shape).items():
            if mine := [r for r in runs if theta in (None, r["theta"])]:
                gaps = [r["gap"] for r in mine if r["outcome"] == OK and r["gap"]]
                found.setdefault(shape, {})[place] = min(gaps, default=None)
    return common(found)


def middles(cut: Common) -> dict[str, float]:
    """Median over the places of each series."""
    return {name: float(np.median(list(of.values()))) for name, of in cut.of.items()}


@dataclass(frozen=True)
class Step:
    """One target of a line: geometric means over scenes, their resolutions averaged, of gap and number."""

    theta: float
    gap: float
    value: float


@dataclass(frozen=True)
class Lines:
    """of: shape -> its steps, target by target, falling; thin: shape -> place -> (gap, value) by target. All
    steps of all shapes are of the same places, which are `whole` of `run`: those in which every run of every
    shape reached a gap, of those whose whole path was run."""

    of: dict[str, list[Step]]
    thin: dict[str, dict[Place, list[tuple[float, float]]]]
    whole: tuple[Place, ...]
    run: tuple[Place, ...]


def _numbers(rows: list[dict], limit: str, shape: str, metric: str, over: Callable) -> dict:
    """(place, theta) -> gap and number of runs that have both; None of a run that has not."""
    return {
        (place, r["theta"]): (r["gap"], r[metric] / over(r))
        if r["outcome"] == OK and r["gap"] and r[metric] and over(r)
        else None
        for place, runs in runs_of(rows, limit, shape).items()
        for r in runs
    }


def lines(rows: list[dict], limit: str, shapes: list[str], metric: str, over: Callable) -> Lines:
    """over(row) is what a number is divided by, None where that is not known. The lines go down to the
    smallest target at which the shapes still share half of the places, and are of those that they share all
    the way; a shape ends where it cannot reach a target."""
    mine = [r for r in rows if r["limit"] == limit and r["shape"] in shapes]
    part = {(r["scene"], r["resolution"]) for r in mine if r["outcome"] == NOT_RUN}
    run = tuple(dict.fromkeys(p for r in mine if (p := (r["scene"], r["resolution"])) not in part))
    found = {shape: _numbers(rows, limit, shape, metric, over) for shape in shapes}
    whole, thetas = run, []
    for theta in sorted({r["theta"] for r in mine}, reverse=True):
        left = tuple(p for p in whole if all(of.get((p, theta), 0) is not None for of in found.values()))
        if not left or 2 * len(left) < len(run):
            break
        whole, thetas = left, [*thetas, theta]
    of = {shape: _steps(numbers, thetas, whole) for shape, numbers in found.items()}
    return Lines(of, {shape: _thin(numbers, run) for shape, numbers in found.items()}, whole, run)


def _steps(numbers: dict, thetas: list[float], whole: tuple[Place, ...]) -> list[Step]:
    """No step at a target that a shape cannot reach: it has no run there in any place."""
    found = []
    for theta in thetas:
        if at := {p: numbers[p, theta] for p in whole if (p, theta) in numbers}:
            gap, value = (over_scenes({p: math.log(pair[k]) for p, pair in at.items()}).value for k in (0, 1))
            found.append(Step(theta, gap, value))
    return found


def _thin(numbers: dict, run: tuple[Place, ...]) -> dict[Place, list[tuple[float, float]]]:
    return {
        place: [pair for (p, _), pair in sorted(numbers.items(), reverse=True) if p == place and pair]
        for place in run
    }
