"""Rules on numbers: `ratio` of paired runs, `level` of one number, `slope` of one over the levels."""

from __future__ import annotations

import math
from collections import Counter

from ..gap_rule import MAX_RATIO, farthest
from .entry import ClaimError
from .estimate import Cells, interval, mean
from .metrics import METRICS
from .table import Runs
from .verdict import HOLDS, LEVELS, NOT, ONLY_IF, OPEN, SCENES, STARTS, Judged, undecided



def by_place(runs: Runs, case: str, sweep: str) -> dict[tuple, dict]:
    found = {(row["scene"], row["level"], row["seed"]): row for row in runs.rows if row["case"] == case}
    if not found:
        raise ClaimError(f"sweep {sweep} has no case {case!r}; it has {', '.join(sorted({row['case'] for row in runs.rows}))}")
    return found


def refusal(row: dict, metric: str, counts: str) -> str:
    """Why a run does not count; empty when it does."""
    if row["outcome"] != "ok":
        return row["outcome"]
    if counts == "comparable" and row["comparability"] != "comparable":
        return f"{row['comparability']} ({pair})" if (pair := row.get("pair")) else row["comparability"]
    return "" if row.get(metric) is not None else f"no {metric}"


def gap_refusal(a: dict, b: dict) -> str:
    """Why two runs, of which neither is the reference of the other, did their work at other gaps; empty when they did not. By the rule of the records, pair of
    bodies by pair of bodies; where neither record has such gaps by the smallest gap, as their own verdicts are."""
    mine, other = a.get("gaps"), b.get("gaps")
    if mine is None and other is None:
        far = a["gap_rel"] and b["gap_rel"] and abs(math.log(a["gap_rel"] / b["gap_rel"])) > math.log(MAX_RATIO)
        return "not_comparable (smallest gap)" if far else ""
    if mine is None or other is None:
        return "not_comparable (one record is of before 3.5.0)"
    apart = farthest(mine, other)
    return "" if apart is None or apart.comparable else f"not_comparable ({apart.pair})"


def pair_refusal(a: dict, b: dict, part: dict) -> str:
    metric, counts = part["metric"], part.get("counts", "comparable")
    reason = refusal(a, metric, counts) or refusal(b, metric, counts)
    if reason or min(a[metric], b[metric]) <= 0:
        return reason or f"{metric} is 0"
    if counts == "comparable" and (reason := gap_refusal(a, b)):
        return reason
    equal = part.get("equal")
    if equal:
        x, y = a.get(equal["metric"]), b.get(equal["metric"])
        if not x or not y or max(x, y) > equal["factor"] * min(x, y):
            return f"{equal['metric']} differs by more than {equal['factor']:g}"
    return ""


def complete(cells: Cells) -> Cells:
    """Scenes with enough levels of enough starts; of these the levels that have them."""
    enough = {scene: {level: v for level, v in levels.items() if len(v) >= STARTS} for scene, levels in cells.items()}
    return {scene: levels for scene, levels in enough.items() if len(levels) >= LEVELS}


class Threshold:
    """above, below: of one number. within, beyond: of the range [1/t, t] for ratios, [-t, t] for others."""

    def __init__(self, part: dict, log: bool):
        kinds = [k for k in ("above", "below", "within", "beyond") if k in part]
        if len(kinds) != 1:
            raise ClaimError(f"{part.get('says', part)}: one of above, below, within, beyond is needed")
        self.kind, number = kinds[0], part[kinds[0]]
        t = math.log(number) if log else number
        self.low, self.high = (t, t) if self.kind in ("above", "below") else (-t, t)
        name = {"within": "within a factor" if log else "at most +-", "beyond": "beyond a factor" if log else "more than +-"}
        self.text = f"{name.get(self.kind, self.kind)} {number:g}"
        self.bounds = (number,) if self.low == self.high else (1 / number if log else -number, number)

    def judge(self, lower: float, upper: float) -> str:
        inside, outside = lower > self.low and upper < self.high, upper < self.low or lower > self.high
        if self.kind == "within":
            return HOLDS if inside else NOT if outside else OPEN
        if self.kind == "beyond":
            return HOLDS if outside else NOT if inside else OPEN
        above = HOLDS if lower > self.low else NOT if upper <= self.low else OPEN
        return above if self.kind == "above" or above == OPEN else {HOLDS: NOT, NOT: HOLDS}[above]


def _groups(cells: Cells, threshold: Threshold) -> tuple[list, list]:
    """(name, verdict) of every scene, and of every level that all scenes have."""
    scenes = [(name, threshold.judge(*interval({name: levels}, False))) for name, levels in cells.items()]
    shared = [level for level in next(iter(cells.values())) if all(level in levels for levels in cells.values())]
    levels = [(level, threshold.judge(*interval({s: {level: v[level]} for s, v in cells.items()}))) for level in shared] if len(shared) >= LEVELS else []
    return scenes, levels


def _condition(groups: list[tuple[str, str]], what: str) -> str:
    """Where it holds and where not; empty unless both are there and every group is decided: of many open groups some hold by chance."""
    by = {verdict: [name for name, v in groups if v == verdict] for verdict in (HOLDS, NOT, OPEN)}
    if not by[HOLDS] or not by[NOT] or by[OPEN]:
        return ""
    return f"{what} {', '.join(by[HOLDS])}; not {', '.join(by[NOT])}"


