"""Numbers of a work-precision study: what a formulation reaches, what it costs, who is cheaper. Failed runs never solve anything and stay counted."""

from __future__ import annotations

import math
from dataclasses import dataclass

# Cost -> the solver whose runs have it, and what it is.
COSTS = {"seconds": ("direct", "seconds"), "newton": ("direct", "Newton iterations"), "factorizations": ("direct", "factorisations"),
         "products": ("pcg", "matrix products of PCG")}


@dataclass(frozen=True)
class Point:
    formulation: str
    problem: tuple[str, float]  # axis, factor
    cost: float
    error: float | None  # None: the run failed or is not valid
    outcome: str
    run: str


def band_of(scene: dict, row: dict | None = None) -> float:
    """The uncertainty of the reference of a run, of the anchor's without one: errors below it are not ranked."""
    factor = row["factor"] if row is not None and row["axis"] == "dt_s" else 1.0
    bands = {ref["dt_factor"]: ref["band"].get(scene["error"], 0.0) for ref in scene["references"]}
    return bands.get(factor, bands[1.0])


def points(scene: dict, cost: str) -> list[Point]:
    """Of one cost. An error below its band counts as the band: below it nothing is known."""
    solver = COSTS[cost][0]
    return [Point(r["formulation"], (r["axis"], r["factor"]), r[cost] or 0, None if r["error"] is None else max(r["error"], band_of(scene, r)), r["outcome"], r["run"])
            for r in scene["rows"] if r["solver"] == solver]


def formulations(scene: dict) -> list[str]:
    return list(dict.fromkeys(row["formulation"] for row in scene["rows"]))


def smallest_error(all_points: list[Point], formulation: str) -> float:
    """inf where no run counts."""
    return min((p.error for p in all_points if p.formulation == formulation and p.error is not None), default=math.inf)


def cost_to(all_points: list[Point], formulation: str, error: float) -> float:
    """The least cost of a run of the formulation with at most that error; inf: none of its runs."""
    return min((p.cost for p in all_points if p.formulation == formulation and p.error is not None and p.error <= error), default=math.inf)


def front(all_points: list[Point], formulation: str) -> list[tuple[float, float]]:
    """(cost, error) of the runs that no cheaper run of the same formulation equals or betters, by growing cost."""
    out: list[tuple[float, float]] = []
    for p in sorted((p for p in all_points if p.formulation == formulation and p.error is not None), key=lambda p: (p.cost, p.error)):
        if not out or p.error < out[-1][1]:
            out.append((p.cost, p.error))
    return out


def cheapest(all_points: list[Point], names: list[str]) -> list[tuple[float, str]]:
    """(error, formulation): who reaches each error that occurs at the least cost, from the largest error to the smallest. A tie counts for none before
    the first of `names`."""
    levels = sorted({p.error for p in all_points if p.error is not None}, reverse=True)
    return [(x, min(names, key=lambda name: cost_to(all_points, name, x))) for x in levels]


@dataclass(frozen=True)
class Standing:
    formulation: str
    solved: int  # runs that count
    runs: int
    smallest: float
    cost_there: float
    cheapest_down_to: float  # smallest error at which nobody is cheaper; inf: somebody is everywhere
    cheaper: str  # who is cheaper just below that, or at its smallest error where it never is the cheapest; empty: nobody


def standing(all_points: list[Point], names: list[str], formulation: str) -> Standing:
    mine = [p for p in all_points if p.formulation == formulation]
    smallest = smallest_error(all_points, formulation)
    levels = sorted({p.error for p in all_points if p.error is not None})

    def least(x: float) -> float:
        return min(cost_to(all_points, name, x) for name in names)

    own = [x for x in levels if cost_to(all_points, formulation, x) == least(x) < math.inf]
    down_to = min(own, default=math.inf)
    below = [x for x in levels if x < down_to]
    cheaper = ""
    if below or not own:
        x = max(below) if own else (smallest if smallest < math.inf else max(levels, default=math.inf))
        cheaper = min(names, key=lambda name: cost_to(all_points, name, x)) if levels else ""
    return Standing(formulation, sum(p.error is not None for p in mine), len(mine), smallest, cost_to(all_points, formulation, smallest) if mine else math.inf,
                    down_to, cheaper)


def profile(scenes: list[dict], cost: str, formulation: str, level: int) -> tuple[list[float], int]:
    """Data profile: the costs at which problems (scene, variation) were solved, sorted, and the number of all problems. A problem is solved when its
    run counts and its error is at most target number `level` of its scene (the last one where it has fewer)."""
    costs, total = [], 0
    for scene in scenes:
        target = scene["targets"][min(level, len(scene["targets"]) - 1)]
        for p in points(scene, cost):
            if p.formulation == formulation:
                total += 1
                if p.error is not None and p.error <= target:
                    costs.append(p.cost)
    return sorted(costs), total
