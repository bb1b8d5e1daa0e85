"""Runs over stiffness as paths, and formulations beside the log at equal reached gap."""

import math
from collections import Counter, defaultdict
from dataclasses import dataclass
from functools import cached_property

from barrierbench_analysis.studies.kit.formulations import REFERENCE
from barrierbench_analysis.studies.kit.front import Point, log_ratio, reached, segments, value_at
from barrierbench_analysis.studies.kit.study.store import Row, timed_alike
from barrierbench_analysis.tables.outcomes import OK
from barrierbench_analysis.tables.statistics import Ratio, ratio_over, spread


@dataclass(frozen=True)
class Runs:
    """The rows of a study. metrics: what is compared; gap_words: what the gap of a run is."""

    rows: list[Row]
    metrics: tuple[str, ...]
    gap_words: str

    @cached_property
    def _groups(self) -> dict[tuple[str, str], list[Row]]:
        found = defaultdict(list)
        for row in self.rows:
            found[row.place["scene"], row.place["formulation"]].append(row)
        return found

    def labels(self, axis: str) -> list[str]:
        return list(dict.fromkeys(row.place[axis] for row in self.rows))

    @cached_property
    def scenes(self) -> list[str]:
        return self.labels("scene")

    @cached_property
    def formulations(self) -> list[str]:
        return self.labels("formulation")

    @cached_property
    def seeds(self) -> list[str]:
        return self.labels("seed")

    @cached_property
    def scales(self) -> list[float]:
        return sorted({self.scale(row) for row in self.rows})

    @property
    def decades(self) -> float:
        return round(math.log10(self.scales[-1] / self.scales[0]), 3)

    @staticmethod
    def scale(row: Row) -> float:
        """Factor on the matched stiffness."""
        return float(row.place["scale"])

    @staticmethod
    def gap(row: Row) -> float | None:
        """None where a run failed, or was never in contact at a step end."""
        return row.values["gap"] if row.outcome == OK else None

    @cached_property
    def _timed(self) -> set[str]:
        """Scenes whose runs are of one machine and build."""
        return {
            scene
            for scene in self.scenes
            if timed_alike(row for row in self.rows if row.place["scene"] == scene)
        }

    def value(self, row: Row, name: str) -> float | None:
        """Of a metric, or of `scale`. No seconds in a scene whose runs are of several machines or builds."""
        if name == "seconds" and row.place["scene"] not in self._timed:
            return None
        return self.scale(row) if name == "scale" else row.values[name]

    def of(self, scene: str, formulation: str) -> list[Row]:
        return self._groups[scene, formulation]

    def path(self, scene: str, formulation: str, seed: str, name: str) -> list[Point]:
        """Of the runs from one start; one that failed has no gap, and breaks it."""
        rows = [row for row in self.of(scene, formulation) if row.place["seed"] == seed]
        return [Point(self.scale(row), self.gap(row), self.value(row, name)) for row in rows]


@dataclass(frozen=True)
class Estimate:
    """Geometric mean of a scene over its starts, the least and the largest of them, and how many starts it is
    of. Jittered starts are one sample: this is a scatter of repeated measures, no interval.
    """

    value: float
    low: float
    high: float
    n: int
    of: int


def _estimate(logs: list[float], of: int) -> Estimate | None:
    """logs: of the starts that have a number."""
    return Estimate(*spread(logs), len(logs), of) if logs else None


def at_gap(
    runs: Runs, scene: str, formulation: str, name: str, gap: float
) -> tuple[Estimate | None, Estimate | None]:
    """The metric at this gap, and its ratio to that of the log from the same start; None where no start
    reaches the gap.
    """
    values, ratios = [], []
    for seed in runs.seeds:
        mine = value_at(runs.path(scene, formulation, seed, name), gap)
        other = value_at(runs.path(scene, REFERENCE, seed, name), gap)
        values += [math.log(mine)] if mine is not None else []
        ratios += [math.log(mine / other)] if mine is not None and other is not None else []
    return _estimate(values, len(runs.seeds)), _estimate(ratios, len(runs.seeds))


def over_shared(runs: Runs, scene: str, formulation: str, name: str) -> Estimate | None:
    """Ratio to the log, mean over all gaps that both reach from the same start."""
    found = [
        log_ratio(runs.path(scene, formulation, seed, name), runs.path(scene, REFERENCE, seed, name))
        for seed in runs.seeds
    ]
    return _estimate([x for x in found if x is not None], len(runs.seeds))


def over_scenes(of_each: list[Estimate | None]) -> Ratio | None:
    """Of the same number in every scene, None where a scene has none."""
    logs = [math.log(e.value) for e in of_each if e is not None]
    return ratio_over(logs) if logs else None


def range_of(runs: Runs, scene: str, formulation: str) -> tuple[float, float] | None:
    """Gaps that some start reaches; the gap itself is the value, so that no metric can be missing."""
    ranges = [r for seed in runs.seeds if (r := reached(runs.path(scene, formulation, seed, "gap")))]
    return (min(r[0] for r in ranges), max(r[1] for r in ranges)) if ranges else None


def unreached(runs: Runs, scene: str) -> list[tuple[float, float]]:
    """Open ranges of gaps in (0, 1) that no formulation reaches from any start, from the smallest on."""
    covered = sorted(
        (min(a.gap, b.gap), max(a.gap, b.gap))
        for name in runs.formulations
        for seed in runs.seeds
        for a, b in segments(runs.path(scene, name, seed, "gap"))
    )
    free, edge = [], 0.0
    for low, high in covered:
        if low > edge:
            free.append((edge, low))
        edge = max(edge, high)
    return free + ([(edge, 1.0)] if edge < 1 else [])


def failures(runs: Runs, scene: str, formulation: str) -> dict[float, Counter]:
    """scale -> outcomes of its starts other than ok, or `no contact`; only scales that have some, growing."""
    found: dict[float, Counter] = defaultdict(Counter)
    for row in sorted(runs.of(scene, formulation), key=runs.scale):
        if runs.gap(row) is None:
            found[runs.scale(row)]["no contact" if row.outcome == OK else row.outcome] += 1
    return dict(found)
