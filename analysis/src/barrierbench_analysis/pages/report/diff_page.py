"""The page of two folders: verdict, what regressed, outcomes, metrics, pairs, and what only one side has."""

from collections import Counter
from pathlib import Path

from barrierbench_analysis.tables.words import counted, listed, number

from .comparison import METRICS
from .diff import Change, Diff, Pair, changes
from .gather import Entry, Folder
from .page import filled, title
from .tables import (
    NONE,
    Cell,
    Column,
    Table,
    command_cell,
    formulation,
    numeric,
    outcome,
    record,
    record_cell,
    shown_path,
    table_of,
)
from .verdict import BAD, GOOD, PLAIN, Sentence

MOST_REDS = 1000  # rows of the table of what regressed
COUNTS = ("pairs", "same", "lower", "higher")
SAME_BITS = {None: "not asked", True: "same", False: "differs"}


def _head(entry: Entry) -> Cell:
    return formulation(entry.name, entry.row["formulation"])


def _number(heading: str, of, meaning: str = "") -> Column:
    return Column(heading, meaning, of, is_number=True)


def _run(pair: Pair) -> Cell:
    return _head(pair.new)


def _command(pair: Pair) -> Cell:
    return command_cell(pair.new)


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
    columns = [
        Column("run", of=lambda pair, _: _run(pair)),
        Column("kind", "invariant, physics or cost", lambda pair, f: Cell(pair.kind(f)), filtered=True),
        Column("metric", of=lambda _, f: Cell(f.metric), filtered=True),
        _number("before", lambda _, f: _value(f.reference)),
        _number("now", lambda _, f: _value(f.value)),
        Column("allowed", of=lambda _, f: Cell(_allowed(f.lower, f.upper))),
        Column("note", of=lambda _, f: Cell(f.note or "-")),
        Column("command", of=lambda pair, _: _command(pair)),
    ]
    rows = []
    for pair in diff.pairs:
        rows += [[column.of(pair, finding) for column in columns] for finding in pair.red]
        if pair.fault:
            lead = [_run(pair), Cell("not compared", tone="bad"), NONE, NONE, NONE, NONE]
            rows.append([*lead, Cell(pair.fault), _command(pair)])
    caption = "What regressed, by the rules of ./bench gate compare"
    table = Table("regressed", caption, columns, rows[:MOST_REDS], is_filtered=True)
    return table, max(0, len(rows) - MOST_REDS)


def _value(value) -> Cell:
    return Cell(value[:12]) if isinstance(value, str) else numeric(value, 5)


def _allowed(lower: float | None, upper: float | None) -> str:
    if lower is None and upper is None:
        return "exact"
    return f"at most {number(upper)}" if lower is None else f"{number(lower)} to {number(upper)}"


def metrics(diff: Diff) -> Table:
    def red(change: Change) -> Cell:
        return Cell(str(change.red), change.red, "bad" if change.red else "")

    mean = "geometric mean; of log10 numbers that of what they are the logarithm of"
    columns = [
        Column("metric", of=lambda c: Cell(c.metric)),
        Column("kind", "cost, or physics", lambda c: Cell(c.kind), filtered=True),
        Column("unit", of=lambda c: Cell(c.unit)),
        *(_number(name, lambda c, name=name: numeric(getattr(c, name), 9)) for name in COUNTS),
        _number("factor", lambda c: numeric(c.factor), mean),
        _number(
            "farthest",
            lambda c: numeric(c.farthest_factor) if c.farthest else NONE,
            "factor of the pair that moved most",
        ),
        Column("its run", of=lambda c: Cell(c.farthest.new.run) if c.farthest else NONE),
        _number("red", red, "pairs in which it regressed"),
    ]
    caption = "Every number of the pairs, second over first"
    return table_of("metrics", caption, columns, changes(diff), is_filtered=True)


def pairs(diff: Diff, page: Path) -> Table:
    shown = [metric for metric in METRICS if any(metric.of(p.old) and metric.of(p.new) for p in diff.pairs)]

    def red(pair: Pair) -> Cell:
        return Cell("?" if pair.fault else str(len(pair.red)), len(pair.red), "bad" if pair.red else "")

    def state(pair: Pair) -> Cell:
        return Cell(SAME_BITS[pair.same_bits], tone="bad" if pair.same_bits is False else "")

    def quotient(pair: Pair, metric) -> Cell:
        old, new = metric.of(pair.old), metric.of(pair.new)
        return numeric(new / old if old and new else None)

    numbers = [
        _number(
            f"{metric.heading} {which}", lambda pair, of=of, metric=metric: of(pair, metric), metric.meaning
        )
        for metric in shown
        for which, of in (
            ("before", lambda pair, metric: numeric(metric.of(pair.old), 5)),
            ("now", lambda pair, metric: numeric(metric.of(pair.new), 5)),
            ("x", quotient),
        )
    ]
    bits = "equal bits of the final state, where build and machine are the same"
    columns = [
        Column("run", of=_run),
        Column("group", of=lambda pair: Cell(pair.new.group), filtered=True),
        Column("outcome before", of=lambda pair: outcome(pair.old), filtered=True),
        Column("outcome now", of=lambda pair: outcome(pair.new), filtered=True),
        Column("state", bits, state, filtered=True),
        _number("red", red, "numbers that regressed"),
        *numbers,
        Column("record before", of=lambda pair: record_cell(pair.old, page)),
        Column("record now", of=lambda pair: record_cell(pair.new, page)),
        Column("command", of=_command),
    ]
    return table_of("pairs", "Every pair of runs", columns, diff.pairs, is_filtered=True)


def lonely(diff: Diff, page: Path) -> Table:
    rows, link = [], record(page)
    for folder, some in ((diff.a, diff.only_a), (diff.b, diff.only_b)):
        name = Cell(str(shown_path(folder.place)))
        rows += [[_head(e), name, outcome(e), link.of(e), command_cell(e)] for e in some]
        rows += [
            [Cell("a file"), name, Cell("unreadable", tone="bad"), Cell(fault), NONE]
            for fault in folder.unreadable
        ]
    columns = [Column("run"), Column("only in", filtered=True), Column("outcome"), link, Column("command")]
    return Table("lonely", "Runs without a counterpart, and files that cannot be read", columns, rows)


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
    commands = [f"./bench gate compare {a} {b} --common", f"./bench report {a} {b}"]
    parts = {"regressed": table, "left": left, "metrics": metrics(diff), "commands": commands}
    parts |= {"pairs": pairs(diff, out), "lonely": lonely(diff, out)}
    about = [_provenance(diff.a), _provenance(diff.b)]
    heading = f"{title(diff.b)} against {title(diff.a)}"
    return filled(
        "diff.html", title=heading, about=about, verdict=verdict(diff), limits=limits(diff), **parts
    )
