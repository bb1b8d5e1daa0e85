"""Which time step of several runs figures of iterations show, and its rows of the trace."""

from __future__ import annotations

import pandas as pd

from ..records import Records

UNEVEN = 4.0


def busiest(records: Records, by: pd.DataFrame | None = None) -> int | None:
    """The step, the same for all runs, in which the median run has most rows, the first of several; only
    steps that every run has rows of. by: rows with `run` and `step`, default the trace. None without one.
    """
    rows = records.trace if by is None else by
    if rows.empty:
        return None
    counts = rows.groupby(["step", "run"]).size().unstack("run").dropna()
    return None if counts.empty else int(counts.median(axis=1).idxmax())


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
