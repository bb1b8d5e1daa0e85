"""The tables of a report as rows of cells; page.html draws them, page.js sorts and filters them."""

import os
import shlex
from collections import Counter
from collections.abc import Callable, Iterable
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
class Column:
    """of: the cell of what a row is about."""

    heading: str
    meaning: str = ""
    of: Callable[..., Cell] | None = None
    is_number: bool = False
    filtered: bool = False  # has a choice of its values above the table


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


def table_of(key: str, caption: str, columns: list[Column], things: Iterable, **how) -> Table:
    """A row for each of the things, by what its columns say of it."""
    return Table(key, caption, columns, [[column.of(thing) for column in columns] for thing in things], **how)


NONE = Cell("-")


def text(value) -> Cell:
    """`-` where there is none."""
    return Cell(str(value)) if value not in (None, "") else NONE


def formulation(name: str, formulation: str) -> Cell:
    """In the colour of the formulation."""
    return Cell(name, colour=look(formulation).color)


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
    command = command_of(entry)
    return Cell("", command=command, copies=f"Copy the command of {entry.run}") if command else NONE


def link_to(path: Path, page: Path) -> str:
    """From the page to a file, as long as both stay where they are."""
    return quote(Path(os.path.relpath(path.resolve(), page.resolve().parent)).as_posix())


def record_cell(entry: Entry, page: Path) -> Cell:
    """A link to it; where it is in an archive, its place there."""
    if entry.in_archive:
        return Cell(Path(entry.run, entry.path.name).as_posix())
    return Cell(Path(entry.run).name, href=link_to(entry.path, page))


def head(entry: Entry) -> Cell:
    return formulation(entry.row["series"], entry.row["formulation"])


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


def group(entry: Entry) -> Cell:
    return Cell(entry.group)


def record(page: Path) -> Column:
    meaning = (
        "folder of its run.json, with a link that works while the page lies beside the records; of an archive"
        " the path of run.json in it"
    )
    return Column("record", meaning, lambda entry: record_cell(entry, page))


RUN = Column("run", of=head)
GROUP = Column("group", "its sweep, or its scene", group, filtered=True)
OUTCOME = Column("outcome", "the one word that a run ends with", outcome, filtered=True)
COMMAND = Column(
    "command",
    "makes the record again in a folder of its own and says whether it is the same; -: the record is in an"
    " archive, which has to be unpacked for that",
    command_cell,
)


def _factor(factor: Factor | None) -> Cell:
    if factor is None:
        return Cell("-")
    spread = f" ({number(factor.low, 2)} to {number(factor.high, 2)})" if factor.n > 1 else ""
    return Cell(number(factor.mean, 2) + spread, factor.mean)


def _good(one: Beside) -> Cell:
    """How many count; it is no plain success where some of them count with a reservation."""
    kept = sum(bool(run.reserved) for run in one.runs)
    text = f"{one.good} of {len(one.runs)}" + (f", {kept} with reservations" if kept else "")
    tone = "bad" if one.good < len(one.runs) else "" if kept else "good"
    return Cell(text, one.good, tone)


def comparison(folder: Folder) -> Table:
    def reference(one: Beside) -> Cell:
        return Cell(one.reference or ("is the reference" if one.is_reference else "none in this folder"))

    def comparable(one: Beside) -> Cell:
        return Cell(str(one.count("comparable")), one.count("comparable"))

    ok = (
        "ended ok and valid, of all runs; with reservations: surfaces may be in obstacles or in each"
        " other, see Failures"
    )
    factors = [
        Column(f"{m.heading}, x", m.meaning, lambda one, m=m: _factor(one.factors.get(m.key)), is_number=True)
        for m in METRICS
    ]
    columns = [
        Column("formulation", of=lambda one: formulation(one.contender, one.runs[0].row["formulation"])),
        Column("group", of=group, filtered=True),
        Column("reference", of=reference),
        Column("ok", ok, _good, is_number=True),
        Column("comparable", "runs that the program calls comparable", comparable, is_number=True),
        *factors,
    ]
    caption = (
        "Numbers over those of the reference: geometric mean over the comparable pairs, smallest and"
        " largest of them; above 1 is more"
    )
    return table_of("comparison", caption, columns, compared(folder))


def pointers(entries: list[Entry]) -> list[str]:
    """Swept settings with more than one value, the first few."""
    names = sorted({name for entry in entries for name in entry.row if name.startswith("/")})
    varied = [name for name in names if len({str(entry.row.get(name)) for entry in entries}) > 1]
    return varied[:MOST_POINTERS]


def _setting(value) -> Cell:
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return Cell(f"{value:g}", float(value))
    return NONE if value is None else Cell(str(value))


def _compared(entry: Entry) -> Cell:
    word = entry.row.get("comparability_verdict") or ""
    return Cell(COMPARED.get(word, word or "-"))


def _crossings(entry: Entry) -> Cell:
    faults = entry.faults
    return Cell("-" if faults is None else str(faults), faults, "bad" if faults else "")


def _of_row(column: str, digits: int = 3) -> Callable[[Entry], Cell]:
    return lambda entry: numeric(entry.row.get(column), digits)


def runs(folder: Folder, page: Path) -> Table:
    def numbers(heading: str, meaning: str, of: Callable[[Entry], Cell]) -> Column:
        return Column(heading, meaning, of, is_number=True)

    columns = [
        RUN,
        GROUP,
        Column("formulation", of=lambda entry: Cell(entry.row["formulation"]), filtered=True),
        OUTCOME,
        Column("compared", "with the reference that its record names", _compared, filtered=True),
        numbers("cond raw", METRICS[0].meaning, lambda entry: numeric(entry.cond(RAW))),
        numbers("largest", "largest of the same", lambda entry: numeric(entry.cond(RAW, "max"))),
        numbers("cond bJ", METRICS[1].meaning, lambda entry: numeric(entry.cond(SCALED))),
        numbers("Newton", "iterations over all steps", _of_row("newton_iterations", 6)),
        numbers("PCG", METRICS[3].meaning, _of_row("probe_pcg_median", 4)),
        numbers("gap / d_hat", "smallest gap at the end of a converged step", _of_row("gap_min_rel_min")),
        numbers("crossings", "and motions through each other, by the audit; -: not audited", _crossings),
        numbers("time s", METRICS[4].meaning, lambda entry: numeric(entry.wall_s)),
        numbers("unknowns", "", _of_row("scene_free_dofs", 9)),
        *(
            Column(name, "swept setting", lambda entry, name=name: _setting(entry.row.get(name)))
            for name in pointers(folder.entries)
        ),
        record(page),
        COMMAND,
    ]
    return table_of("runs", "Every run, failures included", columns, folder.entries, is_filtered=True)
