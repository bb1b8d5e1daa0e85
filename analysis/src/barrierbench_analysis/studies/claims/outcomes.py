"""Rule `outcomes`: which of two cases gets through, scene by scene."""

from __future__ import annotations

import math
from collections import Counter
from fractions import Fraction

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.kit.success import COMMON, COMMON_WORDS, RESIDUAL, ROUNDING, TIME, failures
from barrierbench_analysis.tables.estimate import of_scenes, sign_test, wilson

from .cells import complete, needed, starts_text
from .numbers import by_place
from .parts import MOST
from .table import Runs
from .verdict import HOLDS, NOT, ONLY_IF, SCENES, Judged, undecided

LEVEL = 0.05


def _failures(row: dict, bad: str | None, residual: float | None = None) -> list[str]:
    """In what a run failed; without `bad` its outcome. residual: the largest at a step end that is no
    failure, in tolerances; None: whatever it is.
    """
    if bad is None:
        return [] if row["outcome"] == "ok" else [row["outcome"]]
    if absent := [name for name in failures(bad) if row[name] is None]:
        raise UserError(
            f"{row['scene']} {row['level']} {row['case']} main={row['seed']}: no {absent[0]}: its record"
            " lacks what that is counted in"
        )
    found = [name for name in failures(bad) if row[name]]
    if residual is None or (found and row[RESIDUAL] is None):  # without a step end there is no residual
        return found
    if row[RESIDUAL] is None:
        raise UserError(
            f"{row['scene']} {row['level']} {row['case']} main={row['seed']}: no {RESIDUAL}: its record lacks"
            " what that is counted in"
        )
    return found + ["large_residual"] * (row[RESIDUAL] > residual)


def good(row: dict, bad: str | None, residual: float | None = None) -> bool:
    return not _failures(row, bad, residual)


def check_times(rows: list[dict], cases: list[str]) -> None:
    """Errors: UserError where the cases are not asked for one simulated time at one scene and level: what
    they reach then compares nothing.
    """
    firsts: dict[tuple[str, str], dict] = {}
    for row in rows:
        if row["case"] not in cases:
            continue
        first = firsts.setdefault((row["scene"], row["level"]), row)
        if (
            first[TIME] is None
            or row[TIME] is None
            or not math.isclose(first[TIME], row[TIME], rel_tol=ROUNDING)
        ):
            raise UserError(
                f"{row['scene']} {row['level']}: {first['case']} is asked for {first[TIME]} s and"
                f" {row['case']} for {row[TIME]} s; equal simulated times are needed (/time/duration_s)"
            )


def _cells(runs: Runs, case: str, part: dict) -> dict[tuple[str, str], list[bool]]:
    found: dict[tuple[str, str], list[bool]] = {}
    for (scene, level, _), row in sorted(by_place(runs, case, part["sweep"]).items()):
        if scene in part.get("scenes", [scene]):
            found.setdefault((scene, level), []).append(good(row, part.get("bad"), part.get(MOST)))
    return found


def _by_scene(cells: dict) -> dict[str, dict[str, list[bool]]]:
    found: dict[str, dict[str, list[bool]]] = {}
    for (scene, level), starts in cells.items():
        found.setdefault(scene, {})[level] = starts
    return found


def _shares(cells: dict) -> list[tuple[str, float, float, float, int, int]]:
    """Of every scene: mean over its levels of the share of starts that get through, the least and the largest
    level, levels, runs.
    """
    scenes = of_scenes(
        {
            name: {level: [float(x) for x in starts] for level, starts in levels.items()}
            for name, levels in _by_scene(cells).items()
        }
    )
    return [(s.name, s.value, s.low, s.high, s.levels, s.n) for s in scenes]


def _share(starts: list[bool]) -> Fraction:
    return Fraction(sum(starts), len(starts))


def _signs(mine: dict, other: dict) -> tuple[int, int, int]:
    """Scenes that are won, lost and even: by the shares of starts that get through, summed over the levels.
    Levels that get through with every start would call a case that loses one start in ten even with one that
    loses all, and nothing of what they differ in would be left.
    """
    ahead: dict[str, Fraction] = {}
    for place in mine:
        ahead[place[0]] = ahead.get(place[0], Fraction()) + _share(mine[place]) - _share(other[place])
    signs = list(ahead.values())
    return sum(x > 0 for x in signs), sum(x < 0 for x in signs), sum(x == 0 for x in signs)


