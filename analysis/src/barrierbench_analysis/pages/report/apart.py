"""Tables of the runs that a report tells apart: those that do not count, that count with a reservation, or
that are not compared.
"""

from __future__ import annotations

from pathlib import Path

from barrierbench_analysis.tables.words import meaning

from .gather import Absent, Entry, Folder
from .tables import (
    COMMAND,
    NONE,
    RECORD,
    Cell,
    Column,
    Table,
    command_cell,
    head,
    numeric,
    outcome,
    record_cell,
)


def _why(entry: Entry) -> str:
    if entry.failed_as_expected:
        return f"expected: {entry.expected.because}"
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
    lead = [head(entry), Cell(entry.group), outcome(entry), Cell(_why(entry)), said]
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
    lead = [head(entry), Cell(entry.group), UNREADABLE, why, Cell(entry.trace_fault)]
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
            lead = [head(entry), Cell(entry.group), outcome(entry), Cell(entry.row.get("detail") or "-")]
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
                    head(entry),
                    Cell(entry.group),
                    Cell(row.get("comparability_reason") or "-"),
                    Cell(row.get("comparability_pair") or "-"),
                    numeric(row.get("comparability_pair_ratio")),
                    record_cell(entry, page),
                    command_cell(entry),
                ]
            )
    return table
