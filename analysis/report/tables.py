"""The tables of a report as rows of cells; page.html draws them, page.js sorts and filters them."""

from __future__ import annotations

import os
import shlex
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import quote

from ..places import ROOT
from ..style import look
from .comparison import METRICS, RAW, SCALED, Beside, Factor, compared
from .gather import Absent, Entry, Folder
from .words import COMPARED, meaning, number

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
    tone: str = ""  # good, bad
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


def _head(entry: Entry) -> Cell:
    return Cell(entry.row["series"], colour=look(entry.row["formulation"]).color)


def outcome(entry: Entry) -> Cell:
    word = entry.row["outcome"]
    if word == "ok" and not entry.row["valid"]:
        return Cell("ok, not valid", tone="bad")
    if entry.reserved:
        return Cell(f"ok: {', '.join(entry.reserved)}")
    return Cell(word, tone="good" if word == "ok" else "bad")


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


def _why(entry: Entry) -> str:
    if entry.row["outcome"] == "ok":
        return f"failed checks of its validity: {', '.join(entry.failed_checks) or 'not named'}"
    return meaning(entry.row["outcome"])


def _how_far(entry: Entry) -> Cell:
    steps = entry.row.get("steps")
    return Cell("-") if steps is None else Cell(f"{steps} of {entry.settings.get('/time/steps', '?')}", steps)


UNREADABLE = Cell("unreadable", tone="bad")


def _failed(entry: Entry, page: Path) -> list[Cell]:
    """A run that did not end ok, or is not valid."""
    said = Cell(entry.row.get("detail") or "-")
    lead = [_head(entry), Cell(entry.group), outcome(entry), Cell(_why(entry)), said]
    return [*lead, _how_far(entry), record_cell(entry, page), command_cell(entry)]


def _absent(one: Absent) -> list[Cell]:
    """A case of a sweep that has no record."""
    why = Cell(f"{one.state}; ./bench status says more, and ./bench sweep goes on with it")
    lead = [Cell(one.label), Cell(one.group), Cell("no record", tone="bad"), why]
    return [*lead, Cell(one.detail or "-"), NONE, NONE, NONE]


def _unreadable(fault: str) -> list[Cell]:
    lead = [Cell("a file"), NONE, UNREADABLE, Cell("it is in no other number of this page")]
    return [*lead, Cell(fault), NONE, NONE, NONE]


def _without_trace(entry: Entry, page: Path) -> list[Cell]:
    """A run whose record can be read, and its trace cannot."""
    why = Cell("its trace: the numbers of its record count, and no figure over time has it")
    lead = [_head(entry), Cell(entry.group), UNREADABLE, why, Cell(entry.trace_fault)]
    return [*lead, _how_far(entry), record_cell(entry, page), command_cell(entry)]


def _earlier(path: Path) -> list[Cell]:
    """A record in the folder of a sweep that is none of its cases."""
    why = Cell("no case of its sweep as it is now; it is in no other number of this page")
    lead = [Cell(path.parent.name), Cell(path.parent.parent.name), Cell("left out", tone="bad"), why]
    return [*lead, NONE, NONE, NONE, NONE]


def failures(folder: Folder, page: Path) -> Table:
    """Runs that do not count, runs without a record, and files that cannot be read."""
    table = Table(
        "failures",
        "What did not end ok, is not valid, has no record or cannot be read",
        [
            Column("run"),
            Column("group", "its sweep, or its scene", filtered=True),
            Column("outcome", "the one word that a run ends with", filtered=True),
            Column("what it means"),
            Column("what the record says"),
            Column("steps", "made, of those that were asked for", is_number=True),
            RECORD,
            COMMAND,
        ],
    )
    table.rows.extend(_failed(entry, page) for entry in folder.entries if not entry.good)
    table.rows.extend(_absent(one) for one in folder.absent)
    table.rows.extend(_unreadable(fault) for fault in folder.unreadable)
    table.rows.extend(_without_trace(entry, page) for entry in folder.entries if entry.trace_fault)
    table.rows.extend(_earlier(path) for path in folder.earlier)
    return table


def reserved(folder: Folder, page: Path) -> Table:
    """Runs that count, though not all of their surfaces were kept out of everything."""
    table = Table(
        "reserved",
        "Ended ok, and its surfaces may be in obstacles or in each other",
        [
            Column("run"),
            Column("group", filtered=True),
            Column("outcome", "ok, and what its audit allows"),
            Column("what the record says"),
            Column(
                "deepest overlap m", "of a primitive and an obstacle at the end of a step", is_number=True
            ),
            RECORD,
            COMMAND,
        ],
    )
    for entry in folder.entries:
        if entry.reserved:
            lead = [_head(entry), Cell(entry.group), outcome(entry), Cell(entry.row.get("detail") or "-")]
            deepest = numeric(entry.row.get("audit_overlap_max_m"))
            table.rows.append([*lead, deepest, record_cell(entry, page), command_cell(entry)])
    return table


def not_compared(folder: Folder, page: Path) -> Table:
    """Runs that count, and whose numbers must not be held against their reference."""
    table = Table(
        "apart",
        "Ended ok, and may not be compared with the reference",
        [
            Column("run"),
            Column("group", filtered=True),
            Column("why", "the sentence of the record"),
            Column("pair", "of bodies whose gaps are farthest apart"),
            Column("factor", "gap over that of the reference", is_number=True),
            RECORD,
            COMMAND,
        ],
    )
    for entry in folder.entries:
        if entry.good and entry.row.get("comparability_verdict") == "not_comparable":
            row = entry.row
            table.rows.append(
                [
                    _head(entry),
                    Cell(entry.group),
                    Cell(row.get("comparability_reason") or "-"),
                    Cell(row.get("comparability_pair") or "-"),
                    numeric(row.get("comparability_pair_ratio")),
                    record_cell(entry, page),
                    command_cell(entry),
                ]
            )
    return table


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
        _head(entry),
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
