"""The rows of a study, results/studies/NAME.jsonl. A row belongs to the key of its cell and is never changed
by another one. Rows are added at the end; a row is made again alone where the spec takes a metric from
elsewhere than it did. Rows share (io/shared_rows.py) the names of their axes, where each value comes from,
and what made them.
"""

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.shared_rows import read_shared, write_shared
from barrierbench_analysis.io.store import merged

from .spec import Study

FOLDER = ROOT / "results" / "studies"
BESIDE = ".rows.jsonl"  # behind the name of a spec that is none of this tree: its rows lie beside it
SCHEMA = "barrierbench.study_rows/2"
OF_ROW = ("key", "outcome", "unknowns", "seconds", "run")  # before the words of the place and the values
SHARED = ("axes", "sources", "origin")


@dataclass(frozen=True)
class Row:
    """What a study keeps of a run. values: metric -> number, text or list; None where the record has none."""

    key: str
    place: dict[str, str]
    outcome: str
    values: dict
    sources: dict[str, str]  # metric -> where its number is from, as the spec or the rule had it
    unknowns: int  # 0 of a run that left no record
    seconds: float | None  # of the whole run, from start to end; None where an earlier store did not keep it
    run: str  # the first digits of run_id
    origin: dict[str, str]  # date, machine, commit, build

    @property
    def shared(self) -> dict:
        return {"axes": list(self.place), "sources": self.sources, "origin": self.origin}


def timed_alike(rows: Iterable[Row]) -> bool:
    """Whether all rows are of one machine and one build, so that their seconds may be compared."""
    return len({(row.origin["machine"], row.origin["build"]) for row in rows}) == 1


def file_of(study: Study) -> Path:
    """Rows of a spec of this tree are kept with its results; others lie beside the spec, or in `out`."""
    return FOLDER / f"{study.name}.jsonl" if study.is_ours else study.beside(BESIDE)


def _row(line: list, shared: dict) -> Row:
    """Errors: ValueError for another number of entries, KeyError without a line above it."""
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
    found: dict[str, Row] = {}
    if not path.is_file():
        return found
    for line, row in read_shared(path, SCHEMA, SHARED, _row, "a row of ./bench study"):
        if row.key in found:
            raise UserError(f"{line}: the key {row.key} is there twice; allowed: each key once")
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
    """Errors: as write_shared."""
    lines = (
        (row.shared, [*(getattr(row, name) for name in OF_ROW), *row.place.values(), *row.values.values()])
        for row in rows.values()
    )
    write_shared(path, SCHEMA, lines)
