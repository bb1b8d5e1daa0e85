"""The cost model that `linear_solver: auto` chooses by, fitted to the records of
configs/sweeps/linear_fit.json.

Seconds of a linear solve (analysis, factorisation, solution; failed attempts are solves of their own) are a
sum of work terms of the matrix of the first iteration, each with a coefficient >= 0, by least squares of
relative errors. The work terms are those of core/linear/cost_model.cpp. Every record has to be of one machine
and one build. Times are those of the threads of the sweep: one.
"""

from __future__ import annotations

import datetime
import json
import os
import re
import sys
from itertools import combinations
from pathlib import Path

import numpy as np
import pandas as pd

from .errors import UserError, tells
from .front.arguments import parser_of
from .places import ROOT
from .program import run_sweep
from .records import RecordError, Records, load
from .text_table import aligned
from .whole_file import write_whole

RECORDS = ROOT / "results/runs/linear_fit"
WORK_TERMS = ("solve", "entry", "entry_sqrt_unknown", "factor_entry", "factor_flop")
TIMES = ["time_linear_analyze_s", "time_linear_factor_s", "time_linear_solve_s"]
TERMS_OF = {
    "cholmod": ("solve", "entry", "factor_entry", "factor_flop"),
    "pcg": ("solve", "entry", "entry_sqrt_unknown"),
}  # others: all
NEEDS = ("cholmod",)  # its records know the work of a factor


def work_terms(unknowns: float, entries: float, factor_entries: float, factor_flop: float) -> np.ndarray:
    """As bb::work_terms."""
    return np.array([1.0, entries, entries * np.sqrt(unknowns), factor_entries, factor_flop])


def non_negative_fit(terms: np.ndarray, seconds: np.ndarray) -> np.ndarray:
    """The coefficients >= 0 with the least squares of relative errors: the best of all sets of terms that are
    positive by themselves.

    terms: [measurements x terms]; seconds: [measurements], > 0.
    """
    rows, n = terms / seconds[:, None], terms.shape[1]
    scale = np.abs(rows).max(axis=0)
    best, least = np.zeros(n), np.inf
    for size in range(1, min(n, len(seconds)) + 1):
        for chosen in map(list, combinations(range(n), size)):
            fitted = (
                np.linalg.lstsq(rows[:, chosen] / scale[chosen], np.ones(len(seconds)), rcond=None)[0]
                / scale[chosen]
            )
            error = float(np.sum((rows[:, chosen] @ fitted - 1) ** 2))
            if (fitted >= 0).all() and error < least * (1 - 1e-9):
                best, least = np.zeros(n), error
                best[chosen] = fitted
    return best


def measurements(records: Records) -> pd.DataFrame:
    """One row a record: scene (label of its case), solver, preconditioner, seconds of a solve, work terms."""
    runs = records.runs
    first = records.trace[(records.trace["n"] == 0)].set_index("run")
    scene = runs["series"].str.split(" ").str[0]  # the case of the first axis
    rows = []
    for label, group in runs.groupby(scene, sort=False):
        direct = group[group["linear_solver"].isin(NEEDS)]
        if direct.empty:
            raise RecordError(f"{label}: no record of {NEEDS[0]}, whose factor says the work")
        line = first.loc[direct.iloc[0]["run"]]
        terms = work_terms(line["n_free"], line["nnz"], line["factor_nnz"], line["factor_flop"])
        for _, run in group.iterrows():
            seconds = float(run[TIMES].sum()) / run["linear_solves"]
            if run["outcome"] != "ok" or not seconds > 0:
                print(f"{label}, {run['series']}: {run['outcome']}, left out", file=sys.stderr)
                continue
            preconditioner = "" if run["preconditioner"] == "none" else run["preconditioner"]
            if run["linear_solver"] == "pcg_resident" and not preconditioner:
                raise RecordError(
                    f"{label}, {run['series']}: found a record of {run['schema_version']}, which does not say"
                    " the preconditioner of pcg_resident; allowed: 3.8.0 or later (run it again)"
                )
            rows.append(
                {
                    "scene": label,
                    "solver": run["linear_solver"],
                    "preconditioner": preconditioner,
                    "seconds": seconds,
                    **dict(zip(WORK_TERMS, terms)),
                }
            )
    return pd.DataFrame(rows)


