"""What the generated parts of README.md and docs/results are made of: numbers of the demo's records, kept
in results/demo.json.
"""

import json
import math
from collections import Counter
from pathlib import Path

import numpy as np
import pandas as pd

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object, read_of_schema
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.tables.records import Records, condition_of, counted, load
from barrierbench_analysis.tables.table import summary_table

FILE = ROOT / "results" / "demo.json"
RUNS = ROOT / "results" / "runs" / "demo"
NAME = "barrierbench.demo_numbers/1"
REMEDY = "; ./bench demo, then ./bench dev readme --write, makes it"
# columns of the summary table that a row keeps
SUMMED = ["group", "series", *(f"cond_{of}_{what}" for of in ("raw", "bj") for what in ("median", "max"))]
SUMMED += ["newton_iterations", "probe_pcg", "gap_min_rel"]
AUDITED = ("crossings", "violations", "unproven", "judged")
# name in a row -> column of the runs
OF_RUN = {"outcome": "outcome", "verdict": "comparability_verdict", "step_solver": "step_solver"}
OF_RUN |= {name: f"audit_{name}" for name in AUDITED} | {"steps": "summary_steps", "run": "run_id"}
GROUPS = ("demo_drape", "demo_long", "demo_strip", "demo_pinned", "demo_article", "demo_equal_gap")


def _plain(value):
    """A number or word as JSON has it; None for what is none."""
    if value is None or isinstance(value, float) and not math.isfinite(value):
        return None
    return value.item() if isinstance(value, np.generic) else value


def _p95(records: Records, run: str) -> float | None:
    """95th percentile of the unscaled condition numbers of a run."""
    found = counted(condition_of(records, run, "none"))
    return None if found.empty else float(10 ** np.percentile(np.log10(found), 95))


def _last_in_contact(records: Records, run: str, steps: pd.DataFrame) -> dict[int, float]:
    """Step with contact at its end -> unscaled condition number of its last diagnosed iteration."""
    touching = (
        set(steps["step"][steps["contacts_total"].fillna(0) > 0]) if "contacts_total" in steps else set()
    )
    found = condition_of(records, run, "none")
    found = found.assign(cond=counted(found)).dropna(subset=["cond"])
    return {
        int(step): float(rows["cond"].iloc[-1]) for step, rows in found.groupby("step") if step in touching
    }


def _rows(records: Records, table: pd.DataFrame) -> list[dict]:
    """A row a run: the columns of the summary table, and what sentences need beside them."""
    rows = []
    for (_, run), (_, line) in zip(records.runs.iterrows(), table.iterrows()):
        steps = records.steps[records.steps["run"] == run["run"]]
        rows.append(
            {key: _plain(line[key]) for key in SUMMED}
            | {key: _plain(run.get(column)) for key, column in OF_RUN.items()}
            | {"steps": len(steps), "scale": _plain(run.get("matching_scale")), "valid": bool(run["valid"])}
            | {"cond_raw_p95": _p95(records, run["run"])}
            | {"cond_steps": _last_in_contact(records, run["run"], steps)}
        )
    return rows


def _about(runs: pd.DataFrame) -> dict:
    """Where and when, each once. The processor class is what the numbers hold for: another one adds in
    another order.
    """
    names = {
        "processor": "machine_cpu_model",
        "cores": "machine_cores",
        "blas_kernel": "provenance_blas_kernel",
        "compiler": "provenance_compiler",
        "flags": "provenance_flags",
        "commit": "provenance_git_commit",
    }
    about = {
        key: ", ".join(dict.fromkeys(str(value) for value in runs[column] if value is not None))
        for key, column in names.items()
    }
    days = sorted({str(value)[:10] for value in runs["started_utc"]})
    return about | {
        "days": " to ".join(dict.fromkeys((days[0], days[-1]))),
        "runs": len(runs),
        "outcomes": dict(Counter(runs["outcome"])),
    }


def _long(folder: Path) -> dict:
    """What the sentences on demo_long say of its sweep: simulated seconds, and of one iteration in how many
    there are condition numbers.
    """
    file = folder / "demo_long" / "sweep.json"
    settings = read_object(file).get("set", {})
    try:
        return {"duration_s": settings["/time/duration_s"], "every": settings["/diagnose/every"]}
    except KeyError as missing:
        raise UserError(f"{file}: set has no {missing}; ./bench demo makes it anew") from None


def gather(folder: Path) -> dict:
    """The numbers of all records of the demo below `folder`. Raises RecordError without any, UserError where
    a sweep is missing.
    """
    records = load(folder)
    if records.unreadable:
        raise UserError("\n".join(records.unreadable))
    if missing := [name for name in GROUPS if name not in set(records.runs["group"])]:
        raise UserError(f"{folder}: no records of {', '.join(missing)}; ./bench demo makes them")
    about = _about(records.runs) | {"long": _long(folder)}
    return {"schema": NAME, "about": about, "runs": _rows(records, summary_table(records))}


def write(numbers: dict, path: Path = FILE) -> None:
    lines = ",\n  ".join(json.dumps(row, allow_nan=False) for row in numbers["runs"])
    write_whole(
        path, f'{{"schema": "{NAME}", "about": {json.dumps(numbers["about"])},\n "runs": [\n  {lines}]}}\n'
    )


def read(path: Path = FILE) -> dict:
    """Raises UserError when the file is not there or not one of write()."""
    data = read_of_schema(path, NAME, REMEDY)
    if not data.get("runs"):
        raise UserError(f"{path}#/runs: found {data.get('runs')!r}; the runs of the demo are needed{REMEDY}")
    for row in data["runs"]:
        row["cond_steps"] = {int(step): cond for step, cond in row["cond_steps"].items()}
    return data
