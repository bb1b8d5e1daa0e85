"""Records below a folder as tidy tables. Unknown fields are ignored, the schema's major version is checked."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd

from .captions import origin

SCHEMA_NAME = "barrierbench.run"
SCHEMA_MAJOR = 2
LARGEST_COND = 1e14  # beyond it rounding decides the smallest eigenvalue: what the record calls a lower bound


class RecordError(ValueError):
    """A file that is not a record this version can read."""


@dataclass
class Records:
    """`run` (the folder below the root) joins the tables; every other column keeps the record's own name."""

    runs: pd.DataFrame  # one row a run
    steps: pd.DataFrame  # one row a time step
    trace: pd.DataFrame  # one row a Newton iteration, `n` counts them over the run
    cond: pd.DataFrame  # one row a condition estimate
    unreadable: list[str] = field(default_factory=list)  # records left out: "path: reason"


def _scalars(mapping: dict) -> dict:
    return {k: v for k, v in mapping.items() if not isinstance(v, (dict, list))}


def _check_schema(record: dict, path: Path) -> None:
    schema = record.get("schema", {})
    major = str(schema.get("version", "")).split(".")[0]
    if schema.get("name") != SCHEMA_NAME or major != str(SCHEMA_MAJOR):
        raise RecordError(f"{path}: schema {schema}; this version reads {SCHEMA_NAME} {SCHEMA_MAJOR}.x.x")


def _series(labels: dict) -> str:
    """What a line of a figure is called: the case of its sweep, or the formulation."""
    note = labels.get("note") or ""
    case = note.split(": ", 1)[1] if ": " in note else note
    return case or labels["formulation"]


def _comparability(found: dict) -> dict:
    """As the program judged it (docs/design.md, Comparability): never computed here."""
    names = {"verdict": "comparability", "reason": "comparability_reason", "reference_run": "reference_run",
             "reference_gap_rel": "reference_gap_rel", "ratio": "gap_ratio", "max_ratio": "max_gap_ratio"}
    return {column: found[key] for key, column in names.items()}


def _run_row(record: dict, run: str) -> dict:
    labels, status, summary = record["labels"], record["status"], record["summary"]
    row = {"run": run, "folder": Path(run).name, "run_id": record["ids"]["run_id"], "config_id": record["ids"]["config_id"]}
    row |= {"group": record["ids"].get("sweep_id") or labels["scene"], "series": _series(labels)}
    row |= _scalars(labels) | {"outcome": status["outcome"], "started_utc": status["started_utc"], "detail": status["detail"], "valid": status["valid"]}
    row |= _scalars(summary) | {"gap_min_rel": summary["gap_min_rel"]["min"]}
    row |= origin(record)
    row["first_contact"] = summary["first_contact"]
    row["probe_pcg"] = summary["probe_pcg"]["median"]
    row |= {k: record["audit"][k] for k in ("enabled", "crossings", "violations", "unproven")}
    row |= {key: record["audit"][key] for key in ("judged", "obstacle_violations", "scene_faults")}
    row |= _comparability(record["comparability"])
    row |= {"free_dofs": record["scene"]["free_dofs"], "extent_m": record["scene"]["extent_m"]}
    row["blas_kernel"] = record["provenance"].get("blas", {}).get("kernel", "")  # empty: records before 2.0
    row |= {f"matching_{k}": v for k, v in _scalars(record["matching"]).items()}
    return row


def _trace_lines(path: Path) -> list[dict]:
    """A line torn by a crash can only be the last one: it is left out and said."""
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


def _read(path: Path) -> dict:
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
            record = _read(path)
            lines = _trace_lines(path.parent / "trace.jsonl")
        except RecordError as error:
            unreadable.append(str(error))
            continue
        run = str(path.parent.relative_to(root))
        runs.append(_run_row(record, run))
        for step in record["steps"]:
            steps.append({"run": run, **_scalars(step), "contacts": step["contacts"]["total"]})
        for n, line in enumerate(lines):
            place = {"run": run, "n": n, "step": line["step"], "iteration": line["iteration"]}
            trace.append({**place, **_scalars(line), "contacts": line["contacts"]["total"]})
            cond.extend({**place, **_scalars(c)} for c in line["cond"])
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


def condition_of(records: Records, run: str, scaling: str, stage: str = "full") -> pd.DataFrame:
    """Condition estimates of one run, in the order of the iterations; empty when there are none."""
    if records.cond.empty:
        return records.cond
    c = records.cond
    return c[(c["run"] == run) & (c["scaling"] == scaling) & (c["stage"] == stage)].sort_values("n")
