"""Rule `outcomes`: which of two cases gets through, scene by scene and level by level."""

from __future__ import annotations

from .entry import ClaimError
from .estimate import sign_test, wilson
from .numbers import by_place
from .table import Runs
from .verdict import HOLDS, LEVELS, NOT, ONLY_IF, SCENES, STARTS, Judged, undecided

LEVEL = 0.05


def _good(row: dict, bad: str | None) -> bool:
    if bad is not None and row[bad] is None:
        raise ClaimError(f"{row['scene']} {row['level']} {row['case']} main={row['seed']}: no {bad}: its record lacks what that is counted in")
    return row["outcome"] == "ok" if bad is None else not row[bad]


def _cells(runs: Runs, case: str, part: dict) -> dict[tuple[str, str], list[bool]]:
    found: dict[tuple[str, str], list[bool]] = {}
    for (scene, level, _), row in sorted(by_place(runs, case, part["sweep"]).items()):
        if scene in part.get("scenes", [scene]):
            found.setdefault((scene, level), []).append(_good(row, part.get("bad")))
    return found


def _enough(cells: dict) -> int:
    levels: dict[str, int] = {}
    for (scene, _), starts in cells.items():
        levels[scene] = levels.get(scene, 0) + (len(starts) >= STARTS)
    return sum(n >= LEVELS for n in levels.values())


def _through(cells: dict) -> dict[str, bool]:
    """Level -> whether every start of every scene got through there."""
    levels: dict[str, bool] = {}
    for (_, level), starts in cells.items():
        levels[level] = levels.get(level, True) and all(starts)
    return levels


def hopeless(runs: Runs, bad: str | None = None) -> set[tuple[str, str]]:
    """Scenes x levels where no run of any case gets through: they compare nothing."""
    good: dict[tuple[str, str], bool] = {}
    for row in runs.rows:
        place = row["scene"], row["level"]
        good[place] = good.get(place, False) or _good(row, bad)
    return {place for place, any_good in good.items() if not any_good}


def outcomes(part: dict, runs: Runs) -> Judged:
    """`case` gets through everything, or (needs: "more") through more than `over`: a sign test over scenes x levels, whose starts are
    no independent trials; without one that only one of the two gets through, it is no more than the other. bad: a metric that is 1 where a run failed in the way meant, in the place of any outcome but ok."""
    left_out = hopeless(runs, part.get("bad"))
    mine = {place: starts for place, starts in _cells(runs, part["case"], part).items() if place not in left_out}
    if not mine:
        return undecided("no case of the sweep gets through anything")
    n, good = sum(map(len, mine.values())), sum(map(sum, mine.values()))
    lower, upper = wilson(good, n)
    more = {"value": good / n, "lower": lower, "upper": upper, "bounds": (1.0,), "threshold": "every run gets through",
            "measures": f"share of runs {'without ' + part['bad'] if 'bad' in part else 'that end ok'}: {part['case']}", "counted": f"{good} of {n} runs"}
    if left := sorted(" ".join(place) for place in left_out):
        more["counted"] += f" ({', '.join(left)} left out: no case gets through)"
    more["runs"] = [row["run"] for row in runs.rows if row["case"] == part["case"]][:1]
    if (scenes := _enough(mine)) < SCENES:
        return undecided(f"indication: {scenes} scenes have {LEVELS} levels of {STARTS} starts, {SCENES} are needed", **more)
    wins = losses = 0
    if "over" in part:
        other = {place: starts for place, starts in _cells(runs, part["over"], part).items() if place not in left_out}
        pairs = [(all(mine[place]), all(other[place])) for place in mine.keys() & other.keys()]
        wins, losses = sum(a and not b for a, b in pairs), sum(b and not a for a, b in pairs)
        more["counted"] += f"; {part['over']}: {sum(map(sum, other.values()))} of {sum(map(len, other.values()))}; scenes x levels that only one gets through: {wins} to {losses}"
        more["threshold"] = f"more than {part['over']}" + ("" if part.get("needs") == "more" else ", and every run")
        p = sign_test(wins, losses)
        if wins == losses == 0:
            return Judged(NOT, **more)
        if p >= LEVEL:
            return undecided(f"{wins} wins and {losses} losses: a sign test does not tell them apart (p = {p:.2g})", **more)
        if losses > wins:
            return Judged(NOT, **more)
        if part.get("needs") == "more":
            return Judged(HOLDS, **more)
    if good == n:
        return Judged(HOLDS, **more)
    levels = _through(mine)
    through = [level for level, ok in levels.items() if ok]
    if not through:
        return Judged(NOT, **more)
    return Judged(ONLY_IF, condition=f"level {', '.join(through)}; not {', '.join(level for level, ok in levels.items() if not ok)}", **more)