def judge_cells(cells: Cells, left_out: Counter, part: dict, log: bool, what: str) -> Judged:
    threshold = Threshold(part, log)
    back = math.exp if log else float
    judged, n = complete(cells), sum(len(v) for levels in cells.values() for v in levels.values())
    counted = f"{n} {what} count"
    if left_out:
        counted += "; left out: " + ", ".join(f"{k} {reason}" for reason, k in sorted(left_out.items()))
    more = {"threshold": threshold.text, "bounds": threshold.bounds, "counted": counted}
    if not n:
        return undecided(f"no run counts ({counted})", **more)
    enough = len(judged) >= SCENES
    shown = judged if enough else cells
    lower, upper = interval(shown)
    more |= {"value": back(mean(shown)), "lower": back(lower), "upper": back(upper),
             "per_scene": [(name, back(mean({name: v})), *map(back, interval({name: v}, False)), sum(map(len, v.values()))) for name, v in shown.items()]}
    if not enough:
        return undecided(f"indication: {len(judged)} scenes have {LEVELS} levels of {STARTS} starts that count, {SCENES} are needed ({counted})", **more)
    verdict = threshold.judge(lower, upper)
    scenes, levels = _groups(judged, threshold)
    contradicting = [name for name, v in scenes if v == {HOLDS: NOT, NOT: HOLDS}.get(verdict)]
    if verdict != OPEN and not contradicting:
        return Judged(verdict, **more)
    if condition := _condition(levels, "level") or _condition(scenes, "scene"):
        return Judged(ONLY_IF, condition=condition, **more)
    return undecided(f"the mean says {verdict}, {', '.join(contradicting)} the opposite" if contradicting else "the interval includes the threshold", **more)


def _scene(part: dict, place: tuple) -> bool:
    return place[0] in part.get("scenes", [place[0]])


def ratio(part: dict, runs: Runs) -> Judged:
    """metric of `case` over that of `over` in the same scene, level and start: geometric means."""
    mine, other = by_place(runs, part["case"], part["sweep"]), by_place(runs, part["over"], part["sweep"])
    cells, left_out, example = {}, Counter(), []
    for place in sorted(mine.keys() & other.keys()):
        if not _scene(part, place):
            continue
        a, b = mine[place], other[place]
        if reason := pair_refusal(a, b, part):
            left_out[reason] += 1
            continue
        cells.setdefault(place[0], {}).setdefault(place[1], []).append(math.log(a[part["metric"]] / b[part["metric"]]))
        example = example or [a["run"], b["run"]]
    judged = judge_cells(cells, left_out, part, True, "pairs")
    judged.measures = f"{METRICS[part['metric']][0]}: {part['case']} / {part['over']}"
    judged.runs = example
    return judged


def level(part: dict, runs: Runs) -> Judged:
    """metric of `case`, or of all cases, beside a threshold. with every: one run beyond it refutes."""
    cases = [part["case"]] if "case" in part else sorted({row["case"] for row in runs.rows})
    cells, left_out, example = {}, Counter(), []
    for case in cases:
        for place, row in sorted(by_place(runs, case, part["sweep"]).items()):
            if not _scene(part, place):
                continue
            if reason := refusal(row, part["metric"], part.get("counts", "comparable")):
                left_out[reason] += 1
                continue
            cells.setdefault(place[0], {}).setdefault(place[1], []).append(row[part["metric"]])
            example = example or [row["run"]]
    judged = _every(cells, left_out, part) if part.get("every") else judge_cells(cells, left_out, part, False, "runs")
    judged.measures = f"{METRICS[part['metric']][0]}: {', '.join(cases)}"
    judged.runs = example
    return judged


def _every(cells: Cells, left_out: Counter, part: dict) -> Judged:
    """Every single value on the right side; where some runs did not end, only if the level is one at which all did."""
    threshold = Threshold(part, False)
    values = [x for levels in cells.values() for v in levels.values() for x in v]
    counted = f"{len(values)} runs count" + ("; left out: " + ", ".join(f"{k} {r}" for r, k in sorted(left_out.items())) if left_out else "")
    more = {"threshold": f"{threshold.text} in every run", "bounds": threshold.bounds, "counted": counted}
    if not values:
        return undecided("no run counts", **more)
    more |= {"value": max(values, key=lambda x: x if part.get("below") is not None else -x), "lower": min(values), "upper": max(values), "extremes": True}
    if threshold.judge(min(values) - 1e-300, max(values)) != HOLDS:
        return Judged(NOT, **more)
    if len(complete(cells)) < SCENES:
        return undecided(f"indication: {len(complete(cells))} scenes have {LEVELS} levels of {STARTS} starts, {SCENES} are needed ({counted})", **more)
    return Judged(HOLDS, **more)


def slope(part: dict, runs: Runs) -> Judged:
    """d log(metric) / d log(level), level a number: one least-squares line a scene and start."""
    import numpy as np

    lines, left_out, example = {}, Counter(), []
    for place, row in sorted(by_place(runs, part["case"], part["sweep"]).items()):
        if reason := refusal(row, part["metric"], part.get("counts", "comparable")):
            left_out[reason] += 1
            continue
        lines.setdefault(place[0], {}).setdefault(place[2], []).append((math.log(float(place[1])), math.log(row[part["metric"]])))
        example.append(row["run"])
    cells: Cells = {}
    for scene, starts in lines.items():
        slopes = [float(np.polyfit(*zip(*points), 1)[0]) for points in starts.values() if len(points) >= LEVELS]
        if slopes:  # one line has all levels in it, so it stands for each of them
            cells[scene] = {f"line {k}": slopes for k in range(LEVELS)}
    judged = judge_cells(cells, left_out, part, False, "lines x levels")
    judged.measures = f"slope of log {part['metric']} over log level: {part['case']}"
    judged.runs = example[:2]
    return judged
