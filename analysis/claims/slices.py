"""The slice of a part: which theta and strain limit its runs have. Taken from the sweep file, and held against what the part says."""

from __future__ import annotations

import json
from functools import cache

from .entry import ClaimError, Sweep, word
from .merged import limit_of, merged, theta_of
from .table import Runs


@cache
def _configs(sweep: Sweep) -> dict[str, list[dict]]:
    """Case (axis 1) -> its configs, one for each value of every further axis, in the first scene and level; `values` has those values."""
    data = json.loads(sweep.path.read_text())
    first, found = data["axes"][0]["cases"][0]["set"], {}
    others = [axis for axis in data["axes"][2:] if word(axis["pointer"]) in sweep.axes]
    for case in data["axes"][1]["cases"]:
        configs = [{"values": {}, "set": {}}]
        for axis in others:
            name = word(axis["pointer"])
            configs = [{"values": {**c["values"], name: value}, "set": {**c["set"], axis["pointer"]: value}} for c in configs for value in axis["values"]]
        found[case["label"]] = [c | {"config": merged(data, sweep.path, first, case["set"], c["set"])} for c in configs]
    return found


def _equal(asked, value) -> bool:
    """true is not 1."""
    return asked == value and isinstance(asked, bool) == isinstance(value, bool)


def _wanted(part: dict, sweep: Sweep, name: str):
    """The value of an axis that a part names; the limit is an axis `enabled` too."""
    values = sweep.axes[name]
    asked = part.get(name, part["limit"] != "off" if name == "enabled" and "limit" in part else None)
    if not any(_equal(asked, value) for value in values):
        raise ClaimError(f"{part.get('says', part)}: {name}: found {asked!r}; {sweep.file} has {', '.join(map(json.dumps, values))}, and a part names one of them")
    return asked


def rows_of(part: dict, runs: Runs, sweep: Sweep) -> Runs:
    """The runs in the slice of a part: all of them where the sweep has no further axis."""
    if not sweep.axes:
        return runs
    wanted = {name: _wanted(part, sweep, name) for name in sweep.axes}
    rows = [row for row in runs.rows if all(_equal(value, row[name]) for name, value in wanted.items())]
    return Runs(runs.about, rows, runs.expected)


def _of_case(part: dict, sweep: Sweep, case: str) -> tuple[str, str]:
    wanted = {name: _wanted(part, sweep, name) for name in sweep.axes}
    configs = [c["config"] for label, found in _configs(sweep).items() if label == case or label.startswith(f"{case} x") for c in found if c["values"] == wanted]
    if not configs:
        return "", ""
    theta, limit = theta_of(configs[0]), limit_of(configs[0])
    for name, found in (("theta", theta), ("limit", limit)):
        if name in part and name not in sweep.axes and part[name] != found and case == part.get("case"):
            raise ClaimError(f"{part.get('says', part)}: {name}: found {part[name]!r}; the runs of {case} in {sweep.file} have {found!r}")
    return "stiffness as given" if theta is None else f"theta {theta:g}", f"limit {limit}"


def slice_of(part: dict, sweep: Sweep) -> str:
    """theta and limit in words: once where all cases of the part share them, else case by case."""
    cases = [part[key] for key in ("case", "over") if key in part] or list(_configs(sweep))
    found = {case: _of_case(part, sweep, case) for case in cases}
    if len(set(found.values())) == 1:
        return ", ".join(next(iter(found.values())))
    shared = {limit for _, limit in found.values()}
    thetas = {theta for theta, _ in found.values()}
    if len(thetas) == 1:
        return f"{thetas.pop()}; " + "; ".join(f"{case}: {limit}" for case, (_, limit) in found.items())
    if len(shared) == 1:
        return "; ".join(f"{case}: {theta}" for case, (theta, _) in found.items()) + f"; {shared.pop()}"
    return "; ".join(f"{case}: {theta}, {limit}" for case, (theta, limit) in found.items())
