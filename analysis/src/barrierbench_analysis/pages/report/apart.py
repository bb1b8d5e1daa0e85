"""Tables of the runs that a report keeps apart: those that do not count, that count with a reservation, or
that are not compared.
"""

from pathlib import Path

from barrierbench_analysis.tables.words import meaning

from . import tables
from .gather import Entry, Folder
from .tables import COMMAND, GROUP, NONE, OUTCOME, RUN, Cell, Column, Table, numeric, record, table_of, text

UNREADABLE = Cell("unreadable", tone="bad")


def _why(entry: Entry) -> str:
    if entry.failed_as_expected:
        return f"expected: {entry.expected.because}"
    if entry.row["outcome"] == "ok":
        return f"failed checks of its validity: {', '.join(entry.failed_checks) or 'not named'}"
    return meaning(entry.row["outcome"])


def _how_far(entry: Entry) -> Cell:
    steps = entry.row.get("steps")
    return NONE if steps is None else Cell(f"{steps} of {entry.settings.get('/time/steps', '?')}", steps)


def _detail(entry: Entry) -> Cell:
    """What the record says of its outcome."""
    return text(entry.row.get("detail"))


def failures(folder: Folder, page: Path) -> Table:
    """Runs that do not count, runs without a record, records of no case of their sweep, and files that cannot
    be read.
    """
    columns = [
        RUN,
        GROUP,
        OUTCOME,
        Column("what it means", of=lambda entry: Cell(_why(entry))),
        Column("what the record says", of=_detail),
        Column("steps", "made, of those that were asked for", _how_far, is_number=True),
        record(page),
        COMMAND,
    ]
    bad = [entry for entry in folder.entries if not entry.good]
    table = table_of(
        "failures", "What did not end ok, is not valid, has no record or cannot be read", columns, bad
    )

    def add(name: Cell, where: Cell, how: Cell, why: str, detail: Cell, entry: Entry | None = None) -> None:
        rest = [column.of(entry) if entry else NONE for column in columns[5:]]
        table.rows.append([name, where, how, Cell(why), detail, *rest])

    for one in folder.absent:
        why = f"{one.state}; ./bench status says more, and ./bench sweep goes on with it"
        add(Cell(one.label), Cell(one.group), Cell("no record", tone="bad"), why, text(one.detail))
    for fault in folder.unreadable:
        add(Cell("a file"), NONE, UNREADABLE, "it is in no other number of this page", Cell(fault))
    for entry in folder.entries:
        if entry.trace_fault:
            why = "its trace: the numbers of its record count, and no figure over time has it"
            add(tables.head(entry), Cell(entry.group), UNREADABLE, why, Cell(entry.trace_fault), entry)
    for path in folder.earlier:
        why = "no case of its sweep as it is now; it is in no other number of this page"
        add(Cell(path.parent.name), Cell(path.parent.parent.name), Cell("left out", tone="bad"), why, NONE)
    return table


def reserved(folder: Folder, page: Path) -> Table:
    """Runs that count, though not all of their surfaces were kept out of everything."""
    columns = [
        RUN,
        Column("group", of=GROUP.of, filtered=True),
        Column("outcome", "ok, and what its audit allows", tables.outcome),
        Column("what the record says", of=_detail),
        Column(
            "deepest overlap m",
            "of a primitive and an obstacle at the end of a step",
            lambda entry: numeric(entry.row.get("audit_overlap_max_m")),
            is_number=True,
        ),
        record(page),
        COMMAND,
    ]
    found = [entry for entry in folder.entries if entry.reserved]
    return table_of(
        "reserved", "Ended ok, and its surfaces may be in obstacles or in each other", columns, found
    )


def not_compared(folder: Folder, page: Path) -> Table:
    """Runs that count, and whose numbers must not be held against their reference."""

    def of(column: str):
        return lambda entry: text(entry.row.get(f"comparability_{column}"))

    columns = [
        RUN,
        Column("group", of=GROUP.of, filtered=True),
        Column("why", "the sentence of the record", of("reason")),
        Column("pair", "of bodies whose gaps are farthest apart", of("pair")),
        Column(
            "factor",
            "gap over that of the reference",
            lambda entry: numeric(entry.row.get("comparability_pair_ratio")),
            is_number=True,
        ),
        record(page),
        COMMAND,
    ]
    apart = "not_comparable"
    found = [e for e in folder.entries if e.good and e.row.get("comparability_verdict") == apart]
    return table_of("apart", "Ended ok, and may not be compared with the reference", columns, found)
