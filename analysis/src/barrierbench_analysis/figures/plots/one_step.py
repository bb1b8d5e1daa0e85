"""Every Newton iteration of one time step, the same of all runs: how far each may go and goes, and condition
number and both ends of the spectrum.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.ticker import MaxNLocator

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.tables.records import LARGEST_COND, Records, condition_of

from .drawing import Drawing, SweepRecords, about, common, outcomes

UNEVEN = 4.0
LENGTHS = {
    "alpha_ccd": "time of impact / step",
    "alpha_strain": "bound of the strain limit",
    "alpha": "accepted fraction",
}
SCALINGS = {"none": "raw", "block_jacobi": "block Jacobi"}
OF_LENGTHS = (
    "Every Newton iteration of time step {step}, in which steps are held back most: the largest"
    " fraction of the Newton direction that CCD allows (a), that the strain limit allows (b), and the"
    " fraction that is taken (c). 1: the whole direction. {failed}"
)
OF_CONDITION = (
    "Every Newton iteration of time step {step}, in which the condition numbers, as they are, are"
    " largest. (a) and (b) the condition number of the Newton matrix with every element clamped, as it is"
    " and scaled by block Jacobi; (c) its smallest and largest eigenvalue, raw, the band between them"
    " filled. Forks: bounds, the true number is at least as large. {failed}"
)


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


def worst(cond: pd.DataFrame) -> int | None:
    """The step whose largest condition number of a run, unscaled, is largest in the geometric mean over the
    runs; None where no step has some in every run.
    """
    if cond.empty:
        return None
    raw = cond[(cond["scaling"] == "none") & (cond["stage"] == "full") & cond["cond"].notna()]
    return least(-np.log(pd.to_numeric(raw["cond"])), raw)


def _count_from_one(axes, found: pd.DataFrame) -> None:
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


def _draw(subject: SweepRecords, numbers: pd.DataFrame, draw_run: Callable) -> None:
    """draw_run(its numbers, its row, whether the step is its last one, in which a run that failed did so)
    draws a run.
    """
    records, step = subject.records, numbers["step"].iloc[0]
    for _, row in style.runs_of(records.runs, records.runs["group"].iloc[0]).iterrows():
        is_end = bool(step == records.trace.loc[records.trace["run"] == row["run"], "step"].max())
        draw_run(numbers[numbers["run"] == row["run"]], row, is_end)


def _finish(
    subject: SweepRecords, drawing: Drawing, fig, axes, numbers: pd.DataFrame, shown: str, *facts: str
) -> list[Path]:
    """facts: what the numbers are, statistic and reference."""
    runs, step, (what, *others) = subject.records.runs, numbers["step"].iloc[0], facts
    _count_from_one(axes, numbers)
    n = f"{len(numbers)} {what} of {outcomes(runs)}"
    words = shown.format(step=step, failed=style.marker_sentence(runs))
    found = Facts(n, *others, f"step {step} of {common(runs)}")
    return drawing.finish(fig, axes, numbers, words, found, runs=runs, legend_runs=runs)


def _lengths(records: Records, step: int) -> pd.DataFrame:
    trace = records.trace[records.trace["step"] == step].sort_values("iteration")
    mine = [
        trace.loc[trace["run"] == row["run"], ["iteration", *LENGTHS]].assign(**about(row))
        for _, row in records.runs.iterrows()
    ]
    return pd.concat(mine, ignore_index=True).assign(step=step)


def step_lengths(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    """Time of impact and accepted fraction."""
    trace = subject.records.trace
    step = least(trace["alpha"], trace) if "alpha" in trace else None
    if step is None:
        raise drawing.nothing("no step has iterations in every run")
    numbers = _lengths(subject.records, step)
    if numbers[list(LENGTHS)].isna().all().all():
        raise drawing.nothing(f"no iteration of step {step} has a step length")
    fig, axes = drawing.panels(len(LENGTHS), 2.6, sharex=True, sharey=True)

    def draw_run(mine: pd.DataFrame, row: pd.Series, is_end: bool) -> None:
        for axis, column in zip(axes, LENGTHS):
            known = mine[pd.to_numeric(mine[column]).notna()]
            style.draw(axis, known["iteration"].to_numpy() + 1, known[column].to_numpy(float), row, is_end)

    _draw(subject, numbers, draw_run)
    small = numbers[list(LENGTHS)].min().min() < 0.05
    for axis, title in zip(axes, LENGTHS.values()):
        axis.set(title=title, yscale="log" if small else "linear")
        if not small:
            axis.set_ylim(0, 1.06)
    axes[0].set_ylabel("fraction of the direction")
    facts = ("iterations", "none: every iteration is drawn", "the whole Newton direction, 1")
    return _finish(subject, drawing, fig, axes, numbers, OF_LENGTHS, *facts)


def _estimates(records: Records, step: int) -> pd.DataFrame:
    """A row a run, scaling and iteration of the step."""
    columns = ["iteration", "cond", "lambda_min", "lambda_max", "status"]
    parts = []
    for _, row in records.runs.iterrows():
        for scaling in SCALINGS:
            found = condition_of(records, row["run"], scaling)
            parts.append(found.loc[found["step"] == step, columns].assign(scaling=scaling, **about(row)))
    found = pd.concat(parts, ignore_index=True)
    singular = found["status"].isin(["singular", "not_pd"])
    return found.assign(cond=found["cond"].astype(float).where(~singular, LARGEST_COND), step=step)


def _draw_ends(axis, found: pd.DataFrame, row: pd.Series) -> None:
    look = style.look(row["formulation"])
    sure = found.dropna(subset=["lambda_min", "lambda_max"])
    low, high = sure["lambda_min"].astype(float), sure["lambda_max"].astype(float)
    at = sure["iteration"] + 1
    axis.fill_between(at, low, high, color=look.color, alpha=0.07, linewidth=0)
    for end in (low, high):
        line = look.line(markersize=2.5, markeredgewidth=0.6, markevery=style.marks(len(sure), 8))
        axis.plot(at, end, **line, markerfacecolor=style.marker_face(row))


def newton_condition(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    """Condition number and both ends of the spectrum."""
    step = worst(subject.records.cond)
    if step is None:
        raise drawing.nothing("no step of these runs has condition estimates in every run")
    numbers = _estimates(subject.records, step)
    fig, axes = drawing.panels(3, 2.7)

    def draw_run(mine: pd.DataFrame, row: pd.Series, is_end: bool) -> None:
        color = style.look(row["formulation"]).color
        for axis, scaling in zip(axes, SCALINGS):
            found = mine[mine["scaling"] == scaling]
            style.draw(axis, found["iteration"].to_numpy() + 1, found["cond"].to_numpy(), row, is_end)
            bound = found[found["status"] != "ok"]
            axis.plot(bound["iteration"] + 1, bound["cond"], "2", markersize=6, color=color)
        _draw_ends(axes[2], mine[mine["scaling"] == "none"], row)

    _draw(subject, numbers, draw_run)
    for axis, title in zip(axes, [*SCALINGS.values(), "both ends, raw"]):
        axis.set(yscale="log", title=title)
        style.keep_span(axis)
    axes[0].set_ylabel("condition number")
    axes[2].set_ylabel("eigenvalue (N/m)")
    facts = ("estimates", "none: every estimate is drawn", "none")
    return _finish(subject, drawing, fig, axes, numbers, OF_CONDITION, *facts)