def fit(table: pd.DataFrame) -> tuple[list[dict], pd.DataFrame]:
    """The entries `costs` of a model, and the table with `expected` seconds."""
    costs, parts = [], []
    for (solver, preconditioner), rows in table.groupby(["solver", "preconditioner"], sort=False):
        terms = rows[list(WORK_TERMS)].to_numpy(float)
        own = [
            name in TERMS_OF.get(solver, WORK_TERMS) for name in WORK_TERMS
        ]  # what the solver does: others would not extrapolate
        each = np.zeros(len(WORK_TERMS))
        each[own] = non_negative_fit(terms[:, own], rows["seconds"].to_numpy(float))
        cost = {"solver": solver} | ({"preconditioner": preconditioner} if preconditioner else {})
        costs.append(cost | {"seconds_each": {name: float(f"{c:.4g}") for name, c in zip(WORK_TERMS, each)}})
        parts.append(rows.assign(expected=terms @ each))
    return costs, pd.concat(parts)


def model(records: Records) -> tuple[dict, pd.DataFrame]:
    """The file's content, and the table of the fit. Raises RecordError: several machines, no time pass, too
    few scenes.
    """
    cpus = sorted(set(records.runs["machine_cpu_model"]))
    if len(cpus) != 1:
        raise RecordError(f"records of several machines: {', '.join(cpus)}; one is needed")
    builds = sorted(set(records.runs["build_id"]))
    if len(builds) != 1:
        raise RecordError(f"records of {len(builds)} builds of the program; one is needed")
    commit = records.runs["provenance_git_commit"].iloc[0] + (
        " with changes" if records.runs["provenance_git_dirty"].any() else ""
    )
    table = measurements(records)
    if table.empty or table["scene"].nunique() < 3:
        raise RecordError(
            f"{0 if table.empty else table['scene'].nunique()} scenes with times; at least 3 are needed"
        )
    costs, fitted = fit(table)
    error = (fitted["expected"] / fitted["seconds"] - 1).abs()
    return {
        "schema": "barrierbench.linear_model/1",
        "machine": {"cpu_model": cpus[0]},
        "fitted": {
            "date": datetime.date.today().isoformat(),
            "records": len(fitted),
            "git_commit": commit,
            "scenes": sorted(set(table["scene"])),
            "relative_error_median": float(f"{error.median():.2g}"),
            "relative_error_max": float(f"{error.max():.2g}"),
        },
        "costs": costs,
    }, fitted


def print_table(table: pd.DataFrame) -> None:
    names = table["solver"] + table["preconditioner"].map(lambda p: f" with {p}" if p else "")
    shown = table.assign(
        name=names,
        text=[f"{s * 1e3:.4g} ({e * 1e3:.4g})" for s, e in zip(table["seconds"], table["expected"])],
    )
    by_scene = shown.pivot(index="scene", columns="name", values="text").fillna("-")
    rows = [[scene, *by_scene.loc[scene]] for scene in dict.fromkeys(table["scene"])]
    print("ms of a linear solve, measured (expected by the model)")
    print("\n".join(aligned(["scene", *by_scene.columns], rows, set(range(1, 1 + len(by_scene.columns))))))


def collect() -> Path:
    """Runs what is missing of the sweep; the folder of its records. Errors: UserError."""
    done = run_sweep(ROOT / "configs/sweeps/linear_fit.json", RECORDS, stdout=None)
    if done.returncode != 0:
        raise UserError(f"the sweep ended with {done.returncode}", done.returncode)
    return RECORDS


@tells("fit-linear")
def main(argv: list[str]) -> int:
    parser = parser_of("fit-linear", __doc__)
    parser.add_argument(
        "records", type=Path, nargs="?", help="folder of the records (default: the sweep is run)"
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(os.environ.get("BARRIERBENCH_CONFIGS", ROOT / "configs")) / "linear_models",
        help="folder of the models: the file is named after the processor (default: configs/linear_models)",
    )
    asked = parser.parse_args(argv)
    content, table = model(load(asked.records or collect()))
    print_table(table)
    name = re.sub(r"[^a-z0-9]+", "_", content["machine"]["cpu_model"].lower()).strip("_")
    path = asked.out / f"{name}.json"
    write_whole(path, json.dumps(content, indent=2) + "\n")
    print(
        f"relative error: median {content['fitted']['relative_error_median']}, largest"
        f" {content['fitted']['relative_error_max']}; {path}"
    )
    return 0
