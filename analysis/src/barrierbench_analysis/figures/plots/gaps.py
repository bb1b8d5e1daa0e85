"""Smallest gap at the end of each converged time step in units of d_hat."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.tables import series
from barrierbench_analysis.tables.records import Records

SHOWN = (
    "{group}: the smallest gap between any two surfaces at the end of each converged time step, in units of"
    " d_hat, the gap at which contact begins. Steps without contact have no point."
)
COLUMNS = ["group", "series", "run", "step", "t_s", "gap_min_m", "gap_min_rel"]


def _matched_at(runs: pd.DataFrame) -> float | None:
    """The gap / d_hat at which equal_force makes the forces of the formulations equal, if one rule holds for
    all that are matched.
    """
    if "matching_theta" not in runs:
        return None
    thetas = runs.loc[runs["matching_rule"] == "equal_force", "matching_theta"].dropna().unique()
    return float(thetas[0]) if len(thetas) == 1 else None


def _draw_run(axis, records: Records, row: pd.Series) -> list[pd.DataFrame]:
    """The run's line; the numbers, none where it has no steps."""
    if records.steps.empty:
        return []
    steps = records.steps[records.steps["run"] == row["run"]]
    if steps.empty:
        return []
    touching = steps[pd.to_numeric(steps["gap_min_rel"]).notna()]
    style.draw(axis, touching["t_s"].to_numpy(), touching["gap_min_rel"].to_numpy(dtype=float), row)
    return [touching[["run", "step", "t_s", "gap_min_m", "gap_min_rel"]].assign(series=row["series"])]


def figure(records: Records, group: str, out: Path, name: str = "") -> list[Path]:
    """`name` (gaps_GROUP), and its supplement where there are more series than one figure holds."""
    runs, paths, name = style.runs_of(records.runs, group), [], name or f"gaps_{group}"
    for part, some in series.parts_of_runs(runs, name):
        fig, axis = plt.subplots(figsize=(style.WIDE_IN, 4.2), layout="constrained")
        numbers = [table for _, row in some.iterrows() for table in _draw_run(axis, records, row)]
        if any(len(table) for table in numbers):
            axis.set_yscale("log")
        else:
            style.not_measured(axis, "no contact")
        style.keep_span(axis)
        style.reference_line(axis, 1, r"$\hat d$: contact begins")
        if (theta := _matched_at(runs)) is not None:
            style.reference_line(
                axis, theta, rf"{theta:g} $\hat d$: forces are matched here", ":", below=True
            )
        axis.set(xlabel="time (s)", ylabel=r"smallest gap / $\hat d$", title=group)
        style.legend_below(fig, axis, runs)
        table = pd.concat(numbers).assign(group=group)[COLUMNS] if numbers else pd.DataFrame(columns=COLUMNS)
        shown = " ".join(filter(None, [SHOWN.format(group=group), part.says, style.marker_sentence(runs)]))
        paths += style.save(fig, out / f"{name}{part.suffix}", table, shown, some)
    return paths
