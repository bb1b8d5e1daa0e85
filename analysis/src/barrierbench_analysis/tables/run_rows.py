"""A record as a row of the table `runs`."""

import json
from pathlib import Path

from barrierbench_analysis.io import fields


def case_name(labels: dict) -> str:
    """What a line of a figure is called: the case of its sweep, or the formulation."""
    note = labels.get("note") or ""
    case = note.split(": ", 1)[1] if ": " in note else note
    return case or labels["formulation"]


def own_name(labels: dict) -> str:
    """Of a run that is no case of a sweep: the name of its config (/name), or of its scene; records before
    3.9.0 have none. Of a case: the sweep's.
    """
    return (labels.get("note") or "").partition(": ")[0]


def _swept(text: str):
    """The value of a swept pointer, which the record keeps as JSON text; a value that is neither a number nor
    a word stays text.
    """
    try:
        value = json.loads(text)
    except ValueError:
        return text
    return text if isinstance(value, (dict, list)) else value


def run_row(record: dict, run: str = "") -> dict:
    """A row of `runs`: the fields of the record, a column for every pointer that its sweep varies
    (`/time/dt_s`), and where it belongs.
    """
    row = fields.row("runs", record)
    row |= {"run": run, "folder": Path(run).name, "series": case_name(record["labels"])}
    row |= {pointer: _swept(text) for pointer, text in (row.get("swept") or {}).items()}
    name = own_name(record["labels"])
    row["group"] = row["sweep_id"] or (name if name and row["scene"] == "bodies" else row["scene"])
    return row
