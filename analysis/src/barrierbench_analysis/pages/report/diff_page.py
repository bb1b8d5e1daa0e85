"""The page of two folders: verdict, what regressed, outcomes, metrics, pairs, and what only one side has."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from barrierbench_analysis.figures.style import look
from barrierbench_analysis.tables.words import counted, listed, number

from .comparison import METRICS, Metric
from .diff import Diff, Pair, changes
from .gather import Entry, Folder
from .page import filled, title
from .tables import RECORD, Cell, Column, Table, command_cell, numeric, outcome, record_cell, shown_path
from .verdict import BAD, GOOD, PLAIN, Sentence

MOST_REDS = 1000  # rows of the table of what regressed
NO_NUMBER = Cell("-")


def _head(entry: Entry) -> Cell:
    return Cell(entry.name, colour=look(entry.row["formulation"]).color)


def verdict(diff: Diff) -> list[Sentence]:
    pairs = diff.pairs
    red = [pair for pair in pairs if pair.red]
    faults = [pair for pair in pairs if pair.fault]
    said = counted(len(pairs), "pair")
    if red:
        first = Sentence(f"In {len(red)} of {said} something regressed.", BAD)
    elif faults:
        first = Sentence(
            f"Nothing regressed where it could be judged; {len(faults)} of {said} could not.", BAD
        )
    else:
        first = Sentence(f"Nothing regressed in {said} of one config each.", GOOD)
    return [first, *_outcomes(pairs), *_bits(pairs), *_moves(diff), *_lonely(diff)]


def _outcomes(pairs: list[Pair]) -> list[Sentence]:
    turned = Counter(
        f"{pair.old.row['outcome']} to {pair.new.row['outcome']}" for pair in pairs if pair.outcome_differs
    )
    if not turned:
        return [Sentence("Every run ends with the outcome that it had.", GOOD)]
    worse = any(pair.old.good and not pair.new.good for pair in pairs)
    words = listed([f"{word} ({n})" for word, n in turned.most_common()])
    return [Sentence(f"Outcomes differ: {words}.", BAD if worse else PLAIN)]


def _bits(pairs: list[Pair]) -> list[Sentence]:
    asked = [pair for pair in pairs if pair.same_bits is not None]
    if not asked:
        return [
            Sentence("Final states are of other builds or machines, so equal bits are not asked for.", PLAIN)
        ]
    same = sum(pair.same_bits for pair in asked)
    tone = GOOD if same == len(asked) else BAD
    return [
        Sentence(f"{same} of {counted(len(asked), 'final state')} of one build are equal bit for bit.", tone)
    ]


def _moves(diff: Diff) -> list[Sentence]:
    rows = [c for c in changes(diff) if c.factor is not None and (c.lower or c.higher) and c.unit != "s"]
    costs = sorted((c for c in rows if c.kind == "cost"), key=lambda c: -max(c.factor, 1 / c.factor))[:3]
    words = [f"{c.metric} {number(c.factor)} times ({c.lower} lower, {c.higher} higher)" for c in costs]
    return [Sentence(f"Costs that moved most, over the pairs: {listed(words)}.")] if words else []


def _lonely(diff: Diff) -> list[Sentence]:
    return [
        Sentence(
            f"{counted(len(some), 'run').capitalize()} {'is' if len(some) == 1 else 'are'} only in {name}."
        )
        for some, name in ((diff.only_a, diff.a.root.name), (diff.only_b, diff.b.root.name))
        if some
    ]


def limits(diff: Diff) -> list[str]:
    said = [
        "Tolerances are those of ./bench gate compare, made round one run of the first folder: they are no"
        " envelope of"
        " how much the numbers scatter (./bench gate calibrate measures one).",
        "Times are shown and judge nothing.",
    ]
    for column, what in (("build_id", "build"), ("machine_id", "machine")):
        old, new = ({e.row[column] for e in f.entries} for f in (diff.a, diff.b))
        if old != new:
            said.append(
                f"The {what} of the two folders is not the same, so rounding and counts may move with it."
            )
    lost = len(diff.a.unreadable) + len(diff.b.unreadable)
    if lost:
        said.append(
            f"{counted(lost, 'file')} could not be read and {'is' if lost == 1 else 'are'} in no pair."
        )
    return said


def regressed(diff: Diff) -> tuple[Table, int]:
    """What is red, and how many more rows there would be."""
    table = Table(
        "regressed",
        "What regressed, by the rules of ./bench gate compare",
        [
            Column("run"),
            Column("kind", "invariant, physics or cost", filtered=True),
            Column("metric", filtered=True),
            Column("before", is_number=True),
            Column("now", is_number=True),
            Column("allowed"),
            Column("note"),
            Column("command"),
        ],
        is_filtered=True,
    )
    for pair in diff.pairs:
        for f in pair.red:
            table.rows.append(
                [
                    _head(pair.new),
                    Cell(pair.kind(f)),
                    Cell(f.metric),
                    _value(f.reference),
                    _value(f.value),
                    Cell(_allowed(f.lower, f.upper)),
                    Cell(f.note or "-"),
                    command_cell(pair.new),
                ]
            )
        if pair.fault:
            lead = [_head(pair.new), Cell("not compared", tone="bad"), NO_NUMBER, NO_NUMBER, NO_NUMBER]
            table.rows.append([*lead, NO_NUMBER, Cell(pair.fault), command_cell(pair.new)])
    left = max(0, len(table.rows) - MOST_REDS)
    del table.rows[MOST_REDS:]
    return table, left


def _value(value) -> Cell:
    return Cell(value[:12]) if isinstance(value, str) else numeric(value, 5)


def _allowed(lower: float | None, upper: float | None) -> str:
    if lower is None and upper is None:
        return "exact"
    return f"at most {number(upper)}" if lower is None else f"{number(lower)} to {number(upper)}"


def metrics(diff: Diff) -> Table:
    table = Table(
        "metrics",
        "Every number of the pairs, second over first",
        [
            Column("metric"),
            Column("kind", "cost, or physics", filtered=True),
            Column("unit"),
            Column("pairs", is_number=True),
            Column("same", is_number=True),
            Column("lower", is_number=True),
            Column("higher", is_number=True),
            Column(
                "factor",
                "geometric mean; of log10 numbers that of what they are the logarithm of",
                is_number=True,
            ),
            Column("farthest", "factor of the pair that moved most", is_number=True),
            Column("its run"),
            Column("red", "pairs in which it regressed", is_number=True),
        ],
        is_filtered=True,
    )
    for c in changes(diff):
        counts = [numeric(n, 9) for n in (c.pairs, c.same, c.lower, c.higher)]
        far = [numeric(c.farthest_factor), Cell(c.farthest.new.run)] if c.farthest else [NO_NUMBER, NO_NUMBER]
        red = Cell(str(c.red), c.red, "bad" if c.red else "")
        table.rows.append([Cell(c.metric), Cell(c.kind), Cell(c.unit), *counts, numeric(c.factor), *far, red])
    return table


def _two(old: float | None, new: float | None) -> list[Cell]:
    quotient = new / old if old and new else None
    return [numeric(old, 5), numeric(new, 5), numeric(quotient)]


SAME_BITS = {None: "not asked", True: "same", False: "differs"}


def _pair(pair: Pair, shown: list[Metric], page: Path) -> list[Cell]:
    red = Cell("?" if pair.fault else str(len(pair.red)), len(pair.red), "bad" if pair.red else "")
    return [
        _head(pair.new),
        Cell(pair.new.group),
        outcome(pair.old),
        outcome(pair.new),
        Cell(SAME_BITS[pair.same_bits], tone="bad" if pair.same_bits is False else ""),
        red,
        *(cell for metric in shown for cell in _two(metric.of(pair.old), metric.of(pair.new))),
        record_cell(pair.old, page),
        record_cell(pair.new, page),
        command_cell(pair.new),
    ]


def pairs(diff: Diff, page: Path) -> Table:
    shown = [metric for metric in METRICS if any(metric.of(p.old) and metric.of(p.new) for p in diff.pairs)]
    table = Table(
        "pairs",
        "Every pair of runs",
        [
            Column("run"),
            Column("group", filtered=True),
            Column("outcome before", filtered=True),
            Column("outcome now", filtered=True),
            Column(
                "state", "equal bits of the final state, where build and machine are the same", filtered=True
            ),
            Column("red", "numbers that regressed", is_number=True),
            *(
                Column(f"{metric.heading} {which}", metric.meaning, is_number=True)
                for metric in shown
                for which in ("before", "now", "x")
            ),
            Column("record before"),
            Column("record now"),
            Column("command"),
        ],
        is_filtered=True,
    )
    table.rows.extend(_pair(pair, shown, page) for pair in diff.pairs)
    return table


def lonely(diff: Diff, page: Path) -> Table:
    table = Table(
        "lonely",
        "Runs without a counterpart, and files that cannot be read",
        [Column("run"), Column("only in", filtered=True), Column("outcome"), RECORD, Column("command")],
    )
    for folder, some in ((diff.a, diff.only_a), (diff.b, diff.only_b)):
        name = str(shown_path(folder.place))
        for entry in some:
            lead = [_head(entry), Cell(name), outcome(entry)]
            table.rows.append([*lead, record_cell(entry, page), command_cell(entry)])
        for fault in folder.unreadable:
            table.rows.append(
                [Cell("a file"), Cell(name), Cell("unreadable", tone="bad"), Cell(fault), NO_NUMBER]
            )
    return table


def _provenance(folder: Folder) -> str:
    row = [entry.row for entry in folder.entries]
    commits = listed(list(dict.fromkeys(str(r.get("provenance_git_commit") or "?")[:10] for r in row)))
    cpus = listed(list(dict.fromkeys(str(r.get("machine_cpu_model") or "?") for r in row)))
    days = sorted({str(r.get("started_utc") or "")[:10] for r in row} - {""})
    when = " to ".join(dict.fromkeys((days[0], days[-1]))) if days else "no day"
    return f"{title(folder)}: {counted(len(row), 'record')}, commit {commits}, {cpus}, {when}."


def page(diff: Diff, out: Path) -> str:
    table, left = regressed(diff)
    a, b = shown_path(diff.a.place), shown_path(diff.b.place)
    return filled(
        "diff.html",
        title=f"{title(diff.b)} against {title(diff.a)}",
        about=[_provenance(diff.a), _provenance(diff.b)],
        verdict=verdict(diff),
        limits=limits(diff),
        regressed=table,
        left=left,
        metrics=metrics(diff),
        pairs=pairs(diff, out),
        lonely=lonely(diff, out),
        commands=[f"./bench gate compare {a} {b} --common", f"./bench report {a} {b}"],
    )
