"""Runs what a study lacks, and makes rows of the records."""

import re
import shutil
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import chain, groupby
from pathlib import Path

from barrierbench_analysis.io.digests import of_text
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.origin import ONE_THREAD, run_of, seconds_of_run, stamp
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.record_file import read_record
from barrierbench_analysis.studies.kit import alone, runs
from barrierbench_analysis.studies.kit.metrics import FOLDER
from barrierbench_analysis.tables.numbers import rounded
from barrierbench_analysis.tables.outcomes import outcome_of

from . import registration, store
from .spec import Cell, Study, parts_of

RUNS = ROOT / "results" / "runs" / "studies"
DIGITS = 12  # of a kept number
KEY_DIGITS = 10  # in the label of a run, so that runs of other settings may lie beside it
RUN_FOLDER = re.compile(rf"_([0-9a-f]{{{KEY_DIGITS}}})-[0-9a-f]+$")  # of a label: that of its run
AT_ONCE = 60  # runs of one sweep, whose rows are kept together
ORIGIN = ("date", "machine", "commit", "build", "version")  # of a row; the last is that of its record


def sources_of(study: Study) -> dict[str, str]:
    """Value of a row -> where it comes from: metrics of the spec, and what the rule measures itself
    (MEASURED: name -> what it is, whose change makes rows anew)."""
    return {**study.data["metrics"], **getattr(study.module, "MEASURED", {})}


def current(study: Study, rows: dict[str, store.Row]) -> dict[str, store.Row]:
    """The rows of today's cells that have every value of today from where it is taken now, in the order of
    the cells; without those whose run ended at a lower limit of time (run_s) than that of today."""
    now, of_cells = sources_of(study).items(), [rows[cell.key] for cell in study.cells if cell.key in rows]
    return {
        row.key: row
        for row in of_cells
        if now <= row.sources.items() and not _cut_short(study, row.outcome, row.seconds)
    }


def _cut_short(study: Study, outcome: str, seconds: float | None) -> bool:
    """Whether a run ended at a limit of time (run_s) that is higher now."""
    return outcome == "timeout" and seconds is not None and study.data.get("run_s", 0) > 2 * seconds


def decided(study: Study, rows: dict[str, store.Row]) -> dict[str, str]:
    """key -> outcome, of the cells whose outcome follows from the rows of others, those that were run all the
    same among them (function `decided` of the rule)."""
    return getattr(study.module, "decided", lambda *_: {})(study, current(study, rows))


def left_out(study: Study, rows: dict[str, store.Row]) -> list[Cell]:
    """Cells without a row that need no run, since others decide them."""
    there, by_others = current(study, rows), decided(study, rows)
    return [cell for cell in study.cells if cell.key in by_others and cell.key not in there]


def missing(study: Study, rows: dict[str, store.Row], every: bool = False) -> list[Cell]:
    """Cells without a row, or whose row lacks a value of today; without those that others decide, unless
    `every` cell is wanted."""
    there = {*current(study, rows), *(() if every else decided(study, rows))}
    return [cell for cell in study.cells if cell.key not in there]


def wanted(study: Study, rows: dict[str, store.Row], every: bool = False, again: bool = False) -> list[Cell]:
    """The cells that a call without --only would run. every: also those that others decide; again: also
    those that have a row.
    """
    keys = {cell.key for cell in missing(study, rows, every)} | ({*rows} if again else set())
    return [cell for cell in study.cells if cell.key in keys]


def _at(record: dict, pointer: str) -> float | str | None:
    """The number or the text at a pointer; in a list -1 is its last entry. None where there is none."""
    found = record
    for name in parts_of(pointer):
        if isinstance(found, list) and re.fullmatch(r"-1|\d+", name) and int(name) < len(found):
            found = found[int(name)] if found else None
        else:
            found = found.get(name) if isinstance(found, dict) else None
    return found if isinstance(found, (int, float, str)) and not isinstance(found, bool) else None


def _value(record: dict, source: str) -> float | str | None:
    if source.startswith("/"):
        return _at(record, source)
    return runs.metric(record, source) if record["summary"] else None


def row_of(study: Study, cell: Cell, record: dict, *others: dict) -> store.Row:
    """The row of one record, as runs.collect or alone.run has it; of a run that left no record it has the
    values of pointers alone. others: the records of the cells that it is measured with. The function
    `measure` of a rule (study, cell, record, *others) gives the values that MEASURED names. Errors: UserError
    where the run has other unknowns than its cell.
    """
    found = record["scene"]["free_dofs"]
    if cell.unknowns not in (None, found):
        raise UserError(
            f"{study.file}: found {cell.unknowns} unknowns for {cell.label!r}; allowed: {found}, those of its"
            " run"
        )
    values = {name: _value(record, source) for name, source in study.data["metrics"].items()}
    if hasattr(study.module, "measure"):
        values |= study.module.measure(study, cell, record, *others)
    sources = sources_of(study)
    return store.Row(
        key=cell.key,
        place=cell.place,
        outcome=outcome_of(record),
        values={name: rounded(values[name], DIGITS) for name in sources},
        sources=sources,
        unknowns=found,
        seconds=round(seconds_of_run(record), 3),
        run=run_of(record),
        origin=stamp(record, *ORIGIN, threads=ONE_THREAD) | registration.mark(study),
    )


