"""What is kept of the runs of an ablation: results/ablation.json, a row a run."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from barrierbench_analysis.io.json_file import number_at, rows_of
from barrierbench_analysis.io.origin import ID_DIGITS, run_of, seconds_of_run
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.store import a_line_each, in_columns, read_store
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.studies.kit.success import FAILURES
from barrierbench_analysis.tables.outcomes import OK, counted_as

from .factors import Factorial

FILE = ROOT / "results" / "ablation.json"
NAME = "barrierbench.ablation_results/1"
REMEDY = "; ./bench study ablation makes it"
METRICS = {  # of runs that ended ok and valid: where a record has it
    "newton": ("summary", "newton_iterations"),
    "bj_p95": ("summary", "cond", "full/block_jacobi", "log10_cond", "p95"),
    "pcg": ("summary", "probe_pcg", "median"),
    "gap": ("summary", "gap_min_rel", "min"),
}
COLUMNS = ("scene", "case", "outcome", "valid", "failed", *METRICS, "core_s", "config_id", "run_id")


@dataclass(frozen=True)
class Table:
    """rows: dicts of COLUMNS; about: where they come from, and what the whole factorial would cost."""

    digest: str
    about: dict
    rows: list[dict]


def row_of(scene: str, case: str, record: dict) -> dict:
    """`failed`: words of kit/success.py in which the common success fell short. bj_p95 is the condition
    number itself, not its logarithm.
    """
    row = {name: number_at(record, place) for name, place in METRICS.items()}
    if row["bj_p95"] is not None:
        row["bj_p95"] = round(10.0 ** row["bj_p95"], 6)
    status = record["status"]
    failed = [word for word, (_, read) in FAILURES.items() if read(record)]
    return row | {
        "scene": scene,
        "case": case,
        "outcome": status["outcome"],
        "valid": status["valid"],
        "failed": " ".join(failed),
        "core_s": round(seconds_of_run(record), 2),
        "config_id": record["ids"]["config_id"][:ID_DIGITS],
        "run_id": run_of(record),
    }


def got_through(row: dict) -> bool:
    return counted_as(row["outcome"], row["valid"]) == OK


def write(table: Table, file: Path = FILE) -> None:
    head = json.dumps(
        {"schema": NAME, "digest": table.digest, "about": table.about, "columns": COLUMNS}, indent=1
    )
    rows = a_line_each(in_columns(table.rows, COLUMNS), 2, ("[", "\n ]"))
    write_whole(file, f'{head[:-2]},\n "rows": {rows}\n}}\n')


def read(file: Path = FILE) -> Table:
    """Errors: UserError where it is not there, or of another schema or other columns."""
    return read_store(
        file, NAME, lambda data: Table(data["digest"], data["about"], rows_of(data, COLUMNS, file)), REMEDY
    )


def levels_of(factorial: Factorial, row: dict) -> tuple[int, ...]:
    """Of its case. Errors: ValueError for a label that is no level."""
    words = row["case"].split()
    return tuple(f.labels.index(word) for f, word in zip(factorial.factors, words, strict=True))
