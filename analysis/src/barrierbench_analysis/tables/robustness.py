"""Who gets through a sweep, at what cost and how far: share of runs, expected cost of a success, frontier of
failure, data profile.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass

from .estimate import wilson


@dataclass(frozen=True)
class Trial:
    """One run: which problem (scene, seed and all else that is equal), the value of the axis, whether it got
    through, and its cost.
    """

    problem: str
    value: float
    ok: bool
    cost: float  # of a run that failed too: it was spent


@dataclass(frozen=True)
class Share:
    """Successes of n trials with the 95% interval of Wilson."""

    ok: int
    n: int
    low: float
    high: float


@dataclass(frozen=True)
class Frontier:
    """From the middle outwards: the least and the largest value up to which every run of every problem gets
    through. None: not even the middle.
    """

    low: float | None
    high: float | None
    fails_below: float | None  # next tested value, at which some run fails; None: the end of what was tested
    fails_above: float | None


def _checked(trials: Iterable[Trial]) -> list[Trial]:
    found = list(trials)
    if not found:
        raise ValueError("no trials: nothing is judged")
    for trial in found:
        if not math.isfinite(trial.value) or not math.isfinite(trial.cost) or trial.cost < 0:
            raise ValueError(
                f"{trial.problem}: value {trial.value}, cost {trial.cost}; a finite value and a finite cost"
                " >= 0 are needed"
            )
    return found


def success(trials: Iterable[Trial]) -> Share:
    """Share of trials that got through. Errors: ValueError without trials."""
    found = _checked(trials)
    ok = sum(t.ok for t in found)
    return Share(ok, len(found), *wilson(ok, len(found)))


def expected_cost(trials: Iterable[Trial]) -> float | None:
    """`ert` of COCO (Hansen et al. 2021): cost of all trials, failed ones included, over the number of
    successes; None without a success.
    """
    found = _checked(trials)
    ok = sum(t.ok for t in found)
    return sum(t.cost for t in found) / ok if ok else None


def _walk(values: list[float], through: dict[float, bool]) -> tuple[float | None, float | None]:
    """The last value before the first at which something fails, and that one."""
    last = None
    for value in values:
        if not through[value]:
            return last, value
        last = value
    return last, None


def frontier(trials: Iterable[Trial], middle: float) -> Frontier:
    """How far from `middle` all trials get through, in both directions. Errors: ValueError when no trial is
    at the middle.
    """
    found = _checked(trials)
    through: dict[float, bool] = {}
    for t in found:
        through[t.value] = through.get(t.value, True) and t.ok
    if middle not in through:
        raise ValueError(f"no trial at {middle:g}; tested: {', '.join(f'{v:g}' for v in sorted(through))}")
    low, below = _walk(sorted((v for v in through if v <= middle), reverse=True), through)
    high, above = _walk(sorted(v for v in through if v >= middle), through)
    return Frontier(low, high, below, above)


def profile(trials: Iterable[Trial]) -> list[tuple[float, float]]:
    """Data profile (More and Wild 2009): (budget, share of problems that were solved with at most it), from
    the cheapest solved one on. Every problem counts once in the denominator, solved or not. Errors:
    ValueError when a problem occurs twice.
    """
    found = _checked(trials)
    problems = [(t.problem, t.value) for t in found]
    if len(set(problems)) != len(problems):
        raise ValueError(f"problem {max(problems, key=problems.count)} occurs twice")
    costs = sorted(t.cost for t in found if t.ok)
    return [
        (cost, (k + 1) / len(found))
        for k, cost in enumerate(costs)
        if k + 1 == len(costs) or costs[k + 1] > cost
    ]
