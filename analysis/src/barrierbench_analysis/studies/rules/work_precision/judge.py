"""What a formulation reaches, what it costs, who is cheaper. Failed runs never solve anything and stay
counted.
"""

import math
from dataclasses import dataclass

# Cost -> the solver whose runs have it, and what it is.
COSTS = {
    "seconds": ("direct", "seconds"),
    "newton": ("direct", "Newton iterations"),
    "factorizations": ("direct", "factorisations"),
    "products": ("pcg", "matrix products of PCG"),
}


@dataclass(frozen=True)
class Point:
    formulation: str
    problem: tuple[str, float]  # axis, factor
    cost: float
    error: float | None  # None: the run failed or is not valid
    outcome: str
    run: str


def band_of(scene: dict, row: dict | None = None) -> float:
    """The uncertainty of the reference of a run, of the anchor's without one: errors below it are not
    ranked."""
    factor = row["factor"] if row is not None and row["axis"] == "dt_s" else 1.0
    bands = {ref["dt_factor"]: ref["band"].get(scene["error"], 0.0) for ref in scene["references"]}
    return bands.get(factor, bands[1.0])


def shares_time_step(scene: dict) -> bool:
    """Whether every run is compared with a refined reference of its own time step, which sees no error in
    time; only those references have a band.
    """
    return any(ref["band"] for ref in scene["references"])


def points(scene: dict, cost: str, ranked: bool = True) -> list[Point]:
    """What is ranked by one cost, or what is not. An error below its band counts as the band: below it
    nothing is known. A cost that was not measured is infinite. Other time steps are not ranked where the
    references share the time step of the runs, so that no error in time is seen: a large step would be cheap
    and cost no precision.
    """
    solver, shared = COSTS[cost][0], shares_time_step(scene)
    return [
        Point(
            r["formulation"],
            (r["axis"], r["factor"]),
            math.inf if r[cost] is None else r[cost],
            None if r["error"] is None else max(r["error"], band_of(scene, r)),
            r["outcome"],
            r["run"],
        )
        for r in scene["rows"]
        if r["solver"] == solver and ranked != (shared and r["axis"] == "dt_s")
    ]


def formulations(scene: dict) -> list[str]:
    return list(dict.fromkeys(row["formulation"] for row in scene["rows"]))


def _counted(all_points: list[Point], formulation: str) -> list[Point]:
    """The runs of a formulation that have an error."""
    return [p for p in all_points if p.formulation == formulation and p.error is not None]


def smallest_error(all_points: list[Point], formulation: str) -> float:
    """inf where no run counts."""
    return min((p.error for p in _counted(all_points, formulation)), default=math.inf)


def cost_to(all_points: list[Point], formulation: str, error: float) -> float:
    """The least cost of a run of the formulation with at most that error; inf: none of its runs."""
    return min((p.cost for p in _counted(all_points, formulation) if p.error <= error), default=math.inf)


def front(all_points: list[Point], formulation: str) -> list[tuple[float, float]]:
    """(cost, error) of the runs that no cheaper run of the same formulation equals or betters, by growing
    cost.
    """
    out: list[tuple[float, float]] = []
    for p in sorted(_counted(all_points, formulation), key=lambda p: (p.cost, p.error)):
        if p.cost < math.inf and (not out or p.error < out[-1][1]):
            out.append((p.cost, p.error))
    return out


def cheapest(all_points: list[Point], names: list[str]) -> list[tuple[float, tuple[str, ...]]]:
    """(error, formulations): who reaches each error that occurs at the least cost, all that cost the same,
    from the largest error to the smallest.
    """
    out = []
    for error in sorted({p.error for p in all_points if p.error is not None}, reverse=True):
        costs = {name: cost_to(all_points, name, error) for name in names}
        least = min(costs.values())
        out.append((error, tuple(name for name in names if costs[name] == least < math.inf)))
    return out


@dataclass(frozen=True)
class Standing:
    solved: int  # runs that count
    runs: int
    smallest: float
    cost_there: float
    # [from, to) of a requested error, the largest first; inf: no upper end
    cheapest_in: tuple[tuple[float, float], ...]


def standing(all_points: list[Point], names: list[str], formulation: str) -> Standing:
    smallest = smallest_error(all_points, formulation)
    intervals: list[tuple[float, float]] = []
    above = math.inf  # costs change at the errors that occur and nowhere in between
    for error, leaders in cheapest(all_points, names):
        if formulation in leaders:
            joined = intervals and intervals[-1][0] == above
            intervals[-1:] = [(error, intervals[-1][1])] if joined else [*intervals[-1:], (error, above)]
        above = error
    return Standing(
        len(_counted(all_points, formulation)),
        sum(p.formulation == formulation for p in all_points),
        smallest,
        cost_to(all_points, formulation, smallest),
        tuple(intervals),
    )


def levels(scenes: list[dict]) -> range:
    """Numbers of the targets."""
    return range(max(len(scene["targets"]) for scene in scenes))


def profile(scenes: list[dict], cost: str, formulation: str, level: int) -> tuple[list[float], int]:
    """Data profile: the costs at which problems (scene, variation) were solved, sorted, and the number of all
    problems. A problem is solved when its run counts, has this cost, and its error is at most target number
    `level` of its scene (the last one where it has fewer).
    """
    costs, total = [], 0
    for scene in scenes:
        target = scene["targets"][min(level, len(scene["targets"]) - 1)]
        found = [p for p in points(scene, cost) if p.formulation == formulation]
        total += len(found)
        solved = [p.cost for p in found if p.error is not None and p.error <= target]
        costs += [one for one in solved if one < math.inf]
    return sorted(costs), total
