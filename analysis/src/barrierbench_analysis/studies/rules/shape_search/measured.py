"""What is kept of a shape on the steps of a half: lists with an entry for each state, in the spec's order."""

import hashlib
from concurrent.futures import ThreadPoolExecutor
from datetime import datetime, timezone
from pathlib import Path

from barrierbench_analysis.studies.kit import alone
from barrierbench_analysis.studies.kit.study import collect, store
from barrierbench_analysis.studies.kit.study.spec import Cell, Study
from barrierbench_analysis.tables.numbers import rounded

from . import states
from .search import KNOWN, PARAMETERS
from .shape import CURVE, KNOTS, make_plugin, terms_of

CONVERGED = "converged"
GAP_DIGITS = 4
COUNTS = {  # value of a row -> that of a trial of the corpus
    "factors": "factorizations",
    "products": "linear_iterations",
}
GAPS = {
    "gap_min": "gap_min_rel",
    "gap_p05": "gap_rel_p05",
    "gap_median": "gap_rel_median",
    "gap_p95": "gap_rel_p95",
}
MEASURED = {
    "parameters": "of a shape of a search: logarithms of the increments of b'' from knot to knot (shape.py)",
    "name": "of a shape of the program",
    "iterations": f"Newton iterations of {states.TRIAL}; the limit where it does not converge",
    "ends": "how each step ended",
    "factors": "factorisations",
    "products": "iterations of the linear solver",
    "gap_min": "smallest gap at the end, in d_hat",
    "gap_p05": "gap in d_hat below which 5 % of the load rests at the end",
    "gap_median": "the same of half of it",
    "gap_p95": "the same of 95 %",
    "processor_s": "of all trials",
    "load_ratio": "of a shape of the program: its force at gap_p05 over that at gap_p95",
    "curvature": "of a shape of the program: b'' at the knots of shape.py",
    "rho": "of a shape of the program: d_hat b''/|b'| at the gaps CURVE of shape.py",
}


def named(cell: Cell) -> str:
    """The shape of a cell, by the name that the program knows it by."""
    return cell.settings.get("/shape", f"searched_{cell.key[:collect.KEY_DIGITS]}")


def measure(study: Study, cell: Cell, record: dict) -> dict:
    """Values of a row. A step that did not converge, and every step of a shape that the program did not
    take, counts as the limit of iterations."""
    kept = states.of_half(study.about["states"], cell.place["half"])
    limits = [one["config"]["step_solver"]["max_iterations"] for one in kept.values()]
    found = dict.fromkeys(MEASURED) | {
        "parameters": cell.settings.get(PARAMETERS),
        "name": cell.settings.get("/shape"),
        "iterations": limits,
        "ends": [record["status"]["outcome"]] * len(limits),
        "processor_s": 0.0,
    }
    for name in (*COUNTS, *GAPS):
        found[name] = [None] * len(limits)
    if "corpus" not in record:
        return found
    taken = {one["name"]: one for one in record["corpus"]["states"]}
    for place, name in enumerate(kept):
        _add(found, place, taken[name])
    return found | (_of_program(found) if found["name"] else {})


def _of_program(found: dict) -> dict:
    """What a row keeps of a shape of the program, so that pages and searches need none."""
    pairs = list(zip(found["gap_p05"], found["gap_p95"], strict=True))
    force = iter(terms_of(found["name"], [u for pair in pairs if None not in pair for u in pair])["force"])
    return {
        "load_ratio": [None if None in pair else next(force) / next(force) for pair in pairs],
        "curvature": terms_of(found["name"], KNOTS)["curvature"],
        "rho": rounded(terms_of(found["name"], CURVE)["rho"]),
    }


def _add(found: dict, place: int, state: dict) -> None:
    """What one state adds to the lists of a row. One that line_search cannot take is a failure."""
    [trial] = state.get("trials") or [{"refused": state.get("refused", "")}]
    found["ends"][place] = trial.get("status", "refused")
    if "refused" in trial:
        return
    found["processor_s"] += state["seconds"]
    if trial["status"] == CONVERGED:
        found["iterations"][place] = trial["iterations"]
    for name, of in COUNTS.items():
        found[name][place] = trial[of]
    for name, of in GAPS.items():
        found[name][place] = rounded(trial[of], GAP_DIGITS)


def _record(study: Study, cell: Cell, plugins: list[str], folder: Path) -> dict:
    """In place of the record of a run: that of the corpus, or how it failed."""
    begun, kept = datetime.now(timezone.utc), states.of_half(study.about["states"], cell.place["half"])
    place = folder / cell.key[: collect.KEY_DIGITS]
    corpus = states.taken(kept, named(cell), study.about["theta"], plugins, place)
    if isinstance(corpus, str):
        return alone.without_record(alone.CRASH, corpus, begun)
    made = alone.without_record("ok", "", begun, valid=True)
    made["machine"]["cpu_model"] = corpus["cpu"]
    made["provenance"]["git_commit"] = corpus["git_commit"]
    return {**made, "corpus": corpus}


def run(study: Study, cells: list[Cell], folder: Path, jobs: int) -> list[store.Row]:
    """Rows of shapes, so many at a time; those of searches in one plugin. Cost: a compilation of a second,
    and the steps of each shape."""
    searched = {named(cell): cell.settings[PARAMETERS] for cell in cells if cell.place["search"] != KNOWN}
    plugins: list[str] = []
    if searched:
        digest = hashlib.sha256(" ".join(searched).encode()).hexdigest()
        plugins = [str(make_plugin(searched, folder / f"plugin-{digest[:collect.KEY_DIGITS]}"))]

    def one(cell: Cell) -> store.Row:
        return collect.row_of(study, cell, _record(study, cell, plugins, folder))

    with ThreadPoolExecutor(jobs) as pool:
        return list(pool.map(one, cells))
