"""Condition number of the Newton matrix over a run: raw and block-Jacobi-scaled, with both ends of the spectrum."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from .. import style
from ..load import LARGEST_COND, Records, condition_of

PANELS = (("cond", "condition number"), ("lambda_max", r"$\lambda_{\max}$"), ("lambda_min", r"$\lambda_{\min}$"))
SCALINGS = (("none", "raw"), ("block_jacobi", "block-Jacobi-scaled"))
UNITS = {"none": " (N/m)", "block_jacobi": ""}


def _draw_bounds(axis, bounds: pd.DataFrame, row: pd.Series, field: str) -> None:
    """Estimates that are only bounds stand apart, as forks without a line."""
    color = style.look(row["formulation"], row["series"]).color
    axis.plot(bounds["n"], bounds[field], linestyle="none", marker="2", markersize=4, color=color)


def _iterations_shown(records: Records, runs: pd.DataFrame) -> int:
    """The longest run that ended ok: a stalled one iterates to its cap and would squeeze the rest."""
    finished = runs.loc[runs["outcome"] == "ok", "run"]
    rows = records.cond[records.cond["run"].isin(finished)] if not records.cond.empty else records.cond
    return int(rows["n"].max()) if not rows.empty else 0


def figure(records: Records, group: str, out: Path) -> list[Path]:
    """One figure a group: columns raw and scaled, rows cond, lambda_max, lambda_min; x counts Newton iterations."""
    runs = records.runs[records.runs["group"] == group]
    fig, axes = plt.subplots(3, 2, figsize=(style.WIDE_IN, 6.2), sharex=True, layout="constrained")
    numbers = []
    shown = _iterations_shown(records, runs)
    for column, (scaling, title) in enumerate(SCALINGS):
        for _, row in runs.iterrows():
            estimates = condition_of(records, row["run"], scaling).copy()
            if estimates.empty:
                continue
            numbers.append(estimates.assign(group=group, series=row["series"], outcome=row["outcome"]))
            estimates.loc[estimates["status"] == "singular", "cond"] = LARGEST_COND
            sure = estimates[estimates["status"] == "ok"]
            bound = estimates[estimates["status"].isin(["lower_bound", "singular"])]
            for line, (field, _) in enumerate(PANELS):
                drawn = sure[sure["n"] <= 1.1 * shown] if shown > 0 else sure
                style.draw(axes[line, column], drawn["n"].to_numpy(), drawn[field].to_numpy(), row)
                _draw_bounds(axes[line, column], bound[bound[field].notna()], row, field)
        for line, (field, name) in enumerate(PANELS):
            axis = axes[line, column]
            style.log_if_decades(axis)
            if not axis.lines:
                style.not_measured(axis)
            elif shown > 0:
                axis.set_xlim(-0.03 * shown, 1.12 * shown)
            axis.set_ylabel(name + (UNITS[scaling] if field != "cond" else ""))
        axes[0, column].set_title(title)
        axes[-1, column].set_xlabel("Newton iteration of the run")
    literal = not runs.empty and (runs["step_solver"] == "article_literal").all()
    what = "the matrix before its Tikhonov term, as the article measures it" if literal else "the matrix that is solved"
    fig.suptitle(f"{group}: {what}", fontsize=8)
    style.legend_below(fig, axes[0, 0], runs)
    columns = ["group", "series", "outcome", "run", "n", "step", "iteration", "stage", "scaling"]
    columns += [field for field, _ in PANELS] + ["status"]
    table = pd.concat(numbers)[columns] if numbers else pd.DataFrame(columns=columns)
    return style.save(fig, out / f"condition_{group}", table)
