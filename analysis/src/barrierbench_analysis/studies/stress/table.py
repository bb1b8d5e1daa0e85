"""What the page is made of: every run, count and relation, in results/stress.json. Tests that were not run
keep what they had.
"""

from __future__ import annotations

import dataclasses
import json
from dataclasses import dataclass, field
from pathlib import Path

from barrierbench_analysis.io.store import a_line_each, read_store
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.tables.numbers import rounded

from .entry import ROOT, order
from .geometry import Count
from .relations import Relation
from .run import Row

FILE = ROOT / "results" / "stress.json"
NAME = "barrierbench.stress_results/1"
AGAIN = "; remove it, then ./bench study stress"
KEPT = [f.name for f in dataclasses.fields(Row) if f.name not in ("test", "reason")]


@dataclass
class Result:
    """One test."""

    rows: list[Row] = field(default_factory=list)
    counts: list[Count] = field(default_factory=list)
    relations: list[Relation] = field(default_factory=list)
    about: dict = field(default_factory=dict)  # date, machine, commit, seconds

    @property
    def unexpected(self) -> list[Row]:
        return [row for row in self.rows if row.outcome != "waits" and not row.as_expected and not row.defect]

    @property
    def as_expected(self) -> bool:
        """Red when nothing was judged. What a known defect explains is neither as expected nor red."""
        judged = [row for row in self.rows if row.outcome != "waits"]
        return (
            (bool(judged) or any(c.judged for c in self.counts))
            and not self.unexpected
            and all(c.as_expected for c in self.counts)
            and all(r.holds for r in self.relations)
        )


def _row(row: Row) -> list:
    values = {name: rounded(getattr(row, name)) for name in KEPT}
    values["expected"], values["state_hash"] = list(row.expected), row.state_hash[:16]
    return [values[name] for name in KEPT]


def write(results: dict[str, Result], path: Path) -> None:
    """A line a run."""

    def one(x):
        return json.dumps(x, ensure_ascii=False)

    blocks = []
    for name in sorted(results, key=order):
        result = results[name]
        rows = a_line_each((one(_row(row)) for row in result.rows), 3)
        counts = a_line_each((one(dataclasses.asdict(count)) for count in result.counts), 3)
        relations = a_line_each((one(dataclasses.asdict(relation)) for relation in result.relations), 3)
        blocks.append(
            f'"{name}": {{"about": {one(result.about)},\n  "rows": {rows},\n  "counts": {counts},\n '
            f' "relations": {relations}}}'
        )
    tests = a_line_each(blocks, 2, ("{", "\n }"))
    write_whole(path, f'{{\n "schema": "{NAME}",\n "columns": {one(KEPT)},\n "tests": {tests}\n}}\n')


def read(path: Path) -> dict[str, Result]:
    """The kept results; empty when there are none."""
    return read_store(path, NAME, _results, AGAIN, {})


def _results(data: dict) -> dict[str, Result]:
    out = {}
    for name, t in data["tests"].items():
        rows = [
            Row(test=name, **{**values, "expected": tuple(values["expected"])})
            for values in (dict(zip(data["columns"], row)) for row in t["rows"])
        ]
        out[name] = Result(
            rows,
            [Count(**count) for count in t["counts"]],
            [Relation(**relation) for relation in t["relations"]],
            t["about"],
        )
    return out
