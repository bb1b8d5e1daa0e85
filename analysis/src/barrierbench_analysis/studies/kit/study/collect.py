"""Runs what a study lacks, and makes rows of the records."""

from __future__ import annotations

import re
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import groupby
from pathlib import Path

from barrierbench_analysis.io.origin import origin, run_of, seconds_of_run
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.studies.kit import alone, runs
from barrierbench_analysis.tables.numbers import rounded
from barrierbench_analysis.tables.outcomes import outcome_of

from . import store
from .spec import Cell, Study

RUNS = ROOT / "results" / "runs" / "studies"
DIGITS = 12  # of a kept number
KEY_DIGITS = 10  # in the label of a run, so that runs of other settings may lie beside it
AT_ONCE = 60  # runs of one sweep, whose rows are kept together


def sources_of(study: Study) -> dict[str, str]:
    """Value of a row -> where it comes from: metrics of the spec, and what the rule measures itself
    (MEASURED: name -> what it is, whose change makes rows anew)."""
    return {**study.data["metrics"], **getattr(study.module, "MEASURED", {})}


def missing(study: Study, rows: dict[str, store.Row]) -> list[Cell]:
    """Cells without a row, or whose row lacks a value of today from where it is taken now; without those that
    need no run, since others decide them (function `decided` of the rule: rows -> keys)."""
    now = sources_of(study).items()
    decided = getattr(study.module, "decided", lambda *_: set())(study, rows)
    return [
        cell
        for cell in study.cells
        if cell.key not in decided and (cell.key not in rows or not now <= rows[cell.key].sources.items())
    ]


def _at(record: dict, pointer: str) -> float | str | None:
    """The number or the text at a pointer; in a list -1 is its last entry. None where there is none."""
    found = record
    for name in pointer.strip("/").split("/"):
        if isinstance(found, list) and re.fullmatch(r"-1|\d+", name) and int(name) < len(found):
            found = found[int(name)] if found else None
        else:
            found = found.get(name) if isinstance(found, dict) else None
    return found if isinstance(found, (int, float, str)) and not isinstance(found, bool) else None


def _value(record: dict, source: str) -> float | str | None:
    if source.startswith("/"):
        return _at(record, source)
    return runs.metric(record, source) if record["summary"] else None


def row_of(study: Study, cell: Cell, record: dict) -> store.Row:
    """The row of one record, as runs.collect or alone.run has it; of a run that left no record it has the
    values of pointers alone. The function `measure` of a rule (study, cell, record) gives the values that
    MEASURED names.
    """
    values = {name: _value(record, source) for name, source in study.data["metrics"].items()}
    if hasattr(study.module, "measure"):
        values |= study.module.measure(study, cell, record)
    sources = sources_of(study)
    return store.Row(
        key=cell.key,
        place=cell.place,
        outcome=outcome_of(record),
        values={name: rounded(values[name], DIGITS) for name in sources},
        sources=sources,
        unknowns=record["scene"]["free_dofs"],
        seconds=round(seconds_of_run(record), 3),
        run=run_of(record),
        origin=origin([record]),
    )


def parts(cells: list[Cell]) -> Iterator[list[Cell]]:
    """Cells of one base in their order, at most AT_ONCE of them: what one sweep runs."""
    for _, of_base in groupby(cells, key=lambda cell: cell.base):
        mine = list(of_base)
        yield from (mine[at : at + AT_ONCE] for at in range(0, len(mine), AT_ONCE))


def label_of(cell: Cell) -> str:
    """The label of its run in a sweep, which has no slash."""
    return f"{cell.label} {cell.key[:KEY_DIGITS]}".replace("/", " per ")


def sweep_of(study: Study, cells: list[Cell]) -> runs.Sweep:
    """These cells of one base as one sweep."""
    cases = [{"label": label_of(cell), "set": cell.settings} for cell in cells]
    return runs.sweep(study.name, cells[0].base, study.data.get("set", {}), cases)


def run_each(study: Study, cells: list[Cell], folder: Path, jobs: int, limit_s: float) -> list[store.Row]:
    """Runs each cell as a sweep of its own with a limit of processor time (alone.py), so that it may hang,
    crash or be refused, and that is its outcome. Errors: UserError for what is no result of a run.
    """

    def one(cell: Cell) -> store.Row:
        record = alone.run(sweep_of(study, [cell]), folder / cell.key[:KEY_DIGITS], limit_s, study.plugins)
        return row_of(study, cell, record)

    with ThreadPoolExecutor(jobs) as pool:
        return list(pool.map(one, cells))


def run_cells(study: Study, cells: list[Cell], jobs: int = 1) -> list[store.Row]:
    """Runs these cells of one base as one sweep, so many at a time, or as the function `run` of the rule
    (study, cells, folder, jobs) does. Runs whose records are there already are not repeated. Errors:
    UserError. Cost: the runs.
    """
    out = study.out / "runs" if study.out else RUNS / study.name
    if hasattr(study.module, "run"):
        return study.module.run(study, cells, out, jobs)
    made = sweep_of(study, cells)
    runs.run(made, out, plugins=study.plugins, jobs=jobs)
    records = runs.collect(made, out)
    return [row_of(study, cell, records[note]) for cell, note in zip(cells, made.notes, strict=True)]
