"""The page of a study and its figures: its template, filled with what its rule makes of the rows."""

import os
import tempfile
from dataclasses import replace
from pathlib import Path

from barrierbench_analysis.figures.figure_files import copy_to_page
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.template import filled
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.tables.words import counted

from . import registration, store
from .collect import current, decided, missing
from .spec import Study


def rows_of(study: Study, file: Path | None = None) -> list[store.Row]:
    """The kept rows of the cells that the spec asks for today, in its order. Errors: UserError where one is
    missing, so that no number is of a part of the cells; a rule whose page says what was not run (PARTIAL)
    is given what there is. file: of the rows, where another one is meant than that of the study.
    """
    rows = store.read_rows(file or store.file_of(study))
    there, lacking = current(study, rows), missing(study, rows)
    if lacking and not getattr(study.module, "PARTIAL", False):
        raise UserError(
            f"{file or store.file_of(study)}: {counted(len(lacking), 'cell')} of {len(study.cells)} without a"
            f" row, the first {lacking[0].label!r}; {study.call('run')} makes them"
        )
    found = [replace(there[cell.key], place=cell.place) for cell in study.cells if cell.key in there]
    return registration.checked(study, found)


def _some(study: Study) -> list[store.Row]:
    """As rows_of. Errors: UserError where there is none, and for a study that is not what was registered."""
    registration.require(study)
    if rows := rows_of(study):
        return rows
    raise UserError(f"{store.file_of(study)}: found no row; {study.call('run')} makes them")


def numbers_of(study: Study) -> dict:
    """What the rule makes of the kept rows. Errors: UserError."""
    return study.module.rule(study, _some(study))


def made_of(rows: list[store.Row]) -> str:
    """A sentence: when, on which machine and by which program the rows were made."""
    known = [row for row in rows if row.run]  # of those that left a record
    found = {name: sorted({row.origin[name] for row in known}) for name in ("date", "machine", "commit")}
    sizes = sorted({row.unknowns for row in known})
    unknowns = " to ".join(map(str, dict.fromkeys([*sizes[:1], *sizes[-1:]])))
    return (
        f"{counted(len(rows), 'run')} of {unknowns} unknowns were made on"
        f" {', '.join(found['date'])} on {', '.join(found['machine'])} (commit {', '.join(found['commit'])})."
    )


def checks_of(study: Study, rows: list[store.Row]) -> dict[str, int]:
    """Of the cells that others decide: how many have no run, how many were run all the same, and how many of
    these ended as it follows from the others."""
    of = {row.key: row for row in rows}
    found = decided(study, of)
    run = {key: of[key].outcome == outcome for key, outcome in found.items() if key in of}
    return {"left_out": len(found) - len(run), "run": len(run), "held": sum(run.values())}


def text_of(study: Study, rows: list[store.Row], numbers: dict) -> str:
    """The page. Errors: UserError for a template that asks for what the rule does not give."""
    about = {
        "name": study.name,
        "question": study.data["question"],
        "made": made_of(rows),
        "command": study.call("run"),
        "spec": study.file.name,
        "pictures": os.path.relpath(study.figures, study.page.parent),
        "checks": checks_of(study, rows),
        "registered": registration.sentences(study),
    }
    return filled(study.template, about | numbers)


def write_page(study: Study) -> Path:
    """Writes the page of the study from its kept rows, and the figures that its rule draws (function `draw`:
    study, rows, numbers, folder -> files). Errors: UserError.
    """
    rows = _some(study)
    if hasattr(study.module, "draw"):
        numbers = study.module.rule(study, rows)
        with tempfile.TemporaryDirectory() as scratch:
            copy_to_page(study.module.draw(study, rows, numbers, Path(scratch)), study.figures)
    write_whole(study.page, text_of(study, rows, study.module.rule(study, rows)))  # it sees the figures
    return study.page
