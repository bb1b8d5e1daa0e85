"""Which time step of several runs figures of iterations show, and how."""

from __future__ import annotations

import pandas as pd
from matplotlib.ticker import MaxNLocator

from barrierbench_analysis.tables.records import Records

UNEVEN = 4.0


def least(numbers: pd.Series, rows: pd.DataFrame) -> int | None:
    """The step, the same for all runs, whose smallest number of a run is least in the mean over the runs, the
    first of several; only steps that every run has numbers of. rows: `run` and `step` of each number. None
    without one.
    """
    if rows.empty:
        return None
    of_run = pd.to_numeric(numbers).groupby([rows["step"], rows["run"]]).min()
    means = of_run.unstack("run").dropna().mean(axis=1)
    return None if means.empty else int(means.idxmin())


def of_step(records: Records, run: str, step: int) -> pd.DataFrame:
    """Rows of the trace, in the order of the iterations."""
    found = records.trace
    return found[(found["run"] == run) & (found["step"] == step)].sort_values("iteration")


def count_from_one(axes, found: pd.DataFrame) -> None:
    """Labels axes whose lines are drawn over `iteration` + 1; logarithmic where one run takes many times as
    many iterations as most. found: rows with `run` and `iteration`.
    """
    counts = found.groupby("run")["iteration"].max() + 1
    for axis in axes:
        axis.set_xlabel("Newton iteration, from 1")
        if counts.max() > UNEVEN * counts.median():
            axis.set_xscale("log")
        else:
            axis.xaxis.set_major_locator(MaxNLocator(6, integer=True))


def ends_in(records: Records, run: str, step: int) -> bool:
    """Whether it is the last step of the run, in which a run that failed did so."""
    found = records.trace
    return bool(step == found.loc[found["run"] == run, "step"].max())
