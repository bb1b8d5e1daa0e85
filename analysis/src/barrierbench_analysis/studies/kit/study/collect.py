"""Runs what a study lacks, and makes rows of the records."""

from __future__ import annotations

import re
from pathlib import Path

from barrierbench_analysis.io.digests import of_text
from barrierbench_analysis.io.origin import ID_DIGITS, origin, seconds_of_run
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.studies.kit import runs
from barrierbench_analysis.tables.numbers import rounded
from barrierbench_analysis.tables.outcomes import outcome_of

from . import store
from .spec import Cell, Study

RUNS = ROOT / "results" / "runs" / "studies"
DIGITS = 12  # of a kept number
FOLDER_DIGITS = 12  # of the name of a folder of runs


def missing(study: Study, rows: dict[str, store.Row]) -> list[Cell]:
    """Cells without a row, or whose row lacks a metric of today from where the spec takes it now."""
    now = study.data["metrics"].items()
    return [cell for cell in study.cells if cell.key not in rows or not now <= rows[cell.key].sources.items()]


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
    """The row of one record, as runs.collect has it."""
    values = {
        name: _at(record, source) if source.startswith("/") else runs.metric(record, source)
        for name, source in study.data["metrics"].items()
    }
    return store.Row(
        key=cell.key,
        place=cell.place,
        outcome=outcome_of(record),
        values=rounded(values, DIGITS),
        sources=study.data["metrics"],
        unknowns=record["scene"]["free_dofs"],
        seconds=round(seconds_of_run(record), 3),
        run=record["ids"]["run_id"][:ID_DIGITS],
        origin=origin([record]),
    )


def run_cells(study: Study, cells: list[Cell], folder: Path | None = None) -> list[store.Row]:
    """Runs these cells as one sweep, in a folder of their own, and reads their records. Runs that are there
    already are not repeated. Errors: UserError. Cost: the runs.
    """
    out = (folder or RUNS) / study.name / of_text(" ".join(cell.key for cell in cells))[:FOLDER_DIGITS]
    cases = [{"label": cell.label, "set": cell.settings} for cell in cells]
    made = runs.sweep(study.name, study.base, study.data.get("set", {}), cases)
    runs.run(made, out)
    records = runs.collect(made, out)
    return [row_of(study, cell, records[note]) for cell, note in zip(cells, made.notes, strict=True)]
