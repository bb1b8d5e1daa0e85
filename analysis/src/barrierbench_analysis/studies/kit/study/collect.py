"""Runs what a study lacks, and makes rows of the records."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

from barrierbench_analysis.io.origin import origin, run_of, seconds_of_run
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.studies.kit import runs
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


def _at(record: dict, pointer: str) -> float | None:
    """The number at a pointer; in a list -1 is its last entry. None where there is none."""
    found = record
    for name in pointer.strip("/").split("/"):
        if isinstance(found, list) and re.fullmatch(r"-1|\d+", name) and int(name) < len(found):
            found = found[int(name)] if found else None
        else:
            found = found.get(name) if isinstance(found, dict) else None
    return found if isinstance(found, (int, float)) and not isinstance(found, bool) else None


def row_of(study: Study, cell: Cell, record: dict) -> store.Row:
    """The row of one record, as runs.collect has it. The function `measure` of a rule (study, cell, record)
    gives the values that MEASURED names."""
    values = {
        name: _at(record, source) if source.startswith("/") else runs.metric(record, source)
        for name, source in study.data["metrics"].items()
    }
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


def _sweep(study: Study, cells: list[Cell]) -> runs.Sweep:
    cases = [{"label": f"{cell.label} {cell.key[:KEY_DIGITS]}", "set": cell.settings} for cell in cells]
    budget = {"run_s": study.data["run_s"]} if "run_s" in study.data else None
    return runs.sweep(study.name, cells[0].base, study.data.get("set", {}), cases, budget=budget)


def _out(study: Study) -> Path:
    return study.out / "runs" if study.out else RUNS / study.name


def folders(study: Study, cells: list[Cell]) -> dict[str, Path]:
    """key -> folder of the run, of those of these cells of one base whose records are there. Errors: as
    records_in."""
    made = _sweep(study, cells)
    found = runs.records_in([_out(study)], made.notes)
    return {cell.key: found[note][1] for cell, note in zip(cells, made.notes, strict=True) if note in found}


def run_cells(study: Study, cells: list[Cell], jobs: int = 1) -> list[store.Row]:
    """Runs these cells of one base as one sweep, so many at a time. Runs whose records are there already are
    not repeated. Errors: UserError. Cost: the runs.
    """
    out, made = _out(study), _sweep(study, cells)
    runs.run(made, out, plugins=[*study.plugins], jobs=jobs)
    records = runs.collect(made, out)
    return [row_of(study, cell, records[note]) for cell, note in zip(cells, made.notes, strict=True)]
