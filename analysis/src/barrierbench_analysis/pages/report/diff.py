"""Two folders of records beside each other: runs of one config are paired, and each pair is judged by the
rules of ./bench gate compare (studies/gate/compare.py), the first folder being the reference.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.gate import invariants
from barrierbench_analysis.studies.gate.compare import compare
from barrierbench_analysis.studies.gate.finding import RED, Finding, moved
from barrierbench_analysis.studies.gate.measure import measure
from barrierbench_analysis.studies.gate.metrics import TWO_SIDED, Metric
from barrierbench_analysis.studies.gate.records import read_run
from barrierbench_analysis.tables.statistics import geometric

from .gather import Entry, Folder

COST, PHYSICS, INVARIANT = "cost", "physics", "invariant"


@dataclass
class Pair:
    """A run of each folder, of one config. findings: what ./bench gate compare says of the second one."""

    old: Entry
    new: Entry
    findings: list[Finding] = field(default_factory=list)
    values: dict[str, tuple[float, float]] = field(default_factory=dict)  # metric -> old, new
    metrics: dict[str, Metric] = field(default_factory=dict)
    as_before: set[str] = field(default_factory=set)  # invariants that the first one breaks too
    fault: str = ""  # why the two could not be compared

    @property
    def red(self) -> list[Finding]:
        return [f for f in self.findings if f.verdict in RED and f.metric not in self.as_before]

    @property
    def better(self) -> list[Finding]:
        return [f for f in self.findings if f.verdict == "better"]

    @property
    def outcome_differs(self) -> bool:
        return (self.old.row["outcome"], self.old.good) != (self.new.row["outcome"], self.new.good)

    @property
    def same_bits(self) -> bool | None:
        """Of the final states; None where that may not be asked: another build or machine."""
        found = next((f for f in self.findings if f.metric == "state_hash"), None)
        return None if found is None or not found.judged else found.verdict == "pass"

    def kind(self, finding: Finding) -> str:
        if finding.gate_class in ("I", "II"):
            return INVARIANT
        metric = self.metrics.get(finding.metric)
        return PHYSICS if metric and metric.direction == TWO_SIDED and metric.gate_class == "III" else COST


@dataclass(frozen=True)
class Change:
    """A metric over all pairs that have it. factor: second over first, geometric mean over pairs where both
    are above 0; None without such a pair.
    """

    metric: str
    kind: str
    unit: str
    pairs: int
    same: int
    lower: int
    higher: int
    factor: float | None
    farthest: Pair | None
    farthest_factor: float | None
    red: int


@dataclass
class Diff:
    a: Folder
    b: Folder
    pairs: list[Pair]
    only_a: list[Entry]
    only_b: list[Entry]


def paired(a: Folder, b: Folder) -> tuple[list[Pair], list[Entry], list[Entry]]:
    """Runs with one config_id, repetitions in their order; and those without a counterpart."""
    waiting: dict[str, list[Entry]] = {}
    for entry in b.entries:
        waiting.setdefault(entry.row["config_id"], []).append(entry)
    pairs, only_a = [], []
    for entry in a.entries:
        partners = waiting.get(entry.row["config_id"])
        if partners:
            pairs.append(Pair(entry, partners.pop(0)))
        else:
            only_a.append(entry)
    return pairs, only_a, [entry for left in waiting.values() for entry in left]


def _judge(pair: Pair) -> None:
    try:
        old, new = read_run(pair.old.path), read_run(pair.new.path)
        pair.findings = compare(pair.new.run, old, new)
    except UserError as error:
        pair.fault = str(error)
        return
    pair.as_before = {f.metric for f in invariants.judge(pair.old.run, old, foreign=True) if f.verdict in RED}
    before, now = measure(old), measure(new)
    pair.metrics = {metric.name: metric for metric in (*before, *now)}
    pair.values = {metric.name: (before[metric], now[metric]) for metric in before if metric in now}


def diff_of(a: Folder, b: Folder) -> Diff:
    """Errors: UserError where no config is in both. Cost: 10 to 50 ms a pair."""
    pairs, only_a, only_b = paired(a, b)
    if not pairs:
        raise UserError(
            f"{a.place} and {b.place} have no config in common ({len(only_a)} and {len(only_b)} records);"
            f" allowed:"
            " folders with runs of the same config_id (./bench gate compare --different-configs compares two"
            " others)"
        )
    for pair in pairs:
        _judge(pair)
    return Diff(a, b, pairs, only_a, only_b)


def _factor(metric: Metric, old: float, new: float) -> float | None:
    if metric.unit == "log10":
        return 10 ** (new - old)
    return new / old if old > 0 and new > 0 else None


def _change(name: str, having: list[Pair]) -> Change:
    metric = having[0].metrics[name]
    words = [moved(pair.values[name][1], pair.values[name][0], metric.unit).split(",")[0] for pair in having]
    factors = [(f, pair) for pair in having if (f := _factor(metric, *pair.values[name])) is not None]
    mean = geometric(f for f, _ in factors) if factors else None
    far = max(factors, key=lambda item: abs(math.log(item[0])), default=(None, None))
    red = sum(f.metric == name for pair in having for f in pair.red)
    kind = PHYSICS if metric.direction == TWO_SIDED and metric.gate_class == "III" else COST
    counts = [words.count(word) for word in ("same", "lower", "higher")]
    farthest = far[1] if far[0] not in (None, 1.0) else None
    return Change(name, kind, metric.unit, len(having), *counts, mean, farthest, far[0], red)


def changes(diff: Diff) -> Iterator[Change]:
    """Every metric that some pair has on both sides, in the order of the gate."""
    names = dict.fromkeys(name for pair in diff.pairs for name in pair.values)
    for name in names:
        yield _change(name, [pair for pair in diff.pairs if name in pair.values])