def parts(study: Study, cells: list[Cell]) -> Iterator[list[Cell]]:
    """Cells of one base in their order, at most AT_ONCE of them: what one sweep runs. A rule may name axes
    (ALIKE) of which the cells of a sweep have one label."""
    alike = getattr(study.module, "ALIKE", ())
    for _, group in groupby(cells, key=lambda cell: (cell.base, *(cell.place[name] for name in alike))):
        mine = list(group)
        yield from (mine[at : at + AT_ONCE] for at in range(0, len(mine), AT_ONCE))


def folder_of(study: Study) -> Path:
    """Of the sweeps of a study, each in a folder of its own."""
    return study.out / "runs" if study.out else RUNS / study.name


def _folder(study: Study, cells: list[Cell]) -> Path:
    """Of the records of these cells as one sweep."""
    return folder_of(study) / of_text(" ".join(cell.key for cell in cells))[:KEY_DIGITS]


def sweep_of(study: Study, cells: list[Cell]) -> runs.Sweep:
    """These cells of one base as one sweep. The label of a run has no slash."""
    cases = [
        {"label": f"{cell.label} {cell.key[:KEY_DIGITS]}".replace("/", " per "), "set": cell.settings}
        for cell in cells
    ]
    budget = {"run_s": study.data["run_s"]} if "run_s" in study.data else None
    return runs.sweep(study.name, cells[0].base, study.data.get("set", {}), cases, budget=budget)


def folders(study: Study, cells: list[Cell]) -> dict[str, Path]:
    """key -> folder of the run, of those of these cells whose records are there, in whatever sweep; the
    newest where there are several."""
    paths = sorted(folder_of(study).glob("*/*/run.json"), key=lambda path: path.stat().st_mtime_ns)
    of_key = {found[1]: path.parent for path in paths if (found := RUN_FOLDER.search(path.parent.name))}
    return {cell.key: of_key[one] for cell in cells if (one := cell.key[:KEY_DIGITS]) in of_key}


def run_each(study: Study, cells: list[Cell], folder: Path, jobs: int, limit_s: float) -> list[store.Row]:
    """Runs each cell as a sweep of its own with a limit of processor time (alone.py), so that it may hang,
    crash or be refused, and that is its outcome. Errors: UserError for what is no result of a run.
    """

    def one(cell: Cell) -> store.Row:
        record = alone.run(sweep_of(study, [cell]), folder / cell.key[:KEY_DIGITS], limit_s, study.plugins)
        return row_of(study, cell, record)

    with ThreadPoolExecutor(jobs) as pool:
        return list(pool.map(one, cells))


def run_cells(study: Study, cells: list[Cell], jobs: int = 1, again: bool = False) -> list[store.Row]:
    """Runs these cells of one base as one sweep, so many at a time, with those of the same base whose runs
    they are measured with (function `needs` of the rule: study, cell -> cells), or as the function `run` of
    the rule (study, cells, folder, jobs) does. Runs whose records are there already are not repeated, unless
    `again`, or where a lower limit of time cut them short. Errors: UserError. Cost: the runs.
    """
    if hasattr(study.module, "run"):
        out = folder_of(study)
        for cell in cells if again else []:
            shutil.rmtree(out / cell.key[:KEY_DIGITS], ignore_errors=True)
        return study.module.run(study, cells, out, jobs)
    needs = getattr(study.module, "needs", lambda *_: [])
    others = {cell.key: needs(study, cell) for cell in cells}
    every = {cell.key: cell for cell in chain(*others.values(), cells)}
    there = {} if again else folders(study, list(every.values()))
    kept = {key: {**read_record(path / "run.json"), FOLDER: str(path)} for key, path in there.items()}
    records = {
        key: one for key, one in kept.items() if not _cut_short(study, outcome_of(one), seconds_of_run(one))
    }
    if left := [cell for key, cell in every.items() if key not in records]:
        made, out = sweep_of(study, left), _folder(study, left)
        runs.run(made, out, plugins=study.plugins, jobs=jobs, again=again or len(records) < len(kept))
        found = runs.collect(made, out)
        records |= {cell.key: found[note] for cell, note in zip(left, made.notes, strict=True)}
    return [
        row_of(study, cell, records[cell.key], *(records[other.key] for other in others[cell.key]))
        for cell in cells
    ]
