"""What figures are drawn of: records of sweeps, kept numbers of studies, shapes, matrices and baselines. A
sweep is run where that is allowed; else, what is missing is said with the command that makes it.
"""

import json
import os
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd

from barrierbench_analysis.figures.plots.drawing import Place, Spectrum, SweepRecords, Wanted
from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.cases import has_list, read_cases
from barrierbench_analysis.io.digests import of_text
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.git import NoHistory, git
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.matrix_market import read_matrix
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.program.start import check_ended, run_sweep
from barrierbench_analysis.studies.kit.runs import Sweep, inputs_sha256
from barrierbench_analysis.tables.records import load

from . import studies

MATRICES, BASELINES = ROOT / "results" / "matrices", ROOT / "results" / "baselines"


def folder_of(file: Path, runs: Path) -> Path:
    """Of the records of a sweep file: its name has a hash of the file, and of the configs, presets and meshes
    that it names.
    """
    text = input_file.read_text(file)
    data = read_object(file)
    base = data.get("base")
    if not isinstance(base, str):
        raise UserError(
            f"{file}#/base: found {base!r}; the path of a config, relative to this file, is needed"
        )
    resolved = json.dumps({**data, "base": str((file.parent / base).resolve())})
    return runs / f"{file.stem}-{of_text(text + inputs_sha256(Sweep(file.stem, resolved, ())))[:8]}"


def _shown(path: Path) -> str:
    return os.path.relpath(path, Path.cwd())


def _missing(folder: Path) -> str:
    """How many records are not there; empty where all are."""
    if not has_list(folder):
        return "no record is there"
    cases = read_cases(folder)
    left = sum(not case.record.is_file() for case in cases)
    return f"{left} of {len(cases)} records are missing" if left else ""


def sweep(wanted: Wanted, place: Place) -> SweepRecords:
    """Errors: UserError where records are missing that may not be made, or the program refuses the sweep."""
    file, folder = wanted.what, folder_of(wanted.what, place.runs)
    jobs = 1 if wanted.alone else place.jobs
    if place.may_run and _missing(folder):
        done = run_sweep(file, folder, "--progress", "none", "--jobs", str(jobs))
        check_ended(done, f"{file}: ")
    if missing := _missing(folder):
        raise UserError(
            f"{folder}: {missing}; this makes them: ./bench sweep {_shown(file)} --out {_shown(folder)}"
            f" (./bench plan {_shown(file)} says what it takes)"
        )
    records, order = load(folder), [case.folder.name for case in read_cases(folder)]
    runs = records.runs[records.runs["run"].isin(order)]
    records.runs = runs.sort_values("run", key=lambda names: names.map(order.index), ignore_index=True)
    return SweepRecords(file.stem, records, folder)


def matrices(wanted: Wanted, _: Place) -> list[Spectrum]:
    """Errors: UserError where one is not there. Cost: cubic in the rows."""
    found = []
    for name in wanted.what:
        if not (MATRICES / f"{name}.mtx").is_file():
            raise UserError(f"{MATRICES}/{name}.mtx: not there; this makes it: ./bench study matrix-corpus")
        dense = read_matrix(MATRICES / f"{name}.mtx").toarray()
        about = read_object(MATRICES / f"{name}.json")
        found.append(Spectrum(name, about, np.linalg.eigvalsh(dense)))
    return found


def _git(*words: str) -> str:
    try:
        return git(ROOT, *words)
    except NoHistory as fault:
        raise UserError(
            f"{BASELINES}: their history is read from git, which says:"
            f" {(str(fault) or 'nothing').splitlines()[0]}; a clone with its history is needed"
        ) from None


def baselines(wanted: Wanted, _: Place) -> pd.DataFrame:
    """A row a commit that changed baselines, case and metric, the oldest first: what `./bench gate accept`
    kept.
    Errors: UserError without git history.
    """
    rows = []
    commits = _git("log", "--reverse", "--format=%H %cs", "--", "results/baselines").split("\n")
    for at, (commit, day) in enumerate(line.split() for line in commits if line):
        there = _git("ls-tree", "--name-only", commit, "results/baselines/").split()
        for case in wanted.what:
            if f"results/baselines/{case}.json" not in there:
                continue
            kept = json.loads(_git("show", f"{commit}:results/baselines/{case}.json"))
            rows += [
                {"at": at, "commit": commit[:10], "day": day, "case": case, "metric": name}
                | {key: metric.get(key) for key in ("value", "lower", "upper")}
                for name, metric in kept["metrics"].items()
            ]
    if not rows:
        print(f"{BASELINES}: no commit has {', '.join(wanted.what)}", file=sys.stderr)
    return pd.DataFrame(rows, columns=["at", "commit", "day", "case", "metric", "value", "lower", "upper"])


def shapes(wanted: Wanted, _: Place) -> tuple[str, ...]:
    return wanted.what


def study(wanted: Wanted, place: Place):
    return studies.of_file(wanted.what, place.runs, place.may_run, place.jobs)


READERS: dict[str, Callable] = {
    "sweep": sweep,
    "study": study,
    "shapes": shapes,
    "matrices": matrices,
    "baselines": baselines,
}


def subject(wanted: Wanted, place: Place):
    """What the kind of a figure draws. Errors: UserError."""
    return READERS[wanted.source](wanted, place)
