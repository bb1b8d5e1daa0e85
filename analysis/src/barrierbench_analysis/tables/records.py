"""Records below a folder as tidy tables. record_file.py judges every file first; unknown fields are
ignored."""

import sys
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd

from barrierbench_analysis.io import fields
from barrierbench_analysis.io.cases import has_list, records_below
from barrierbench_analysis.io.record_file import RecordError, other_meanings, read_record, read_trace

from .run_rows import run_row

LARGEST_COND = 1e14  # beyond it rounding decides the smallest eigenvalue: what the record calls a lower bound


@dataclass
class Records:
    """`run` (the folder below the root) joins the tables; the other columns are those of fields.columns()."""

    runs: pd.DataFrame  # one row a run
    steps: pd.DataFrame  # one row a time step
    trace: pd.DataFrame  # one row a Newton iteration, `n` counts them over the run
    cond: pd.DataFrame  # one row a condition estimate
    unreadable: list[str] = field(default_factory=list)  # records left out: "path: reason"

    def rows(self) -> list[dict]:
        """The rows of `runs` as run_rows.run_row makes them: None in the place of what is none."""
        runs = self.runs.astype(object)
        return runs.where(runs.notna(), None).to_dict("records")


def _plugins(record: dict, folder: Path) -> tuple[tuple[str, str], ...]:
    """File and sha256 of every plugin of the run; formulas are no plugins that could be requested."""
    plugins = record.get("provenance", {}).get("plugins") or []
    plugins = [plugin for plugin in plugins if not plugin["name"].startswith("formula:")]
    return tuple((str((folder / plugin["file"]).resolve()), plugin["sha256"]) for plugin in plugins)


def _loaded(record: dict, folder: Path, run: str) -> dict:
    """A row of `runs` with the files of its plugins, when it began (empty for a case of a sweep, whose place
    is that of its list) and its dt, s.
    """
    return run_row(record, run) | {
        "plugin_files": _plugins(record, folder),
        "begun": "" if has_list(folder.parent) else record["status"].get("started_utc", ""),
        "config_dt_s": ((record.get("config") or {}).get("time") or {}).get("dt_s"),
    }


def load(root: str | Path, files: Iterable[Path] | None = None) -> Records:
    """Every record below `root`, or these of them; of a sweep's folder those of its cases, in their order,
    whenever they ran. Others of a group are in the order in which they began.

    A record that record_file.py refuses, or whose trace is not the one that it names, is left out:
    `unreadable` and a line on stderr say why. Raises RecordError when no record can be read.
    """
    root = Path(root)
    runs, steps, trace, cond, unreadable = [], [], [], [], []
    for path in records_below(root) if files is None else sorted(files):
        try:
            record = read_record(path)
            lines = read_trace(record, path.parent)
        except RecordError as error:
            unreadable.append(str(error))
            continue
        run = str(path.parent.relative_to(root))
        runs.append(_loaded(record, path.parent, run))
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
    _say_other_meanings(root, runs)
    table = pd.DataFrame(runs).sort_values(["group", "begun"], kind="stable", ignore_index=True)
    table = table.drop(columns="begun")
    table["series"] = _unique_series(table)
    return Records(table, pd.DataFrame(steps), pd.DataFrame(trace), pd.DataFrame(cond), unreadable)


def _say_other_meanings(root: Path, runs: list[dict]) -> None:
    """Records are read as they are: a field that meant something else in their version is named."""
    earlier = [found for row in runs if (found := other_meanings(row["schema_version"]))]
    if earlier:
        since = next(iter(earlier[0].values()))["since"]
        print(
            f"{root}: {len(earlier)} of {len(runs)} records are of before {since}, in which these fields mean"
            f" something else: {', '.join(earlier[0])} (./bench help record, ./bench help trace)",
            file=sys.stderr,
        )


def _unique_series(runs: pd.DataFrame) -> pd.Series:
    """Two runs of a group never share a name: that of their configs, where it differs, separates them; else
    they are numbered.
    """
    name = runs["note"].fillna("").str.partition(": ")[0]
    differ = name.groupby([runs["group"], runs["series"]]).transform("nunique") > 1
    series = runs["series"].where(~differ, runs["series"] + " (" + name + ")")
    count = runs.groupby([runs["group"], series]).cumcount()
    return series.where(count == 0, series + " #" + (count + 1).astype(str))


def condition_of(
    records: Records, run: str, scaling: str, stage: str = "full", matrix: str = "clamped"
) -> pd.DataFrame:
    """Condition estimates of one run, in the order of the iterations; empty when there are none. matrix:
    "clamped", or "solved" for the matrices that were factorised where they differ. Records before version 3.1
    have clamped ones only.
    """
    if records.cond.empty:
        return records.cond
    c = records.cond
    form = c["matrix"].fillna("clamped") if "matrix" in c else "clamped"
    return c[
        (c["run"] == run) & (c["scaling"] == scaling) & (c["stage"] == stage) & (form == matrix)
    ].sort_values("n")


def counted(estimates: pd.DataFrame) -> pd.Series:
    """Condition numbers as the program's summaries count them: lower bounds among them, a matrix that is
    singular or not positive definite as LARGEST_COND; estimates without a number are left out.
    """
    return (
        estimates["cond"]
        .astype(float)
        .where(~estimates["status"].isin(["singular", "not_pd"]), LARGEST_COND)
        .dropna()
    )


def step_spans(records: Records, run: str) -> pd.DataFrame:
    """`start` and `length` (s of simulated time) of every step of a run. A step that got nowhere is as long
    as most, or as dt.
    """
    if records.steps.empty:
        return pd.DataFrame(columns=["start", "length"], dtype=float)
    ends = records.steps[records.steps["run"] == run].set_index("step")["t_s"].astype(float)
    starts = ends.shift(fill_value=0.0)
    lengths = ends - starts
    whole = lengths[lengths > 0]
    usual = whole.median() if len(whole) else float(records.runs.set_index("run").loc[run, "config_dt_s"])
    return pd.DataFrame({"start": starts, "length": lengths.where(lengths > 0, usual)})


def places_in_time(records: Records, run: str, estimates: pd.DataFrame) -> pd.Series:
    """Simulated time (s): the start of the step and its share of iteration / (iterations of that step).
    Nothing is cut off, a stalled step squeezes no other one, and runs with other steps stand at the same
    time.
    """
    count = records.trace[records.trace["run"] == run].groupby("step")["iteration"].max() + 1
    spans = step_spans(records, run)
    share = estimates["iteration"] / estimates["step"].map(count)
    return estimates["step"].map(spans["start"]) + share * estimates["step"].map(spans["length"])
