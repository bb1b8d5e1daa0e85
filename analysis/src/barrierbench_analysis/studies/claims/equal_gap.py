"""Rule `at_equal_gap`: a metric of two formulations where both reach the same gap, each along its own sweep
over stiffness.
"""

from __future__ import annotations

from collections import Counter

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.kit.front import Point, log_ratio, reached
from barrierbench_analysis.studies.kit.metrics import METRICS

from .ends import STIFFNESS
from .numbers import _scene, judge_cells
from .table import Runs
from .verdict import Judged

LEAST_SCALES = 5


def paths(runs: Runs, name: str, sweep: str) -> dict[tuple, list[dict]]:
    """Place (scene, level, seed) -> rows of the cases NAME xSCALE, each with its scale."""
    found: dict[tuple, list[dict]] = {}
    cases = set()
    for row in runs.rows:
        match = STIFFNESS.match(row["case"])
        cases.add(match.group(1) if match else row["case"])
        if match and match.group(1) == name:
            found.setdefault((row["scene"], row["level"], row["seed"]), []).append(
                row | {"scale": float(match.group(2))}
            )
    if not found or min(len({r["scale"] for r in rows}) for rows in found.values()) < LEAST_SCALES:
        raise UserError(
            f"sweep {sweep} has no {LEAST_SCALES} cases '{name} xSCALE'; it has {', '.join(sorted(cases))}"
        )
    return found


def _points(rows: list[dict], metric: str) -> list[Point]:
    """Runs that ended ok. Comparability is not asked: the reference of a sweep has one gap, and here gaps are
    made equal.
    """
    return [
        (
            Point(r["scale"], r["gap_rel"], r.get(metric))
            if r["outcome"] == "ok"
            else Point(r["scale"], None, None)
        )
        for r in rows
    ]


def _why_not(mine: list[Point], other: list[Point]) -> str:
    if None in (reached(mine), reached(other)):
        return "where one has no two neighbouring stiffnesses that get through"
    return "without a shared gap"


def at_equal_gap(part: dict, runs: Runs) -> Judged:
    """metric of `case` over that of `over` at equal reached gap: mean over all gaps that both reach from the
    same start, then as `ratio`.
    """
    mine, other = (paths(runs, part[key], part["sweep"]) for key in ("case", "over"))
    cells, left_out, example = {}, Counter(), []
    for place in sorted(mine.keys() & other.keys()):
        if not _scene(part, place):
            continue
        a, b = _points(mine[place], part["metric"]), _points(other[place], part["metric"])
        ratio = log_ratio(a, b)
        if ratio is None:
            left_out[_why_not(a, b)] += 1
            continue
        cells.setdefault(place[0], {}).setdefault(place[1], []).append(ratio)
        example = example or [
            next(r["run"] for r in rows if r["scale"] == 1)
            for rows in (mine[place], other[place])
            if any(r["scale"] == 1 for r in rows)
        ]
    judged = judge_cells(cells, left_out, part, True, "pairs of paths over stiffness")
    judged.measures = f"{METRICS[part['metric']][0]} at equal reached gap: {part['case']} / {part['over']}"
    judged.runs = example
    return judged
