"""The slice of a part: which theta and strain limit its runs have. Taken from the sweep file, and held
against what the part says.
"""

import json
from functools import cache

from barrierbench_analysis.io.errors import UserError

from .entry import Sweep
from .inputs import asked_once
from .merged import limit_of, theta_of
from .table import Runs


def _equal(asked, value) -> bool:
    """true is not 1."""
    return asked == value and isinstance(asked, bool) == isinstance(value, bool)


def _wanted(part: dict, sweep: Sweep, name: str):
    """The value of an axis that a part names; the limit is an axis `enabled` too."""
    values = sweep.axes[name]
    asked = part.get(name, part["limit"] != "off" if name == "enabled" and "limit" in part else None)
    if not any(_equal(asked, value) for value in values):
        raise UserError(
            f"{part.get('says', part)}: {name}: found {asked!r}; {sweep.file} has"
            f" {', '.join(map(json.dumps, values))}, and a part names one of them"
        )
    return asked


def rows_of(part: dict, runs: Runs, sweep: Sweep) -> Runs:
    """The runs in the slice of a part: all of them where the sweep has no further axis."""
    if not sweep.axes:
        return runs
    wanted = {name: _wanted(part, sweep, name) for name in sweep.axes}
    rows = [row for row in runs.rows if all(_equal(value, row[name]) for name, value in wanted.items())]
    return Runs(runs.about, rows)


@cache
def _words(sweep: Sweep) -> dict[str, tuple[float | None, str]]:
    """Note -> theta and limit of its run."""
    return {note: (theta_of(config), limit_of(config)) for note, config in asked_once(sweep).items()}


def _of_case(part: dict, sweep: Sweep, case: str) -> dict[str, set[tuple[float | None, str]]]:
    """Scene that counts -> theta and limit of its runs of a case, or of all scales of one."""
    wanted = {name: _wanted(part, sweep, name) for name in sweep.axes}
    found: dict[str, set] = {}
    for note, (scene, _, label, _) in sweep.cases.items():
        counts = scene in part.get("scenes", [scene]) and (label == case or label.startswith(f"{case} x"))
        if counts and all(_equal(value, sweep.more[note][name]) for name, value in wanted.items()):
            found.setdefault(scene, set()).add(_words(sweep)[note])
    return found


def _check(part: dict, sweep: Sweep, case: str, found: dict[str, set[tuple]]) -> None:
    """Errors: UserError where a scene that counts has another theta or limit than the part names."""
    for k, name in enumerate(("theta", "limit")):
        values = {scene: {words[k] for words in of} for scene, of in sorted(found.items())}
        unlike = {scene: of for scene, of in values.items() if name in part and of != {part[name]}}
        if unlike:
            has = (f"{scene}: {', '.join(map(repr, sorted(of, key=str)))}" for scene, of in unlike.items())
            raise UserError(
                f"{part.get('says', part)}: {name}: found {part[name]!r}; the runs of {case} in"
                f" {sweep.file} have {'; '.join(has)} (`scenes` names those that count)"
            )


def _pooled(words: dict[str, set[str]], name: str) -> str:
    """`name` with the word of most scenes, and in brackets which scenes have another: all that is pooled."""
    by: dict[str, list[str]] = {}
    for scene, of in words.items():
        by.setdefault(" or ".join(sorted(of)), []).append(scene)
    (most, _), *others = sorted(by.items(), key=lambda item: -len(item[1]))
    rest = "; ".join(f"{', '.join(scenes)}: {word}" for word, scenes in others)
    return f"{name}{most}" + (f" ({rest})" if rest else "")


def _in_words(found: dict[str, set[tuple]]) -> tuple[str, str]:
    def word(theta: float | None) -> str:
        return "stiffness as given" if theta is None else f"theta {theta:g}"

    thetas = {scene: {word(theta) for theta, _ in of} for scene, of in found.items()}
    limits = {scene: {limit for _, limit in of} for scene, of in found.items()}
    return _pooled(thetas, ""), _pooled(limits, "limit ")


def slice_of(part: dict, sweep: Sweep) -> str:
    """theta and limit in words, of the scenes that count: once where all cases of the part share them, else
    case by case. Errors: UserError where these are not what the part names.
    """
    cases = [part[key] for key in ("case", "over") if key in part] or list(
        dict.fromkeys(place[2] for place in sweep.cases.values())
    )
    found = {}
    for case in cases:
        if of := _of_case(part, sweep, case):
            _check(part, sweep, case, of)
            found[case] = _in_words(of)
    if not found:
        return ""
    if len(set(found.values())) == 1:
        return ", ".join(next(iter(found.values())))
    thetas, limits = map(set, zip(*found.values()))
    if len(thetas) == 1:
        return "; ".join([*thetas, *(f"{case}: {limit}" for case, (_, limit) in found.items())])
    if len(limits) == 1:
        return "; ".join([*(f"{case}: {theta}" for case, (theta, _) in found.items()), *limits])
    return "; ".join(f"{case}: {theta}, {limit}" for case, (theta, limit) in found.items())
