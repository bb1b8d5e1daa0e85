"""A scene with its runs, and the tables of the page: what each formulation reaches, what a target costs, and
within which errors it is the cheapest.
"""

import math
import os

from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.studies.kit.study.store import Row, timed_alike
from barrierbench_analysis.tables.accuracy.errors import MEANING
from barrierbench_analysis.tables.accuracy.reference import CLOSED_FORMS
from barrierbench_analysis.tables.numbers import whole

from . import judge
from .errors import dt_factor
from .scenes import REFERENCE, REFERENCE_D_HAT, Scene

BUDGETS = (50, 100, 200, 500, 1000, math.inf)  # factorisations


def _references(scene: Scene, rows: list[Row]) -> list[dict]:
    """One a time step, with its uncertainties; a closed form has none."""
    if "closed_form" in scene.reference:
        return [{"dt_factor": 1.0, "name": CLOSED_FORMS[scene.reference["closed_form"]]().name, "band": {}}]
    made = []
    for factor in scene.dt_factors:
        pair = [row for row in rows if float(dt_factor(row.place)) == factor]
        name = (
            f"middle of {' and '.join(scene.reference['refined'])} with d_hat x{REFERENCE_D_HAT:g},"
            f" tolerance/1000, dt {scene.duration_s / scene.steps(factor):g} s (run_id"
            f" {', '.join(row.run for row in pair)})"
        )
        band = {error: pair[0].values[error] for error in MEANING if pair[0].values[error] is not None}
        made.append({"dt_factor": factor, "name": name, "band": band})
    return made


def _about(rows: list[Row]) -> dict:
    keys = ("date", "machine", "commit", "build")
    origin = {key: ", ".join(sorted({row.origin[key] for row in rows})) for key in keys}
    seconds = round(sum(row.seconds for row in rows), 1)
    return {"unknowns": rows[0].unknowns, "seconds": seconds, "runs": len(rows), **origin}


def _run(scene: Scene, row: Row, is_timed: bool) -> dict:
    """is_timed: whether its seconds may be compared with those of the other runs of the scene."""
    found = {
        **{name: row.place[name] for name in ("formulation", "axis", "solver")},
        "factor": float(row.place["factor"]),
        "outcome": row.outcome,
        "error": row.values[scene.error],
        **{cost: row.values[cost] for cost in judge.COSTS},
        "run": row.run,
    }
    return found if is_timed else found | {"seconds": None}


def scene_of(scene: Scene, rows: list[Row]) -> dict:
    """What is judged and drawn of a scene: reference, band, targets, one row a run."""
    mine = [row for row in rows if row.place["scene"] == scene.name]
    refined = [row for row in mine if row.place["axis"] == REFERENCE]
    others = [row for row in mine if row.place["axis"] != REFERENCE]
    is_timed = timed_alike(others)
    return {
        "name": scene.name,
        "base": os.path.relpath(scene.base, ROOT),
        "error": scene.error,
        "targets": scene.targets,
        "anchor": scene.anchor,
        "duration_s": scene.duration_s,
        "references": _references(scene, refined),
        "about": _about(mine),
        "rows": [_run(scene, row, is_timed) for row in others],
    }


def number(x: float | None) -> str:
    return whole(x, none="never")


def intervals(s: judge.Standing) -> str:
    """Requested errors in which it is the cheapest, as words."""
    words = [
        f"from {number(low)} up" if math.isinf(high) else " to ".join(_apart(low, high))
        for low, high in s.cheapest_in
    ]
    return "; ".join(words) or "nowhere"


def _apart(low: float, high: float) -> tuple[str, str]:
    """With as many digits as tell them apart."""
    written = ((f"{low:.{digits}g}", f"{high:.{digits}g}") for digits in range(3, 18))
    return next(pair for pair in written if pair[0] != pair[1])


def _standings(scene: dict) -> list[str]:
    names, band, found = judge.formulations(scene), judge.band_of(scene), judge.points(scene, "newton")
    rows = []
    for name in names:
        s = judge.standing(found, names, name)
        smallest = number(s.smallest) + (" (band)" if band and s.smallest <= band else "")
        rows.append([name, f"{s.solved} of {s.runs}", smallest, number(s.cost_there), intervals(s)])
    head = ["formulation", "runs that count", "useless below", "Newton iterations there", "cheapest within"]
    return markdown(head, rows)


def _targets(scene: dict) -> list[str]:
    targets = scene["targets"]
    heads = [f"{text}: error <= " + ", ".join(f"{t:g}" for t in targets) for _, text in judge.COSTS.values()]
    rows = []
    for name in judge.formulations(scene):
        cells = [
            ", ".join(number(judge.cost_to(judge.points(scene, cost), name, t)) for t in targets)
            for cost in judge.COSTS
        ]
        rows.append([name, *cells])
    return markdown(["formulation", *heads], rows)


def _failure(row: dict) -> str:
    place = row["axis"] if row["axis"] == "anchor" else f"{row['axis']} x{row['factor']:g}"
    return f"{row['formulation']} {place} ({row['solver']}) {row['outcome']}"


def _of_page(scene: dict) -> dict:
    """What the page says of a scene beside what scene_of has."""
    band, runs = judge.band_of(scene), scene["rows"]
    bands = ["".join(f"; {e} {number(b)}" for e, b in ref["band"].items()) for ref in scene["references"]]
    return {
        "meaning": MEANING[scene["error"]],
        "band": number(band) if band else "",
        "bands": bands,
        "unranked": sum(row["axis"] == "dt_s" for row in runs) if judge.shares_time_step(scene) else 0,
        "standings": "\n".join(_standings(scene)),
        "costs": "\n".join(_targets(scene)),
        "failed": [_failure(row) for row in runs if row["error"] is None],
    }


def _profiles(scenes: list[dict]) -> list[str]:
    """How many problems each formulation solves within a budget, at each target."""
    rows = []
    for name in judge.formulations(scenes[0]):
        found = [judge.profile(scenes, "factorizations", name, level) for level in judge.levels(scenes)]
        cells = [", ".join(str(sum(c <= budget for c in costs)) for costs, _ in found) for budget in BUDGETS]
        rows.append([name, f"{found[0][1]}", *cells])
    words = [f"{budget} factorisations" for budget in BUDGETS[:-1]]
    return markdown(["formulation", "problems", *words, "any number"], rows)


def numbers(scenes: list[dict]) -> dict:
    """Of the page, of scenes as scene_of has them."""
    return {"scenes": [{**one, **_of_page(one)} for one in scenes], "profile": "\n".join(_profiles(scenes))}