def _complete(mine: dict, other: dict | None, part: dict) -> tuple[set[tuple[str, str]], str]:
    """Scenes x levels with all that a verdict needs, of both cases, and what falls out, in words."""
    shared = (
        mine
        if other is None
        else {place: min(mine[place], other[place], key=len) for place in mine.keys() & other.keys()}
    )
    levels = complete(_by_scene(shared), part)
    kept = {(scene, level) for scene, of in levels.items() for level in of}
    scenes = sorted({place[0] for place in mine} - levels.keys())
    places = sorted(" ".join(place) for place in mine.keys() - kept if place[0] in levels)
    return kept, (
        f"; without {needed(part)}, so not judged: {', '.join(scenes + places)}" if scenes or places else ""
    )


def _tells(wins: int, losses: int, even: int) -> str:
    """Why signs tell nothing; with few scenes not even the same sign in each does."""
    least = next(n for n in range(1, 64) if sign_test(n, 0) < LEVEL)
    few = (
        f"; of {wins + losses + even} scenes no outcome would, {least} are needed"
        if wins + losses + even < least
        else ""
    )
    return (
        f"{wins} scenes won, {losses} lost, {even} even: a sign test does not tell them apart (p ="
        f" {sign_test(wins, losses):.2g}{few})"
    )


def _through(cells: dict) -> dict[str, bool]:
    """Level -> whether every start of every scene got through there."""
    levels: dict[str, bool] = {}
    for (_, level), starts in cells.items():
        levels[level] = levels.get(level, True) and all(starts)
    return levels


def hopeless(runs: Runs, bad: str | None = None) -> set[tuple[str, str]]:
    """Scenes x levels where no run of any case gets through: they compare nothing."""
    found: dict[tuple[str, str], bool] = {}
    for row in runs.rows:
        place = row["scene"], row["level"]
        found[place] = found.get(place, False) or good(row, bad)
    return {place for place, any_good in found.items() if not any_good}


def _residual(rows: list[dict]) -> str:
    found = [row[RESIDUAL] for row in rows if row.get(RESIDUAL) is not None]
    return f", residuals up to {max(found):.2g} tolerances" if found else ""


def _why(part: dict, runs: Runs, kept: set[tuple[str, str]]) -> str:
    """Of every case how many runs were judged, in what they failed, where a run may fail in more than one
    way, and their residuals where these are read.
    """
    said = []
    for case in (part[key] for key in ("case", "over") if key in part):
        rows = [row for row in runs.rows if row["case"] == case and (row["scene"], row["level"]) in kept]
        found = Counter(name for row in rows for name in _failures(row, part["bad"], part.get(MOST)))
        said.append(
            f"{case}: {len(rows)} judged"
            + "".join(f", {n} {name}" for name, n in sorted(found.items()))
            + (_residual(rows) if part["bad"] == COMMON else "")
        )
    return "; ".join(said)


def outcomes(part: dict, runs: Runs) -> Judged:
    """`case` gets through everything, or (needs: "more") through more than `over`: a sign test over scenes,
    of those scenes and levels alone that have what a verdict needs. Where the same share of starts gets
    through at every place it is no more than the other. Places where no case of the sweep gets through
    compare nothing and are left out of a comparison; where one case is asked for every run they are failures.
    bad: a metric that is 1 where a run failed in the way meant, in the place of any outcome but ok; or
    `common`, the success that all methods share (success.py).
    """
    if part.get("bad") == COMMON:
        check_times(runs.rows, [part[key] for key in ("case", "over") if key in part])
    left_out = hopeless(runs, part.get("bad")) if "over" in part else set()
    cases = [
        {place: starts for place, starts in _cells(runs, part[key], part).items() if place not in left_out}
        for key in ("case", "over")
        if key in part
    ]
    if not cases[0]:
        return undecided("no case of the sweep gets through anything")
    kept, fell_out = _complete(cases[0], cases[1] if "over" in part else None, part)
    enough = len({scene for scene, _ in kept})
    judged = (
        [{place: starts for place, starts in cells.items() if place in kept} for cells in cases]
        if enough >= SCENES
        else cases
    )
    more = _numbers(part, runs, judged[0], left_out)
    more["counted"] += fell_out + (f"; {_why(part, runs, judged[0].keys())}" if "bad" in part else "")
    if enough < SCENES:
        return undecided(f"indication: {enough} scenes have {needed(part)}, {SCENES} are needed", **more)
    if "over" in part and (decided := _beside(part, *judged, more)):
        return decided
    return _every_run(judged[0], more)


