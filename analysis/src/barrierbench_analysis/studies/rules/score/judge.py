"""Where a barrier is better and where worse than others, from rows at equal target, starts and hard cases.
One number decides nothing: a barrier that does not come to the end somewhere is named first.
"""

import itertools
import math
from dataclasses import dataclass
from statistics import median

from barrierbench_analysis.studies.rules.gap_map.compare import at_gap
from barrierbench_analysis.tables.statistics import Ratio, spread

from .candidate import RIVALS

SAME = 1.10  # a ratio of means within this factor is no difference
METRICS = {
    "newton": "Newton iterations of the run",
    "pcg": "PCG iterations of a solve, median in contact",
    "cond_p95": "condition number in contact, 95th percentile",
    "bj_p95": "the same after block-Jacobi scaling",
    "off_target": "reached gap off its target, as a factor",
    "spread": "median gap over that of the deepest 5 % of the load",
}  # the smaller the better
COSTS = ("newton", "pcg", "cond_p95", "bj_p95")
GAPS = (0.8, 0.5, 0.2, 0.1, 0.05)  # over d_hat, at which it is compared with the log
BETTER, WORSE, EVEN, OPEN = "better", "worse", "even", "not judged"
LEAST_SCENES = 2  # scenes are the samples: one of them decides nothing about others


@dataclass(frozen=True)
class Comparison:
    """Of one metric at one target beside one rival: geometric mean over scenes of candidate over rival."""

    metric: str
    theta: float
    rival: str
    ratio: float
    low: float
    high: float
    scenes: int

    @property
    def verdict(self) -> str:
        """Beyond SAME, and in the same direction in every scene, of which there are LEAST_SCENES."""
        if self.scenes < LEAST_SCENES:
            return OPEN
        if self.ratio <= 1 / SAME and self.high <= 1:
            return BETTER
        return WORSE if self.ratio >= SAME and self.low >= 1 else EVEN


def value(row: dict | None, metric: str) -> float | None:
    """A number of a row that ended ok; None where there is none."""
    if row is None or row["outcome"] != "ok":
        return None
    if metric == "off_target":
        return max(row["gap"] / row["theta"], row["theta"] / row["gap"]) if row["gap"] else None
    if metric == "spread":
        return row["gap"] / row["gap_p05"] if row["gap"] and row["gap_p05"] else None
    return row[metric]


def comparisons(rows: list[dict], label: str) -> list[Comparison]:
    """Where at least one scene has both numbers."""
    by = {(row["theta"], row["shape"], row["scene"]): row for row in rows}
    thetas, scenes = (dict.fromkeys(row[name] for row in rows) for name in ("theta", "scene"))
    found = []
    for metric, theta, rival in itertools.product(METRICS, sorted(thetas, reverse=True), RIVALS):
        pairs = [[value(by.get((theta, one, scene)), metric) for one in (label, rival)] for scene in scenes]
        if logs := [math.log(mine / theirs) for mine, theirs in pairs if mine and theirs]:
            found.append(Comparison(metric, theta, rival, *spread(logs), len(logs)))
    return found


def at_equal_gap(rows: list[dict], label: str) -> list[tuple[str, float, Ratio]]:
    """metric, gap over d_hat, candidate over log, each along its own path over theta: geometric mean over
    the scenes in which both come down to that gap.
    """
    ratios = {gap: at_gap(rows, "off", gap, [label]).ratios.get(label, {}) for gap in GAPS}
    return [(metric, gap, of[metric]) for metric in COSTS for gap, of in ratios.items() if metric in of]


def row_times(rows: list[dict]) -> dict[str, tuple[float, int]]:
    """method -> median over its runs of the nanoseconds of a contact row, and of how many runs. No verdict: a
    machine that does something else beside it makes a single run many times slower.
    """
    found: dict[str, list[float]] = {}
    for row in rows:
        if row["row_ns"] is not None:
            found.setdefault(row["shape"], []).append(row["row_ns"])
    return {method: (median(of), len(of)) for method, of in found.items()}


def failed(rows: list[dict], label: str) -> list[str]:
    """Matched runs that did not end ok."""
    return [
        f"{row['scene']}, theta {row['theta']:g}: {row['outcome']}"
        for row in rows
        if row["shape"] == label and row["outcome"] != "ok"
    ]


def lost(cases: list[dict], label: str) -> dict[str, list[str]]:
    """Hard cases that others end ok and the candidate does not ("lost"), and the other way round ("won")."""
    by: dict[tuple[str, str], dict[str, str]] = {}
    for case in cases:
        by.setdefault((case["test"], case["case"]), {})[case["method"]] = case["outcome"]
    out: dict[str, list[str]] = {"lost": [], "won": []}
    for (test, case), ends in by.items():
        mine, others = ends[label], [end for method, end in ends.items() if method != label]
        if mine != "ok" and "ok" in others:
            out["lost"].append(f"{test} {case}: {mine}")
        if mine == "ok" and any(end != "ok" for end in others):
            out["won"].append(
                f"{test} {case}: {', '.join(m for m, end in ends.items() if end != 'ok')} not ok"
            )
    return out


def decides(rows: list[dict], starts: list[dict], cases: list[dict], label: str) -> list[str]:
    """Sentences, what weighs most first: outcomes, then starts, then costs with the largest ratio."""
    sentences = []
    if ends := failed(rows, label):
        sentences.append(f"It does not reach every target: {'; '.join(ends)}.")
    hard = lost(cases, label)
    if hard["lost"]:
        sentences.append(f"It fails where another comes to the end: {'; '.join(hard['lost'])}.")
    if hard["won"]:
        sentences.append(f"It comes to the end where another fails: {'; '.join(hard['won'])}.")
    mine = next(one for one in starts if one["method"] == label)
    if mine["ok"] < mine["of"]:
        sentences.append(
            f"{mine['of'] - mine['ok']} of {mine['of']} jittered starts do not end ok:"
            f" {', '.join(mine['others'])}."
        )
    found = [one for one in comparisons(rows, label) if one.verdict in (BETTER, WORSE)]
    for one in sorted(found, key=lambda one: -abs(math.log(one.ratio)))[:4]:
        sentences.append(
            f"{METRICS[one.metric].capitalize()}: {one.ratio:.2f} times those of {one.rival} at theta"
            f" {one.theta:g}"
            f" ({one.low:.2f} to {one.high:.2f} over {one.scenes} scenes): {one.verdict}."
        )
    return sentences or ["It differs from no other by more than 10 % in every scene."]
