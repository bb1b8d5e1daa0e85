"""Scenes with their levels and starts to a verdict: an interval over scenes, and the scatter within each."""

from __future__ import annotations

import math
from collections import Counter

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.tables.estimate import Cells, OfScene, intraclass, of_scenes, student

from .threshold import Threshold
from .verdict import HOLDS, LEVELS, NOT, ONLY_IF, OPEN, SCENES, STARTS, Judged, undecided


def starts_asked(part: dict) -> int:
    """Starts that a level needs: one, since starts are one sample; more where a part says that they matter,
    and why.
    """
    if "starts" not in part:
        return 1
    if part["starts"] != "matter" or not part.get("reason"):
        raise UserError(
            f"{part.get('says', part)}: starts: found {part['starts']!r}; \"matter\" with a reason is needed,"
            " or neither"
        )
    return STARTS


def needed(part: dict) -> str:
    return f"{LEVELS} levels{f' of {STARTS} starts' if starts_asked(part) > 1 else ''} that count"


def complete(cells: Cells, part: dict) -> Cells:
    """Scenes with enough levels; of these the levels with enough starts."""
    least = starts_asked(part)
    enough = {
        scene: {level: v for level, v in levels.items() if len(v) >= least} for scene, levels in cells.items()
    }
    return {scene: levels for scene, levels in enough.items() if len(levels) >= LEVELS}


def left_out_text(left_out: Counter) -> str:
    return (
        "; left out: " + ", ".join(f"{k} {reason}" for reason, k in sorted(left_out.items()))
        if left_out
        else ""
    )


def starts_text(groups: list[list[float]]) -> str:
    """How much alike the starts at one place are."""
    most = max(map(len, groups), default=0)
    if most < 2:
        return "one start at each place"
    found = intraclass(groups)
    return f"up to {most} starts at each of {len(groups)} places, intraclass correlation " + (
        "not defined (all numbers are the same, or one place)" if found is None else f"{found:.4f}"
    )


def _levels(cells: Cells, threshold: Threshold) -> list[tuple[str, str]]:
    """(level, verdict) by an interval over scenes, of the levels that all scenes have; none where these are
    few.
    """
    shared = [
        level for level in next(iter(cells.values())) if all(level in levels for levels in cells.values())
    ]
    values = {
        level: [scene.value for scene in of_scenes({s: {level: v[level]} for s, v in cells.items()})]
        for level in shared
    }
    return (
        [(level, threshold.judge(*student(v))) for level, v in values.items()]
        if len(shared) >= LEVELS
        else []
    )


def _condition(groups: list[tuple[str, str]], what: str) -> str:
    """Where it holds and where not; empty unless both are there and every group is decided: of many open
    groups some hold by chance.
    """
    by = {verdict: [name for name, v in groups if v == verdict] for verdict in (HOLDS, NOT, OPEN)}
    if not by[HOLDS] or not by[NOT] or by[OPEN]:
        return ""
    return f"{what} {', '.join(by[HOLDS])}; not {', '.join(by[NOT])}"


def judge_cells(cells: Cells, left_out: Counter, part: dict, log: bool, what: str) -> Judged:
    judged = complete(cells, part)
    enough = len(judged) >= SCENES
    shown = judged if enough else cells
    levels = _levels(judged, Threshold(part, log)) if enough else []
    groups = [starts for of_level in cells.values() for starts in of_level.values()]
    found = judge_scenes(of_scenes(shown), groups, left_out, part, log, what, levels, len(judged))
    n = sum(map(len, groups))
    found.counted = f"{n} {what} count{left_out_text(left_out)}"
    return found


def judge_scenes(
    scenes: list[OfScene],
    groups: list[list[float]],
    left_out: Counter,
    part: dict,
    log: bool,
    what: str,
    levels: list[tuple[str, str]] = (),
    enough: int | None = None,
) -> Judged:
    """`enough`: how many scenes have all that is needed."""
    threshold, back = Threshold(part, log), math.exp if log else float
    enough = len(scenes) if enough is None else enough
    counted = f"{sum(map(len, groups))} {what} count{left_out_text(left_out)}"
    more = {"threshold": threshold.text, "bounds": threshold.bounds, "counted": counted}
    if not scenes:
        return undecided(f"no run counts ({counted})", **more)
    values = [scene.value for scene in scenes]
    more |= {
        "value": back(sum(values) / len(values)),
        "starts": starts_text(groups),
        "scenes": len(scenes),
        "per_scene": [(s.name, back(s.value), back(s.low), back(s.high), s.levels, s.n) for s in scenes],
    }
    if len(values) > 1:
        lower, upper = map(float, student(values))
        more |= {"lower": _finite(back, lower), "upper": _finite(back, upper)}
    if enough < SCENES:
        return undecided(
            f"indication: {enough} scenes have {needed(part)}, {SCENES} are needed ({counted})", **more
        )
    verdict = threshold.judge(lower, upper)
    by_scene = [(s.name, threshold.judge(s.low, s.high)) for s in scenes]
    return _decided(verdict, by_scene, list(levels), more)


def _decided(
    verdict: str, by_scene: list[tuple[str, str]], by_level: list[tuple[str, str]], more: dict
) -> Judged:
    """The verdict is that of the interval over scenes. A scene contradicts it when all its levels lie on the
    other side (no interval: a statement about these levels), and then scenes are the condition, if every one
    of them lies on one side. more: what else a judgement says.
    """
    contradicting = [name for name, v in by_scene if v == {HOLDS: NOT, NOT: HOLDS}.get(verdict)]
    if verdict != OPEN and not contradicting:
        return Judged(verdict, **more)
    if condition := _condition(by_level, "level") or (_condition(by_scene, "scene") if contradicting else ""):
        return Judged(ONLY_IF, condition=condition, **more)
    if contradicting:
        return undecided(
            f"the mean says {verdict}, {', '.join(contradicting)} the opposite at every level", **more
        )
    return undecided(f"the interval includes the threshold{_sides(by_scene)}", **more)


def _sides(by_scene: list[tuple[str, str]]) -> str:
    """Which scenes lie on one side with every level: told, but no verdict, since a scene is one sample."""
    sides = [
        f"{word}: {', '.join(names)}"
        for verdict, word in (
            (HOLDS, "on the side asked for at every level"),
            (NOT, "on the other at every level"),
        )
        if (names := [name for name, v in by_scene if v == verdict])
    ]
    return f" ({'; '.join(sides)})" if len(sides) == 2 else ""


def _finite(back, x: float) -> float:
    """Intervals of few scenes are wide: what a double cannot hold is infinite."""
    try:
        return back(x)
    except OverflowError:
        return math.inf