def _beside(part: dict, mine: dict, other: dict, more: dict) -> Judged | None:
    """What the comparison with `over` decides; None where every run is asked for as well. Adds its numbers to
    `more`.
    """
    wins, losses, even = _signs(mine, other)
    places = [(all(mine[place]), all(other[place])) for place in mine]
    only = sum(a and not b for a, b in places), sum(b and not a for a, b in places)
    more["counted"] += (
        f"; {part['over']}: {sum(map(sum, other.values()))} of {sum(map(len, other.values()))}; scenes won,"
        f" lost, even: {wins}, {losses}, {even} (scenes x levels that only one gets through: {only[0]} to"
        f" {only[1]})"
    )
    more["threshold"] = f"more than {part['over']}" + (
        "" if part.get("needs") == "more" else ", and every run"
    )
    if part.get("needs") == "more":
        more["bounds"] = (sum(low == 1 for _, _, low, *_ in _shares(other)) / len(_shares(other)),)
    if all(_share(mine[place]) == _share(other[place]) for place in mine):
        return Judged(NOT, **more)
    if sign_test(wins, losses) >= LEVEL:
        return undecided(_tells(wins, losses, even), **more)
    if losses > wins:
        return Judged(NOT, **more)
    return Judged(HOLDS, **more) if part.get("needs") == "more" else None


def asked(part: dict) -> str:
    """What a run has to do, in words."""
    if "bad" not in part:
        return "ends ok"
    words = COMMON_WORDS if part["bad"] == COMMON else f"is without {part['bad']}"
    return f"{words}, residuals of at most {part[MOST]:g} tolerances" if MOST in part else words


def _numbers(part: dict, runs: Runs, mine: dict, left_out: set) -> dict:
    """The share of scenes in which every run gets through, with Wilson's interval over scenes; the mean share
    of runs stands beside it.
    """
    shares = _shares(mine)
    n, through = sum(map(len, mine.values())), sum(map(sum, mine.values()))
    whole = sum(low == 1 for _, _, low, _, _, _ in shares)
    lower, upper = wilson(whole, len(shares))
    counted = (
        f"every run in {whole} of {len(shares)} scenes; {through} of {n} runs, mean share of scenes"
        f" {sum(value for _, value, *_ in shares) / len(shares):.3g}"
    )
    if left := sorted(" ".join(place) for place in left_out):
        counted += f" ({', '.join(left)} left out: no case gets through)"
    return {
        "value": whole / len(shares),
        "lower": lower,
        "upper": upper,
        "bounds": (1.0,),
        "threshold": "every run gets through",
        "measures": f"share of scenes in which every run {asked(part)}: {part['case']}",
        "counted": counted,
        "per_scene": shares,
        "scenes": len(shares),
        "starts": starts_text([[float(x) for x in starts] for starts in mine.values()]),
        "runs": [row["run"] for row in runs.rows if row["case"] == part["case"]][:1],
    }


def _every_run(mine: dict, more: dict) -> Judged:
    levels = _through(mine)
    through = [level for level, ok in levels.items() if ok]
    if len(through) == len(levels):
        return Judged(HOLDS, **more)
    if not through:
        return Judged(NOT, **more)
    return Judged(
        ONLY_IF,
        condition=(
            f"level {', '.join(through)}; not {', '.join(level for level, ok in levels.items() if not ok)}"
        ),
        **more,
    )
