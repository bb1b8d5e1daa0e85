"""The tables of a report as rows of cells; page.html draws them, page.js sorts and filters them."""

from __future__ import annotations

import os
import shlex
from collections import Counter
from dataclasses import dataclass, field, replace
from pathlib import Path
from urllib.parse import quote

from barrierbench_analysis.figures.style import look
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.tables.words import COMPARED, number

from .comparison import METRICS, RAW, SCALED, Beside, Factor, compared
from .gather import Entry, Folder

MOST_POINTERS = 6  # swept settings that get a column


@dataclass(frozen=True)
class Column:
    heading: str
    meaning: str = ""
    is_number: bool = False
    filtered: bool = False  # has a choice of its values above the table


@dataclass(frozen=True)
class Cell:
    """sort: the number that it is sorted by; without one its text is."""

    text: str
    sort: float | None = None
    tone: str = ""  # good, bad, expected
    badge: bool = False  # is shown as a label in the colour of its tone
    href: str = ""
    colour: str = ""  # of a formulation
    command: str = ""  # is shown with a button that copies it
    copies: str = ""  # what the button is called


@dataclass(frozen=True)
class Table:
    """The first cell of a row is its head."""

    key: str
    caption: str
    columns: list[Column]
    rows: list[list[Cell]] = field(default_factory=list)
    is_filtered: bool = False
    is_cards: bool = False  # a row is a card where the window is narrow

    def choices(self, index: int) -> list[str]:
        return sorted({row[index].text for row in self.rows})


NONE = Cell("-")


def numeric(value: float | None, digits: int = 3) -> Cell:
    return Cell(number(value, digits), None if value is None else float(value))


def shown_path(path: Path) -> Path:
    """As ./bench takes it: from the root of the repository where it lies in it."""
    whole = path.resolve()
    return whole.relative_to(ROOT) if whole.is_relative_to(ROOT) else path


def command_of(entry: Entry) -> str:
    """The line that makes the record again, in a folder of its own, and compares the two; empty for one that
    is in an archive: no verb runs it from there.
    """
    return "" if entry.in_archive else f"./bench run {shlex.quote(str(shown_path(entry.path)))}"


def command_cell(entry: Entry) -> Cell:
    if not (command := command_of(entry)):
        return NONE
    return Cell("", command=command, copies=f"Copy the command of {entry.run}")


def link_to(path: Path, page: Path) -> str:
    """From the page to a file, as long as both stay where they are."""
    return quote(Path(os.path.relpath(path.resolve(), page.resolve().parent)).as_posix())


def record_cell(entry: Entry, page: Path) -> Cell:
    """A link to it; where it is in an archive, its place there."""
    if entry.in_archive:
        return Cell(Path(entry.run, entry.path.name).as_posix())
    return Cell(Path(entry.run).name, href=link_to(entry.path, page))


def head(entry: Entry) -> Cell:
    return Cell(entry.row["series"], colour=look(entry.row["formulation"]).color)


def outcome(entry: Entry) -> Cell:
    """A label: how it ended; of one that failed, whether that was expected."""
    word = entry.row["outcome"]
    if entry.reserved:
        return Cell(f"ok: {', '.join(entry.reserved)}", badge=True)
    if entry.good:
        return Cell(word, tone="good", badge=True)
    text = "ok, not valid" if word == "ok" else word
    if entry.failed_as_expected:
        return Cell(f"{text}, expected", tone="expected", badge=True)
    return Cell(text, tone="bad", badge=True)


def badges(folder: Folder) -> list[Cell]:
    """How many runs ended in which way; the frequent ones first."""
    ends = Counter(map(outcome, folder.entries))
    return [replace(cell, text=f"{n} {cell.text}") for cell, n in ends.most_common()]


RECORD = Column(
    "record",
    "folder of its run.json, with a link that works while the page lies beside the records; of an archive the"
    " path of run.json in it",
)
COMMAND = Column(
    "command",
    "makes the record again in a folder of its own and says whether it is the same; -: the record is in an"
    " archive, which has to be unpacked for that",
)


def _factor(factor: Factor | None) -> Cell:
    if factor is None:
        return Cell("-")
    spread = f" ({number(factor.low, 2)} to {number(factor.high, 2)})" if factor.n > 1 else ""
    return Cell(number(factor.mean, 2) + spread, factor.mean)


