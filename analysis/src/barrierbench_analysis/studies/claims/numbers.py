"""Rules on numbers: `ratio` of paired runs, `level` of one number, `slope` of one over the levels."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.kit.metrics import METRICS
from barrierbench_analysis.tables.estimate import Cells, OfScene
from barrierbench_analysis.tables.gap_rule import MAX_RATIO, farthest

from .cells import complete, judge_cells, judge_scenes, left_out_text
from .ends import ENDS
from .table import Runs
from .threshold import Threshold
from .verdict import HOLDS, LEVELS, NOT, OPEN, SCENES, Judged, undecided


def by_place(runs: Runs, case: str, sweep: str) -> dict[tuple, dict]:
    found = {(row["scene"], row["level"], row["seed"]): row for row in runs.rows if row["case"] == case}
    if not found:
        raise UserError(
            f"sweep {sweep} has no case {case!r}; it has"
            f" {', '.join(sorted({row['case'] for row in runs.rows}))}"
        )
    return found


def refusal(row: dict, metric: str, counts: str) -> str:
    """Why a run does not count; empty when it does."""
    if row["outcome"] != "ok":
        return row["outcome"]
    if counts == "comparable" and row["comparability"] != "comparable":
        return f"{row['comparability']} ({pair})" if (pair := row.get("pair")) else row["comparability"]
    return "" if row.get(metric) is not None else f"no {metric}"


def gap_refusal(a: dict, b: dict) -> str:
    """Why two runs, of which neither is the reference of the other, did their work at other gaps; empty when
    they did not. By the rule of the records, pair of bodies by pair of bodies; where neither record has such
    gaps by the smallest gap, as their own verdicts are.
    """
    mine, other = a.get("gaps"), b.get("gaps")
    if mine is None and other is None:
        far = (
            a["gap_rel"] and b["gap_rel"] and abs(math.log(a["gap_rel"] / b["gap_rel"])) > math.log(MAX_RATIO)
        )
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


def one_run(a: dict, b: dict, metric: str) -> bool:
    """Whether two cases made the same run as far as numbers are kept: the gaps of all pairs of bodies, the
    residual of the ends of steps and the metric. Of numbers of before 3.5.0 nobody knows, nor of seconds,
    which no two runs share: two ways to compute the same are compared by these.
    """
    kept = ("gaps", "gap_rel", *ENDS, metric)
    return a.get("gaps") is not None and all(a.get(key) == b.get(key) for key in kept)


def with_subject(judged: Judged, same: Cells, judged_cells: Cells) -> Judged:
    """Says in how many pairs both cases made the same run; same: of every pair 1 where they did. Where all of
    those that are judged did, what the cases differ in never acted, and there is no verdict.
    """
    of_all, of_judged = (
        [value for levels in cells.values() for starts in levels.values() for value in starts]
        for cells in (same, judged_cells)
    )
    if not any(of_all):
        return judged
    counted = f"{judged.counted}; in {sum(of_all):g} of {len(of_all)} both cases made the same run"
    if not of_judged or not all(of_judged):
        return replace(judged, counted=counted)
    missing = "both cases made the same run in every pair: what they differ in never acted"
    return replace(judged, counted=counted, verdict=OPEN, condition="", missing=missing)


def _scene(part: dict, place: tuple) -> bool:
    return place[0] in part.get("scenes", [place[0]])


def ratio(part: dict, runs: Runs) -> Judged:
    """metric of `case` over that of `over` in the same scene, level and start: geometric means."""
    mine, other = by_place(runs, part["case"], part["sweep"]), by_place(runs, part["over"], part["sweep"])
    cells, same, left_out, example = {}, {}, Counter(), []
    for place in sorted(mine.keys() & other.keys()):
        if not _scene(part, place):
            continue
        a, b = mine[place], other[place]
        if reason := pair_refusal(a, b, part):
            left_out[reason] += 1
            continue
        cells.setdefault(place[0], {}).setdefault(place[1], []).append(
            math.log(a[part["metric"]] / b[part["metric"]])
        )
        example = example or [a["run"], b["run"]]
        alike = float(one_run(a, b, part["metric"]))
        same.setdefault(place[0], {}).setdefault(place[1], []).append(alike)
    judged = with_subject(judge_cells(cells, left_out, part, True, "pairs"), same, complete(same, part))
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
    judged = (
        _every(cells, left_out, part)
        if part.get("every")
        else judge_cells(cells, left_out, part, False, "runs")
    )
    judged.measures = f"{METRICS[part['metric']][0]}: {', '.join(cases)}"
    judged.runs = example
    return judged


def _every(cells: Cells, left_out: Counter, part: dict) -> Judged:
    """Every single value on the right side: a statement about the runs that were made, without an
    interval."""
    threshold = Threshold(part, False)
    values = [x for levels in cells.values() for v in levels.values() for x in v]
    counted = f"{len(values)} runs count{left_out_text(left_out)}"
    more = {"threshold": f"{threshold.text} in every run", "bounds": threshold.bounds, "counted": counted}
    if not values:
        return undecided("no run counts", **more)
    more |= {
        "value": max(values, key=lambda x: x if part.get("below") is not None else -x),
        "lower": min(values),
        "upper": max(values),
        "extremes": True,
    }
    if any(threshold.judge(value, value) != HOLDS for value in values):
        return Judged(NOT, **more)
    if (enough := len(complete(cells, part))) < SCENES:
        return undecided(
            f"indication: {enough} scenes have {LEVELS} levels that count, {SCENES} are needed ({counted})",
            **more,
        )
    return Judged(HOLDS, **more)


def _line(points: list[tuple[float, float]]) -> tuple[float, float, float]:
    """Slope of the least-squares line, and the least and the largest between neighbouring levels.

    The slope has the same bits on every machine, and is 0 where all values are equal: no library of linear
    algebra is asked.
    """
    points = sorted(points)
    between = [(b[1] - a[1]) / (b[0] - a[0]) for a, b in zip(points, points[1:])]
    x, y = zip(*points)
    middle = math.fsum(x) / len(x)
    slope = math.fsum((a - middle) * (b - y[0]) for a, b in points) / math.fsum((a - middle) ** 2 for a in x)
    return slope, min(between), max(between)


def _log_level(name: str, sweep: str) -> float:
    """Errors: UserError for a level that is no positive number."""
    try:
        return math.log(float(name))
    except ValueError:
        raise UserError(
            f"sweep {sweep}: level {name!r}: a slope needs levels that are numbers above 0"
        ) from None


def slope(part: dict, runs: Runs) -> Judged:
    """d log(metric) / d log(level), level a number: a least-squares line a start, and one value a scene, the
    mean over its starts. Its scatter is that of the slopes between neighbouring levels. A number that has no
    logarithm is left out. Errors: UserError for a level that is no number, and where starts shall matter: a
    line of a start is no sample of a level.
    """
    if "starts" in part:
        raise UserError(f"{part.get('says', part)}: starts: found {part['starts']!r}; a slope has none")
    lines, left_out, example = {}, Counter(), []
    for place, row in sorted(by_place(runs, part["case"], part["sweep"]).items()):
        if not _scene(part, place):
            continue
        x, reason = (
            _log_level(place[1], part["sweep"]),
            refusal(row, part["metric"], part.get("counts", "comparable")),
        )
        if not reason and row[part["metric"]] <= 0:
            reason = f"{part['metric']} is not above 0"
        if reason:
            left_out[reason] += 1
            continue
        lines.setdefault(place[0], {}).setdefault(place[2], []).append((x, math.log(row[part["metric"]])))
        example.append(row["run"])
    scenes, groups = [], []
    for name, starts in lines.items():
        found = [_line(points) for points in starts.values() if len(points) >= LEVELS]
        if found:
            groups.append([line[0] for line in found])
            scenes.append(
                OfScene(
                    name,
                    *(sum(column) / len(found) for column in zip(*found)),
                    levels=min(map(len, starts.values())),
                    n=len(found),
                )
            )
    judged = judge_scenes(scenes, groups, left_out, part, False, "lines")
    judged.measures = f"slope of log {part['metric']} over log level: {part['case']}"
    judged.runs = example[:2]
    return judged
