"""The rows of a study, results/studies/NAME.jsonl. A row belongs to the key of its cell and is never changed
by another one. Rows are added at the end; a row is made again alone where the spec takes a metric from
elsewhere than it did.

One JSON value a line: an object says what the rows below it share (names of the axes, where each value comes
from, and what made them), an array is a row.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.store import merged
from barrierbench_analysis.io.whole_file import write_whole

from .spec import Study

FOLDER = ROOT / "results" / "studies"
BESIDE = ".rows.jsonl"  # behind the name of a spec that is none of this tree: its rows lie beside it
SCHEMA = "barrierbench.study_rows/2"
FIRST = json.dumps({"schema": SCHEMA})
OF_ROW = ("key", "outcome", "unknowns", "seconds", "run")  # before the words of the place and the values


@dataclass(frozen=True)
class Row:
    """What a study keeps of a run. values: metric -> number, text or list; None where the record has none."""

    key: str
    place: dict[str, str]
    outcome: str
    values: dict
    sources: dict[str, str]  # metric -> where its number is from, as the spec or the rule had it
    unknowns: int
    seconds: float  # of the whole run, from start to end
    run: str  # the first digits of run_id
    origin: dict[str, str]  # date, machine, commit, build

    @property
    def shared(self) -> dict:
        return {"axes": list(self.place), "sources": self.sources, "origin": self.origin}


def file_of(study: Study) -> Path:
    """Rows of a spec of this tree are kept with its results; others lie beside the spec, or in `out`."""
    return FOLDER / f"{study.name}.jsonl" if study.is_ours else study.beside(BESIDE)


def _row(line: list, shared: dict) -> Row:
    """Errors: ValueError for another number of entries."""
    names = [*OF_ROW, *shared["axes"], *shared["sources"]]
    found = dict(zip(names, line, strict=True))
    place = {name: found[name] for name in shared["axes"]}
    values = dict(zip(shared["sources"], line[len(names) - len(shared["sources"]) :], strict=True))
    of_row = dict(zip(OF_ROW, line))
    return Row(place=place, values=values, sources=shared["sources"], origin=shared["origin"], **of_row)


def read_rows(path: Path) -> dict[str, Row]:
    """key -> row, in the order of the file; empty where there is no file. Errors: UserError with the line
    of what is no row, or of a key that is there twice.
    """
    if not path.is_file():
        return {}
    first, *lines = input_file.read_text(path).splitlines() or [""]
    if first != FIRST:
        raise UserError(f"{path}: line 1: found {first[:60]!r}; allowed: {FIRST}")
    found: dict[str, Row] = {}
    shared: dict = {}
    for number, line in enumerate(lines, 2):
        try:
            data = json.loads(line)
            if isinstance(data, dict):
                shared = {name: data[name] for name in ("axes", "sources", "origin")}
                continue
            row = _row(data, shared)
        except (ValueError, TypeError, KeyError) as fault:
            raise UserError(f"{path}: line {number}: {fault}; allowed: a row of ./bench study") from None
        if row.key in found:
            raise UserError(
                f"{path}: line {number}: the key {row.key} is there twice; allowed: each key once"
            )
        found[row.key] = row
    return found


def added(kept: dict[str, Row], new: list[Row], replace: bool = False) -> dict[str, Row]:
    """The kept rows as they are and in their places, and behind them the new ones. replace: a new row takes
    the place of the kept one with its key. Errors: UserError for a key that is kept with other numbers,
    without `replace`.
    """
    rows = merged([asdict(row) for row in kept.values()], [asdict(row) for row in new], ("key",), replace)
    return {row["key"]: Row(**row) for row in rows}


def write_rows(path: Path, rows: dict[str, Row]) -> None:
    """Errors: UserError where the disk is full, and then the file is as it was; ValueError for a number that
    is not finite.
    """
    lines, shared = [FIRST], None
    for row in rows.values():
        if row.shared != shared:
            shared = row.shared
            lines.append(json.dumps(shared))
        line = [*(getattr(row, name) for name in OF_ROW), *row.place.values(), *row.values.values()]
        lines.append(json.dumps(line, separators=(",", ":"), allow_nan=False))
    write_whole(path, "\n".join(lines) + "\n")
