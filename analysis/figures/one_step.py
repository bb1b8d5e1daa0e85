"""Which time step of several runs figures of iterations show, and its rows of the trace."""

from __future__ import annotations

import pandas as pd

from ..records import Records


def busiest(records: Records, by: pd.DataFrame | None = None) -> int | None:
    """The step, the same for all runs, in which they have most rows together, the first of several; only
    steps that every run has rows of. by: rows with `run` and `step`, default the trace. None without one.
    """
    rows = records.trace if by is None else by
    if rows.empty:
        return None
    counts = rows.groupby(["step", "run"]).size().unstack("run").dropna()
    return None if counts.empty else int(counts.sum(axis=1).idxmax())


def of_step(records: Records, run: str, step: int) -> pd.DataFrame:
    """Rows of the trace, in the order of the iterations."""
    found = records.trace
    return found[(found["run"] == run) & (found["step"] == step)].sort_values("iteration")