def _good(one: Beside) -> Cell:
    """How many count; it is no plain success where some of them count with a reservation."""
    kept = sum(bool(run.reserved) for run in one.runs)
    with_all = "" if kept else "good"
    text = f"{one.good} of {len(one.runs)}" + (f", {kept} with reservations" if kept else "")
    return Cell(text, one.good, with_all if one.good == len(one.runs) else "bad")


def _beside(one: Beside) -> list[Cell]:
    reference = one.reference or ("is the reference" if one.is_reference else "none in this folder")
    return [
        Cell(one.contender, colour=look(one.runs[0].row["formulation"]).color),
        Cell(one.group),
        Cell(reference),
        _good(one),
        Cell(str(one.count("comparable")), one.count("comparable")),
        *(_factor(one.factors.get(metric.key)) for metric in METRICS),
    ]


def comparison(folder: Folder) -> Table:
    return Table(
        "comparison",
        "Numbers over those of the reference: geometric mean over the comparable pairs, smallest and"
        " largest of"
        " them; above 1 is more",
        [
            Column("formulation"),
            Column("group", filtered=True),
            Column("reference"),
            Column(
                "ok",
                "ended ok and valid, of all runs; with reservations: surfaces may be in obstacles or in each"
                " other, see Failures",
                is_number=True,
            ),
            Column("comparable", "runs that the program calls comparable", is_number=True),
            *(Column(f"{metric.heading}, x", metric.meaning, is_number=True) for metric in METRICS),
        ],
        [_beside(one) for one in compared(folder)],
    )


def pointers(entries: list[Entry]) -> list[str]:
    """Swept settings with more than one value, the first few."""
    names = sorted({name for entry in entries for name in entry.row if name.startswith("/")})
    varied = [name for name in names if len({str(entry.row.get(name)) for entry in entries}) > 1]
    return varied[:MOST_POINTERS]


def _setting(value) -> Cell:
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return Cell(f"{value:g}", float(value))
    return Cell("-" if value is None else str(value))


def _run(entry: Entry, swept: list[str], page: Path) -> list[Cell]:
    row, faults = entry.row, entry.faults
    word = row.get("comparability_verdict") or ""
    return [
        head(entry),
        Cell(entry.group),
        Cell(row["formulation"]),
        outcome(entry),
        Cell(COMPARED.get(word, word or "-")),
        numeric(entry.cond(RAW)),
        numeric(entry.cond(RAW, "max")),
        numeric(entry.cond(SCALED)),
        numeric(row.get("newton_iterations"), 6),
        numeric(row.get("probe_pcg_median"), 4),
        numeric(row.get("gap_min_rel_min")),
        Cell("-" if faults is None else str(faults), faults, "bad" if faults else ""),
        numeric(entry.wall_s),
        numeric(row.get("scene_free_dofs"), 9),
        *(_setting(row.get(name)) for name in swept),
        record_cell(entry, page),
        command_cell(entry),
    ]


def runs(folder: Folder, page: Path) -> Table:
    swept = pointers(folder.entries)
    table = Table(
        "runs",
        "Every run, failures included",
        [
            Column("run"),
            Column("group", "its sweep, or its scene", filtered=True),
            Column("formulation", filtered=True),
            Column("outcome", "the one word that a run ends with", filtered=True),
            Column("compared", "with the reference that its record names", filtered=True),
            Column("cond raw", METRICS[0].meaning, is_number=True),
            Column("largest", "largest of the same", is_number=True),
            Column("cond bJ", METRICS[1].meaning, is_number=True),
            Column("Newton", "iterations over all steps", is_number=True),
            Column("PCG", METRICS[3].meaning, is_number=True),
            Column("gap / d_hat", "smallest gap at the end of a converged step", is_number=True),
            Column(
                "crossings", "and motions through each other, by the audit; -: not audited", is_number=True
            ),
            Column("time s", METRICS[4].meaning, is_number=True),
            Column("unknowns", is_number=True),
            *(Column(name, "swept setting") for name in swept),
            RECORD,
            COMMAND,
        ],
        is_filtered=True,
    )
    table.rows.extend(_run(entry, swept, page) for entry in folder.entries)
    return table
