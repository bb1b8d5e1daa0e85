"""What is kept of the runs of the catalogue: results/catalogue.json. Scenes that were not run keep what
they had.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path

from barrierbench_analysis.io.origin import run_of, seconds_of_run, stamp
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.store import a_line_each, merged, read_store
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.tables.outcomes import OK, outcome_of

from .checks import judge
from .entry import Entry
from .runs import Done

FILE = ROOT / "results" / "catalogue.json"
NAME = "barrierbench.catalogue_results/1"
REMEDY = "; ./bench study catalogue makes it"


@dataclass
class Row:
    """A run, and its checks that are red: name and what it saw."""

    formulation: str
    outcome: str
    detail: str
    seconds: float
    newton: int
    red: list = field(default_factory=list)
    seen: list = field(default_factory=list)  # of checks that hold
    run: str = ""


def row_of(entry: Entry, done: Done) -> Row:
    """The outcome, and every expectation held against the record; that it ends `ok` is one of every scene
    that starts.
    """
    record = done.record
    outcome, found = outcome_of(record), judge(record, entry.data["expect"])
    ends = [] if outcome == OK or entry.is_rejected else [f"ends_ok: {outcome}"]
    return Row(
        done.formulation,
        outcome,
        record["status"]["detail"],
        round(seconds_of_run(record), 1),
        record["summary"]["newton_iterations"],
        [*ends, *(f"{name}: {finding.saw}" for name, finding in found if finding.red)],
        [f"{name}: {finding.saw}" for name, finding in found if not finding.red],
        run_of(record),
    )


def origin_of(record: dict) -> dict:
    size = {key: record["scene"][key] for key in ("vertices", "triangles")}
    return stamp(record, "date", "machine", "commit") | size


def read(file: Path = FILE) -> dict[str, dict]:
    """Scene -> {"about", "rows"}; empty where nothing is kept."""
    return read_store(file, NAME, lambda data: data["scenes"], REMEDY, {})


def write(scenes: dict[str, dict], file: Path = FILE) -> None:
    lines = [
        f'{json.dumps(name)}: {{"about": {json.dumps(kept["about"])},\n   "rows": '
        + a_line_each(map(json.dumps, kept["rows"]), 4)
        + "}"
        for name, kept in sorted(scenes.items())
    ]
    scenes = a_line_each(lines, 2, ("{", "\n }"))
    write_whole(file, f'{{\n "schema": "{NAME}",\n "scenes": {scenes}\n}}\n')


def kept_of(entry: Entry, runs: list[Done], before: dict | None) -> dict:
    """Rows of these runs, and of other formulations that were kept before."""
    new, kept = [asdict(row_of(entry, done)) for done in runs], (before or {}).get("rows", [])
    return {"about": origin_of(runs[0].record), "rows": merged(kept, new, ("formulation",), replace=True)}
