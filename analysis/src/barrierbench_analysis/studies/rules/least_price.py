"""Barriers that a law asks for beside log, cubic and the consistent dynamic stiffness, in the scenes of the
study at size: `minimax`, bounded and unbounded, and the exponential at its best exponent.

Their exponents follow from the range of loads that a run with the log had in that scene on its coarsest mesh
(XS): what is measured at S was not used for them. The runs of log and cubic are those of at_size.
"""

import functools
import inspect
import math
from collections.abc import Iterator

from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.studies.kit.study.page import rows_of
from barrierbench_analysis.studies.kit.study.spec import Case, Cell, Study, read_study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.tables.numbers import written
from barrierbench_analysis.tables.outcomes import OK
from barrierbench_analysis.tables.words import counted

from . import at_size
from .at_size import causes, measured, pairs, stops
from .at_size.cells import AXES, settings
from .at_size.pairs import Rows, Where

PARTIAL = True
USES = (
    inspect.getmodule(settings),
    causes,
    measured,
    pairs,
    stops,
)  # what numbers depend on beside this file
ALIKE = ("scene", "size", "setting")
MEASURED = at_size.MEASURED
FIRST, LAST = 3.0, 40.0  # exponents that the barriers have
METRICS = {
    "cond_p95": "cond, raw",
    "bj_p95": "cond, block Jacobi",
    "pcg": "PCG iterations",
    "velocity_newton": "Newton iterations",
}


@functools.cache
def base() -> Study:
    """The study at size, whose scenes and rows these runs stand beside."""
    return read_study("at_size")


def exponent(shape: str, load_ratio: float, theta: float) -> float:
    """Of a barrier for loads of this ratio, the largest of which rests at theta d_hat (load-ranges.md)."""
    if shape == "exponential":
        found = best_exponential(load_ratio, 1 - theta)
    elif shape == "minimax_bounded":
        found = (1.5 + math.log(load_ratio)) / (1 - theta)
    else:
        found = 2.5 + math.log(load_ratio)
    return min(max(found, FIRST), LAST)


def exponential_price(a: float, load_ratio: float, depths: float) -> float:
    """Largest relative stiffness over the loads, times the range of depths: it is at the least load, since
    f'/f falls with depth and f' grows. Cost: a bisection.
    """

    def force(s: float) -> float:
        return math.exp(a * s) - 1 - a * s

    least, low, high = force(depths) / load_ratio, 0.0, depths
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if force(middle) < least else (low, middle)
    return depths * a * (math.exp(a * high) - 1) / least


def best_exponential(load_ratio: float, depths: float) -> float:
    """The exponent at which that price is least."""
    from scipy.optimize import minimize_scalar

    found = minimize_scalar(
        lambda a: exponential_price(a, load_ratio, depths), bounds=(FIRST, LAST), method="bounded"
    )
    return float(found.x)


def cells(study: Study) -> Iterator[Case]:
    """The scenes, sizes and targets of the spec with every barrier of a law."""
    for size in study.about["sizes"]:
        for scene, load_ratio in study.about["load_ratios"].items():
            for shape in study.about["shapes"]:
                for theta in study.about["thetas"]:
                    words = (scene, size, shape, theta, "base", "diagnosed")
                    place = dict(zip(AXES, words, strict=True))
                    found = settings(base(), place | {"arm": "log"})
                    a = exponent(shape, load_ratio, float(theta))
                    found["/formulation"] |= {"name": shape, "shape": f"{shape}:{a:.3g}"}
                    yield Case(place, found)


def measure(study: Study, cell: Cell, record: dict) -> dict[str, float | None]:
    """What the study at size measures."""
    return at_size.measure(base(), cell, record)


def _over(rows: Rows, arm: str, under: str, where: Where) -> list[str]:
    """Geometric means over scenes of the ratios of all METRICS, and in how many scenes both end ok."""
    ratios = [rows.ratio(metric, where, arm, under) for metric in METRICS]
    return [str(len(rows.pairs(where, arm, under))), *map(written, ratios)]


def _ends(rows: Rows, arm: str, where: Where) -> str:
    mine = rows.of(arm, where)
    return f"{sum(row.outcome == OK for row in mine.values())} of {len(mine)}"


def _won(rows: Rows, arm: str, where: Where) -> str:
    """Scenes in which a barrier has fewer Newton iterations and PCG iterations than both log and cubic."""
    found = []
    for metric in ("velocity_newton", "pcg"):
        log, cubic = (rows.logs(metric, where, arm, under) for under in ("log", "cubic"))
        found.append(sum(log[s] < 0 and cubic[s] < 0 for s in log if s in cubic))
    return " and ".join(str(n) for n in found)


def rule(study: Study, rows: list[Row]) -> dict:
    """The tables of the page."""
    of, body = Rows(base(), rows + rows_of(base())), []
    for size in study.about["sizes"]:
        for theta in study.about["thetas"]:
            where = Where(size, theta)
            for arm in study.about["shapes"]:
                for under in ("log", "cubic"):
                    numbers = _over(of, arm, under, where)
                    ends = [_ends(of, arm, where), _won(of, arm, where)]
                    body.append([size, theta, arm, under, *ends, *numbers])
    head = ["size", "theta", "barrier", "over", "ends ok", "scenes ahead of both (Newton and PCG)", "scenes"]
    exponents = [
        [scene, theta, f"{r:.3g}", *(f"{exponent(s, r, float(theta)):.3g}" for s in study.about["shapes"])]
        for scene, r in study.about["load_ratios"].items()
        for theta in study.about["thetas"]
    ]
    return {
        "table": "\n".join(markdown([*head, *METRICS.values()], body)),
        "exponents": "\n".join(markdown(["scene", "theta", "load ratio", *study.about["shapes"]], exponents)),
        "rows": len(rows),
        "cells": counted(len(study.cells), "run"),
    }
