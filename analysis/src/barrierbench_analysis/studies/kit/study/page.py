"""The page of a study: its template, filled with what its rule makes of the rows."""

from __future__ import annotations

import importlib
from dataclasses import replace
from pathlib import Path
from types import ModuleType

from jinja2 import Environment, StrictUndefined
from jinja2.exceptions import TemplateError

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.spec_file import refused
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.tables.words import counted

from . import store
from .collect import missing
from .spec import Study

RULES = "barrierbench_analysis.studies.rules"
WORDS = {str: "a text", dict: "an object", list: "a list"}


def module_of(study: Study) -> ModuleType:
    """studies/rules/NAME.py. Errors: UserError where there is none, or where the spec lacks a key of `about`
    that the rule reads (its ABOUT)."""
    try:
        found = importlib.import_module(f"{RULES}.{study.name}")
    except ModuleNotFoundError as fault:
        if fault.name != f"{RULES}.{study.name}":
            raise
        raise UserError(
            f"{study.file}#/name: found {study.name!r}; allowed: a study whose rule is"
            f" analysis/src/barrierbench_analysis/studies/rules/{study.name}.py"
        ) from None
    about = study.data.get("about", {})
    for key, kind in found.ABOUT.items():
        if not isinstance(about.get(key), kind):
            raise refused(study.file, f"about/{key}", about.get(key), f"{WORDS[kind]} of the rule")
    return found


def rows_of(study: Study) -> list[store.Row]:
    """The kept rows of the cells that the spec asks for today, in its order. Errors: UserError where one is
    missing, so that no number is of a part of the cells.
    """
    rows = store.read_rows(store.file_of(study))
    if lacking := missing(study, rows):
        raise UserError(
            f"{store.file_of(study)}: {counted(len(lacking), 'cell')} of {len(study.cells)} without a"
            f" row, the first {lacking[0].label!r}; ./bench study {study.name} run makes them"
        )
    return [replace(rows[cell.key], place=cell.place) for cell in study.cells]  # labels of today


def numbers_of(study: Study) -> dict:
    """What the rule makes of the kept rows. Errors: UserError."""
    return module_of(study).rule(study, rows_of(study))


def made_of(rows: list[store.Row]) -> str:
    """A sentence: when, on which machine and by which program the rows were made."""
    found = {name: sorted({row.origin[name] for row in rows}) for name in ("date", "machine", "commit")}
    sizes = sorted({row.unknowns for row in rows})
    unknowns = f"{sizes[0]} to {sizes[-1]}" if len(sizes) > 1 else f"{sizes[0]}"
    return (
        f"{counted(len(rows), 'run')} of {unknowns} unknowns were made on"
        f" {', '.join(found['date'])} on {', '.join(found['machine'])} (commit {', '.join(found['commit'])})."
    )


def text_of(study: Study, rows: list[store.Row], numbers: dict) -> str:
    """The page. Errors: UserError for a template that asks for what the rule does not give."""
    environment = Environment(undefined=StrictUndefined, keep_trailing_newline=True, autoescape=False)
    about = {
        "name": study.name,
        "question": study.data["question"],
        "made": made_of(rows),
        "command": f"./bench study {study.name if study.is_ours else study.file} run",
        "spec": study.file.name,
    }
    try:
        return environment.from_string(input_file.read_text(study.template)).render(about | numbers)
    except TemplateError as fault:
        raise UserError(f"{study.template}: {fault}; allowed: {', '.join(sorted(about | numbers))}") from None


def write_page(study: Study) -> Path:
    """Writes the page of the study from its kept rows. Errors: UserError."""
    rows = rows_of(study)
    numbers = module_of(study).rule(study, rows)
    write_whole(study.page, text_of(study, rows, numbers))
    return study.page
