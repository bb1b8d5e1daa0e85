"""results/WORK_PRECISION.md: what each formulation reaches, what a target costs, and within which errors it
is the cheapest.
"""

from __future__ import annotations

import math

from barrierbench_analysis.io.text_table import markdown as table_lines
from barrierbench_analysis.tables.accuracy.errors import MEANING
from barrierbench_analysis.tables.numbers import whole

from .judge import (
    COSTS,
    Standing,
    band_of,
    cost_to,
    formulations,
    points,
    profile,
    shares_time_step,
    standing,
)

HEAD = """# Work and precision

Made by `./bench study work-precision` from results/work_precision.json; docs/results/method/accuracy.md, has the rules. Each scene has an anchor (time step, d_hat,
tolerance) and varies one of these, or every kappa, at a time by a factor. A run counts when it ended ok and is valid; the others are named below
their table and reach nothing. Errors below the uncertainty of the reference are not ranked: they count as that uncertainty. Costs are
those of the cheapest run that reaches the error: seconds, Newton iterations and factorisations with the direct solver, products with conjugate gradients and block
Jacobi. "Cheapest within" has the intervals of an error that is asked for in which no formulation needs fewer Newton iterations; equals share them, and below the
smallest error of all nobody reaches anything. Seconds are those of small scenes on a machine that did other work as well: order of magnitude only. Every
formulation has one start a scene, so that nothing here says how much another start would change.

A refined reference has the time step of the run, so that it sees no error in time and a large step would look free. In the scenes that have such references the
runs of other time steps are kept in work_precision.json and drawn as faint marks, but are not ranked: not in the tables, the lines of the figures, or the profile.
A closed form has no time step, and there all runs are ranked.
"""


def number(x: float | None) -> str:
    return whole(x, none="never")


def intervals(s: Standing) -> str:
    """Errors that are asked for in which it is the cheapest, as words."""
    return (
        "; ".join(
            f"from {number(low)} up" if math.isinf(high) else " to ".join(_apart(low, high))
            for low, high in s.cheapest_in
        )
        or "nowhere"
    )


def _apart(low: float, high: float) -> tuple[str, str]:
    """With as many digits as tell them apart."""
    return next(
        pair
        for pair in ((f"{low:.{digits}g}", f"{high:.{digits}g}") for digits in range(3, 18))
        if pair[0] != pair[1]
    )


def _standings(scene: dict) -> list[str]:
    names, band = formulations(scene), band_of(scene)
    all_points = points(scene, "newton")
    rows = []
    for name in names:
        s = standing(all_points, names, name)
        smallest = number(s.smallest) + (" (band)" if band and s.smallest <= band else "")
        rows.append([name, f"{s.solved} of {s.runs}", smallest, number(s.cost_there), intervals(s)])
    head = ["formulation", "runs that count", "useless below", "Newton iterations there", "cheapest within"]
    return table_lines(head, rows)


def _targets(scene: dict) -> list[str]:
    targets, names = scene["targets"], formulations(scene)
    heads = [f"{text}: error <= " + ", ".join(f"{t:g}" for t in targets) for _, text in COSTS.values()]
    rows = []
    for name in names:
        cells = [", ".join(number(cost_to(points(scene, cost), name, t)) for t in targets) for cost in COSTS]
        rows.append([name, *cells])
    return table_lines(["formulation", *heads], rows)


def _failures(scene: dict) -> list[str]:
    failed = [_failure(r) for r in scene["rows"] if r["error"] is None]
    return (
        [f"Failed or not valid, {len(failed)} of {len(scene['rows'])}: " + "; ".join(failed) + ".", ""]
        if failed
        else [f"All {len(scene['rows'])} runs count.", ""]
    )


def _failure(row: dict) -> str:
    place = row["axis"] if row["axis"] == "anchor" else f"{row['axis']} x{row['factor']:g}"
    return f"{row['formulation']} {place} ({row['solver']}) {row['outcome']}"


def _runs(scene: dict) -> str:
    """Those that are judged, and those that are the references of others."""
    judged, every = len(scene["rows"]), scene["about"]["runs"]
    return f"{judged} runs" + (f" and {every - judged} of references" if every > judged else "")


def _scene(scene: dict) -> list[str]:
    anchor, band, about = scene["anchor"], band_of(scene), scene["about"]
    lines = [
        f"## {scene['name']}",
        "",
        (
            f"`{scene['base']}`, {scene['duration_s']:g} s and one step, anchor: dt {anchor['dt_s']:g} s,"
            f" d_hat {anchor['d_hat_m']:g} m, tolerance {anchor['tolerance']:g} of min(d_hat, fall of a"
            f" step)/dt. Error: `{scene['error']}`, {MEANING[scene['error']]}. {_runs(scene)},"
            f" {about['seconds']:.0f} s in all (calibration runs and audit included), {about['unknowns']}"
            f" unknowns,"
            f" {about['machine']}, {about['date']}, build {about['build'][:8]}."
        ),
        "",
    ]
    lines += [
        f"- Reference, dt x{ref['dt_factor']:g}: {ref['name']}"
        + "".join(f"; {e} {number(b)}" for e, b in ref["band"].items())
        + "."
        for ref in scene["references"]
    ]
    lines += ["", f"![{scene['error']} against work](../docs/work_precision_{scene['name']}.png)", ""]
    if band:
        lines += [f"Uncertainty of the reference (band): {number(band)}.", ""]
    if shares_time_step(scene) and (unranked := sum(r["axis"] == "dt_s" for r in scene["rows"])):
        lines += [
            (
                f"{unranked} runs of other time steps (dt_s) are not ranked: the references do not see their"
                " error in time."
            ),
            "",
        ]
    return lines + _standings(scene) + [""] + _targets(scene) + [""] + _failures(scene)


def _profiles(scenes: list[dict]) -> list[str]:
    budgets = (50, 100, 200, 500, 1000)
    lines = [
        "## Over all scenes",
        "",
        "![share of problems solved within a budget](../docs/work_precision_profile.png)",
        "",
        (
            "Problems (scene, variation) solved with at most so many factorisations, by target (first,"
            " second, third of each scene); failed runs never are."
        ),
        "",
    ]
    rows = []
    levels = range(max(len(scene["targets"]) for scene in scenes))
    for name in formulations(scenes[0]):
        found = [profile(scenes, "factorizations", name, level) for level in levels]
        cells = [
            ", ".join(str(sum(c <= b for c in costs)) for costs, _ in found) for b in (*budgets, math.inf)
        ]
        rows.append([name, f"{found[0][1]}", *cells])
    head = ["formulation", "problems", *(f"{b} factorisations" for b in budgets), "any number"]
    return lines + table_lines(head, rows)


def markdown(table: dict) -> str:
    lines = [HEAD, table["doc"], ""]
    for scene in table["scenes"]:
        lines += _scene(scene)
    return "\n".join(lines + _profiles(table["scenes"])) + "\n"


def text(table: dict) -> str:
    """For a terminal."""
    lines = []
    for scene in table["scenes"]:
        names, all_points = formulations(scene), points(scene, "newton")
        lines.append(
            f"{scene['name']}: {scene['error']}, {scene['references'][0]['name']}, band"
            f" {number(band_of(scene)) if band_of(scene) else '0'}"
        )
        for name in names:
            s = standing(all_points, names, name)
            lines.append(
                f"  {name:32} {s.solved:3} of {s.runs:3} count, useless below {number(s.smallest):>9},"
                f" {number(s.cost_there):>6} Newton iterations there" + f"; cheapest {intervals(s)}"
            )
    return "\n".join(lines)
