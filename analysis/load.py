"""Records below a folder as tidy tables. Unknown fields are ignored, the schema's major version is checked."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd

from . import fields

VERSION = fields.schema("run")["$defs"]["SchemaId"]["properties"]
SCHEMA_NAME, SCHEMA_MAJOR = VERSION["name"]["enum"][0], VERSION["version"]["pattern"].strip("^").split("\\.")[0]
LARGEST_COND = 1e14  # beyond it rounding decides the smallest eigenvalue: what the record calls a lower bound


class RecordError(ValueError):
    """A file that is not a record this version can read."""


@dataclass
class Records:
    """`run` (the folder below the root) joins the tables; the other columns are those of fields.columns()."""

    runs: pd.DataFrame  # one row a run
    steps: pd.DataFrame  # one row a time step
    trace: pd.DataFrame  # one row a Newton iteration, `n` counts them over the run
    cond: pd.DataFrame  # one row a condition estimate
    unreadable: list[str] = field(default_factory=list)  # records left out: "path: reason"


def _check_schema(record: dict, path: Path) -> None:
    schema = record.get("schema", {})
    major = str(schema.get("version", "")).split(".")[0]
    if schema.get("name") != SCHEMA_NAME or major != SCHEMA_MAJOR:
        raise RecordError(f"{path}: schema {schema}; this version reads {SCHEMA_NAME} {SCHEMA_MAJOR}.x.y")


def _series(labels: dict) -> str:
    """What a line of a figure is called: the case of its sweep, or the formulation."""
    note = labels.get("note") or ""
    case = note.split(": ", 1)[1] if ": " in note else note
    return case or labels["formulation"]


def run_row(record: dict, run: str = "") -> dict:
    """A row of `runs`: the fields of the record, and where it belongs."""
    row = fields.row("runs", record)
    row |= {"run": run, "folder": Path(run).name, "series": _series(record["labels"])}
    row["group"] = row["sweep_id"] or row["scene"]
    return row


def trace_lines(path: Path) -> list[dict]:
    """The rows of a trace; none without the file. A line torn by a crash can only be the last one: it is left out and said."""
    if not path.exists():
        return []
    lines = path.read_text().splitlines()
    rows = []
    for number, line in enumerate(lines, 1):
        try:
            rows.append(json.loads(line))
        except json.JSONDecodeError:
            if number != len(lines):
                raise RecordError(f"{path}:{number}: not JSON") from None
            print(f"{path}:{number}: torn last line left out", file=sys.stderr)
    return rows


def read_record(path: Path) -> dict:
    """One run.json. Raises RecordError: torn or otherwise not JSON, no record, a version this one does not read."""
    try:
        record = json.loads(path.read_text())
    except (OSError, ValueError) as error:  # ValueError: not JSON, not UTF-8
        raise RecordError(f"{path}: not JSON: {error}") from None
    if not isinstance(record, dict):
        raise RecordError(f"{path}: not JSON of a record")
    _check_schema(record, path)
    return record


def load(root: str | Path) -> Records:
    """Every record below `root`, in the order of their paths.

    A run.json that cannot be read, torn by a crash or of another version, is left out: `unreadable` and a line on stderr name it.
    Raises RecordError when no record can be read.
    """
    root = Path(root)
    runs, steps, trace, cond, unreadable = [], [], [], [], []
    for path in sorted(root.rglob("run.json")):
        try:
            record = read_record(path)
            lines = trace_lines(path.parent / "trace.jsonl")
        except RecordError as error:
            unreadable.append(str(error))
            continue
        run = str(path.parent.relative_to(root))
        runs.append(run_row(record, run))
        for step in record["steps"]:
            steps.append({"run": run, **fields.row("steps", step)})
        for n, line in enumerate(lines):
            place = {"run": run, "n": n, "step": line["step"], "iteration": line["iteration"]}
            trace.append({**place, **fields.row("trace", line)})
            cond.extend({**place, **fields.row("cond", sample)} for sample in line["cond"])
    if not runs:
        raise RecordError("\n".join([f"{root}: no run.json below this folder that can be read", *unreadable]))
    for line in unreadable:
        print(f"{line}; left out", file=sys.stderr)
    if unreadable:
        print(f"{root}: {len(unreadable)} of {len(unreadable) + len(runs)} records left out", file=sys.stderr)
    table = pd.DataFrame(runs).sort_values(["group", "started_utc"], kind="stable", ignore_index=True)
    table["series"] = _unique_series(table)
    return Records(table, pd.DataFrame(steps), pd.DataFrame(trace), pd.DataFrame(cond), unreadable)


def _unique_series(runs: pd.DataFrame) -> pd.Series:
    """Two runs of a group never share a name."""
    count = runs.groupby(["group", "series"]).cumcount()
    return runs["series"].where(count == 0, runs["series"] + " #" + (count + 1).astype(str))


def condition_of(records: Records, run: str, scaling: str, stage: str = "full", matrix: str = "clamped") -> pd.DataFrame:
    """Condition estimates of one run, in the order of the iterations; empty when there are none. matrix: "clamped", or "solved" for
    the matrices that were factorised where they differ. Records before version 3.1 have clamped ones only."""
    if records.cond.empty:
        return records.cond
    c = records.cond
    form = c["matrix"].fillna("clamped") if "matrix" in c else "clamped"
    return c[(c["run"] == run) & (c["scaling"] == scaling) & (c["stage"] == stage) & (form == matrix)].sort_values("n")


def places_in_time(records: Records, run: str, estimates: pd.DataFrame) -> pd.Series:
    """Step + iteration / (iterations of that step): nothing is cut off, and a stalled step squeezes no other one."""
    length = records.trace[records.trace["run"] == run].groupby("step")["iteration"].max() + 1
    return estimates["step"] + estimates["iteration"] / estimates["step"].map(length)
