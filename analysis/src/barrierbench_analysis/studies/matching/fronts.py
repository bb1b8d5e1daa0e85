"""The runs of a sweep over stiffness as paths, and formulations beside the log at equal reached gap."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field

from barrierbench_analysis.io.origin import run_of
from barrierbench_analysis.studies.kit.formulations import REFERENCE
from barrierbench_analysis.studies.kit.front import Point, log_ratio, reached, segments, value_at
from barrierbench_analysis.studies.kit.runs import check_equal, check_varied, metric
from barrierbench_analysis.tables.estimate import of_scenes
from barrierbench_analysis.tables.numbers import rounded
from barrierbench_analysis.tables.outcomes import outcome_of
from barrierbench_analysis.tables.statistics import Ratio, ratio_over

from .spec import Spec, label

METRICS = (
    "cond_p95",
    "cond_bj_p95",
    "cond_no_contact_p95",
    "cond_no_contact_no_limit_p95",
    "newton",
    "pcg_probe",
    "factorizations",
    "seconds",
)
PLACE = ("scene", "formulation", "scale", "seed")
STATE = ("outcome", "gap", "run")


@dataclass
class Runs:
    """Rows: PLACE, STATE and METRICS. gap is None where a run is not valid, or was never in contact at a step
    end.
    """

    about: dict
    rows: list[dict] = field(default_factory=list)

    @property
    def scenes(self) -> list[str]:
        return list(dict.fromkeys(row["scene"] for row in self.rows))

    @property
    def formulations(self) -> list[str]:
        return list(dict.fromkeys(row["formulation"] for row in self.rows))

    def of(self, scene: str, formulation: str) -> list[dict]:
        return [row for row in self.rows if row["scene"] == scene and row["formulation"] == formulation]

    def path(self, scene: str, formulation: str, seed: int, name: str) -> list[Point]:
        rows = [row for row in self.of(scene, formulation) if row["seed"] == seed]
        return [
            (
                Point(row["scale"], row["gap"], row[name])
                if row["outcome"] == "ok"
                else Point(row["scale"], None, None)
            )
            for row in rows
        ]

    def seeds(self) -> list[int]:
        return sorted({row["seed"] for row in self.rows})


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


def gather(spec: Spec, notes: tuple[str, ...], records: dict[str, dict]) -> list[dict]:
    """Rows in the order of the sweep. Errors: UserError where records of one scene are of different
    configs."""
    rows, k = [], 0
    for scene in spec.scenes:
        of_scene = len(spec.formulations) * len(spec.scales) * spec.starts
        check_equal({note: records[note] for note in notes[k : k + of_scene]})
        check_varied(records[notes[k]], spec.vary, f"{spec.path}#/scenes/{scene}")
        for name in spec.formulations:
            for scale in spec.scales:
                for seed in range(1, spec.starts + 1):
                    note = notes[k]
                    assert label(scene, name, scale) in note
                    record, k = records[note], k + 1
                    rows.append(
                        {
                            "scene": scene,
                            "formulation": name,
                            "scale": scale,
                            "seed": seed,
                            "outcome": outcome_of(record),
                            "gap": rounded(metric(record, spec.gap_metric)),
                            "run": run_of(record),
                        }
                        | {m: rounded(metric(record, m)) for m in METRICS}
                    )
    return rows


def _estimate(logs: dict[int, float], of: int) -> Estimate | None:
    """logs: start -> logarithm."""
    if not logs:
        return None
    scene = of_scenes({"": {str(seed): [x] for seed, x in logs.items()}})[0]
    return Estimate(math.exp(scene.value), math.exp(scene.low), math.exp(scene.high), scene.n, of)


def at_gap(
    runs: Runs, scene: str, formulation: str, name: str, gap: float
) -> tuple[Estimate | None, Estimate | None]:
    """The metric at this gap, and its ratio to that of the log from the same start; None where no start
    reaches the gap.
    """
    values, ratios, seeds = {}, {}, runs.seeds()
    for seed in seeds:
        mine = value_at(runs.path(scene, formulation, seed, name), gap)
        other = value_at(runs.path(scene, REFERENCE, seed, name), gap)
        values |= {seed: math.log(mine)} if mine is not None else {}
        ratios |= {seed: math.log(mine / other)} if mine is not None and other is not None else {}
    return _estimate(values, len(seeds)), _estimate(ratios, len(seeds))


def over_shared(runs: Runs, scene: str, formulation: str, name: str) -> Estimate | None:
    """Ratio to the log, mean over all gaps that both reach from the same start."""
    seeds = runs.seeds()
    found = {
        seed: log_ratio(runs.path(scene, formulation, seed, name), runs.path(scene, REFERENCE, seed, name))
        for seed in seeds
    }
    return _estimate({seed: x for seed, x in found.items() if x is not None}, len(seeds))


def over_scenes(of_each: list[Estimate | None]) -> Ratio | None:
    """Of the same number in every scene, None where a scene has none."""
    logs = [math.log(e.value) for e in of_each if e is not None]
    return ratio_over(logs) if logs else None


def range_of(runs: Runs, scene: str, formulation: str) -> tuple[float, float] | None:
    """Gaps that some start reaches; the gap itself is the value, so that no metric can be missing."""
    ranges = [
        r for seed in runs.seeds() if (r := reached(runs.path(scene, formulation, seed, "gap"))) is not None
    ]
    return (min(r[0] for r in ranges), max(r[1] for r in ranges)) if ranges else None


def unreached(runs: Runs, scene: str) -> list[tuple[float, float]]:
    """Open ranges of gaps in (0, 1) that no formulation reaches from any start, from the smallest on."""
    covered = sorted(
        (min(a.gap, b.gap), max(a.gap, b.gap))
        for name in runs.formulations
        for seed in runs.seeds()
        for a, b in segments(runs.path(scene, name, seed, "gap"))
    )
    free, edge = [], 0.0
    for low, high in covered:
        if low > edge:
            free.append((edge, low))
        edge = max(edge, high)
    return free + ([(edge, 1.0)] if edge < 1 else [])


def failures(runs: Runs, scene: str, formulation: str) -> dict[float, Counter]:
    """scale -> outcomes of its starts other than ok, or `no contact`; only scales that have some."""
    found: dict[float, Counter] = {}
    for row in runs.of(scene, formulation):
        if row["outcome"] != "ok" or row["gap"] is None:
            found.setdefault(row["scale"], Counter())[
                row["outcome"] if row["outcome"] != "ok" else "no contact"
            ] += 1
    return found
