"""Condition number of the Newton matrix over a run: raw and block-Jacobi-scaled, with both ends of the spectrum."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from .. import style
from ..load import LARGEST_COND, Records, condition_of, places_in_time

PANELS = (("cond", "condition number"), ("lambda_max", r"$\lambda_{\max}$"), ("lambda_min", r"$\lambda_{\min}$"))
SCALINGS = (("none", "raw"), ("block_jacobi", "block-Jacobi-scaled"))
SHOWN = (
    "{group}: of {what}; left column: as it is (raw); right column: scaled by block Jacobi (each 3 x 3 diagonal block made the identity; 2 x 2 in planar scenes): "
    "condition number (a, b), largest eigenvalue (c, d) and smallest eigenvalue (e, f). Every diagnosed Newton iteration of a step is drawn at its share "
    "of that step, so that all runs stand at the same simulated time. Forks without a line are bounds: the true condition number is at least as large."
)
UNITS = {"none": " (N/m)", "block_jacobi": ""}


def _draw_bounds(axis, bounds: pd.DataFrame, row: pd.Series, field: str) -> None:
    """Estimates that are only bounds stand apart, as forks without a line."""
    color = style.look(row["formulation"], int(row["variant"])).color
    axis.plot(bounds["at"], bounds[field], linestyle="none", marker="2", markersize=4, color=color)


def figure(records: Records, group: str, out: Path) -> list[Path]:
    """One figure a group: columns raw and scaled, rows cond, lambda_max, lambda_min; x is the time step."""
    runs = style.runs_of(records.runs, group)
    fig, axes = plt.subplots(3, 2, figsize=(style.WIDE_IN, 6.2), sharex=True, layout="constrained")
    numbers = []
    for column, (scaling, title) in enumerate(SCALINGS):
        for _, row in runs.iterrows():
            estimates = condition_of(records, row["run"], scaling).copy()
            if estimates.empty:
                continue
            estimates["at"] = places_in_time(records, row["run"], estimates)
            numbers.append(estimates.assign(group=group, series=row["series"], outcome=row["outcome"]))
            estimates.loc[estimates["status"] == "singular", "cond"] = LARGEST_COND
            sure = estimates[estimates["status"] == "ok"]
            bound = estimates[estimates["status"].isin(["lower_bound", "singular"])]
            for line, (field, _) in enumerate(PANELS):
                style.draw(axes[line, column], sure["at"].to_numpy(), sure[field].to_numpy(), row, end_mark=line == 0)
                _draw_bounds(axes[line, column], bound[bound[field].notna()], row, field)
        for line, (field, name) in enumerate(PANELS):
            axis = axes[line, column]
            style.log_if_decades(axis)
            style.keep_span(axis)
            if not axis.lines:
                style.not_measured(axis)
            axis.set_ylabel(name + (UNITS[scaling] if field != "cond" else ""))
        axes[0, column].set_title(title)
        axes[-1, column].set_xlabel("time step (its Newton iterations evenly within it)")
    style.letter_panels(axes)
    literal = not runs.empty and (runs["step_solver"] == "article_literal").all()
    what = "the matrix before its Tikhonov term, as the article measures it" if literal else "the Newton matrix with every element clamped"
    fig.suptitle(f"{group}: {what}", fontsize=8)
    style.legend_below(fig, axes[0, 0], runs)
    columns = ["group", "series", "outcome", "run", "n", "step", "iteration", "stage", "scaling"]
    columns += [field for field, _ in PANELS] + ["status"]
    table = pd.concat(numbers)[columns] if numbers else pd.DataFrame(columns=columns)
    return style.save(fig, out / f"condition_{group}", table, f"{SHOWN.format(group=group, what=what)} {style.marker_sentence(runs)}", runs)
