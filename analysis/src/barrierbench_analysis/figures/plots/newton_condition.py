"""Condition number and both ends of the spectrum against the Newton iterations of one time step."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.tables.records import LARGEST_COND, Records, condition_of

from . import one_step
from .drawing import OF_RUNS, Drawing, common, outcomes
from .subjects import SweepRecords

SCALINGS = (("none", "raw"), ("block_jacobi", "block Jacobi"))
SHOWN = (
    "Every Newton iteration of time step {step}, in which the condition numbers, as they are, are"
    " largest. (a) and (b) the condition number of the Newton matrix with every element clamped, as it is"
    " and scaled by block Jacobi; (c) its smallest and largest eigenvalue, raw, the band between them"
    " filled. Forks: bounds, the true number is at least as large. {failed}"
)


def worst(cond: pd.DataFrame) -> int | None:
    """The step whose largest condition number of a run, unscaled, is largest in the geometric mean over the
    runs; None where no step has some in every run.
    """
    if cond.empty:
        return None
    raw = cond[(cond["scaling"] == "none") & (cond["stage"] == "full") & cond["cond"].notna()]
    return one_step.least(-np.log(pd.to_numeric(raw["cond"])), raw)


def table(records: Records, step: int) -> pd.DataFrame:
    """A row a run, scaling and iteration of the step."""
    parts = []
    for _, row in records.runs.iterrows():
        for scaling, _ in SCALINGS:
            found = condition_of(records, row["run"], scaling)
            mine = found[found["step"] == step][["iteration", "cond", "lambda_min", "lambda_max", "status"]]
            about = {"formulation": row["formulation"], "run": row["run"], "outcome": row["outcome"]}
            parts.append(mine.assign(scaling=scaling, **about))
    found = pd.concat(parts, ignore_index=True)
    singular = found["status"].isin(["singular", "not_pd"])
    return found.assign(cond=found["cond"].astype(float).where(~singular, LARGEST_COND))


def draw_condition(axis, found: pd.DataFrame, row: pd.Series, is_end: bool) -> None:
    """is_end: the step is the last one of the run."""
    style.draw(axis, found["iteration"].to_numpy() + 1, found["cond"].to_numpy(), row, is_end)
    bound = found[found["status"] != "ok"]
    color = style.look(row["formulation"]).color
    axis.plot(bound["iteration"] + 1, bound["cond"], linestyle="none", marker="2", markersize=6, color=color)


def draw_ends(axis, found: pd.DataFrame, row: pd.Series) -> None:
    look = style.look(row["formulation"])
    sure = found.dropna(subset=["lambda_min", "lambda_max"])
    low, high = sure["lambda_min"].astype(float), sure["lambda_max"].astype(float)
    at = sure["iteration"] + 1
    axis.fill_between(at, low, high, color=look.color, alpha=0.07, linewidth=0)
    for end in (low, high):
        axis.plot(
            at,
            end,
            color=look.color,
            linestyle=look.dash,
            marker=look.marker,
            markersize=2.5,
            markerfacecolor=style.marker_face(row),
            markeredgewidth=0.6,
            markevery=style.marks(len(sure), 8),
        )


def figure(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    records = subject.records
    step = worst(records.cond)
    if step is None:
        raise drawing.nothing("no step of these runs has condition estimates in every run")
    numbers = table(records, step).assign(step=step)
    fig, axes = plt.subplots(1, 3, figsize=(drawing.width_in, 2.7), layout="constrained")
    for _, row in style.runs_of(records.runs, records.runs["group"].iloc[0]).iterrows():
        mine = numbers[numbers["run"] == row["run"]]
        for axis, (scaling, _) in zip(axes, SCALINGS):
            is_end = one_step.ends_in(records, row["run"], step)
            draw_condition(axis, mine[mine["scaling"] == scaling], row, is_end)
        draw_ends(axes[2], mine[mine["scaling"] == "none"], row)
    for axis, title in zip(axes, [title for _, title in SCALINGS] + ["both ends, raw"]):
        axis.set(yscale="log", title=title)
        style.keep_span(axis)
    one_step.count_from_one(axes, numbers)
    axes[0].set_ylabel("condition number")
    axes[2].set_ylabel("eigenvalue (N/m)")
    style.letter_panels(axes)
    style.legend_below(fig, axes[0], records.runs)
    facts = Facts(
        f"{len(numbers)} estimates of {outcomes(records.runs)}",
        "none: every estimate is drawn",
        "none",
        f"step {step} of {common(records.runs, OF_RUNS)}",
    )
    shown = SHOWN.format(step=step, failed=style.marker_sentence(records.runs))
    return drawing.save(fig, numbers, shown, facts, records.runs)
