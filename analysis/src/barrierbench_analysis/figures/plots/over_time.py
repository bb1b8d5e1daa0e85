"""Figures of the runs of a group over their steps: the smallest gap of each, and the work that it took. With
those of condition.py they are kinds of the comparison too.
"""

from collections.abc import Callable
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.tables import series
from barrierbench_analysis.tables.records import Records

from . import condition as of_condition
from .drawing import Drawing, SweepRecords, common, outcomes

OF_GAPS = (
    "{group}: the smallest gap between any two surfaces at the end of each converged time step, in units of"
    " d_hat, the gap at which contact begins. Steps without contact have no point."
)
OF_ITERATIONS = (
    "{group}: (a) Newton iterations of every time step; (b) the share of time steps that took at most so"
    " many; (c) the share of diagnosed Newton matrices on which block-Jacobi preconditioned conjugate"
    " gradients (PCG), started from zero on one fixed right-hand side, took at most so many iterations to a"
    " relative residual of 1e-6."
)
GAPS = ["group", "series", "run", "step", "t_s", "gap_min_m", "gap_min_rel"]
ITERATIONS = ["group", "what", "series", "at", "count"]


def _parts(
    records: Records, group: str, out: Path, name: str, columns: list[str], shown: str, draw: Callable
):
    """`name`, and its supplement where there are more series than one figure holds. draw(runs of a part, all
    runs) draws one: figure, first panel, and tables of numbers.
    """
    runs, paths = style.runs_of(records.runs, group), []
    for part, some in series.parts_of_runs(runs, name):
        fig, axis, numbers = draw(some, runs)
        style.legend_below(fig, axis, runs)
        table = pd.concat(numbers).assign(group=group)[columns] if numbers else pd.DataFrame(columns=columns)
        words = " ".join(filter(None, [shown.format(group=group), part.says, style.marker_sentence(runs)]))
        paths += style.save(fig, out / f"{name}{part.suffix}", table, words, some)
    return paths


def _rows_of(table: pd.DataFrame, run: str) -> pd.DataFrame:
    return table[table["run"] == run] if not table.empty else table


# --- gaps


def _matched_at(runs: pd.DataFrame) -> float | None:
    """The gap / d_hat at which equal_force makes the forces of the formulations equal, if one rule holds for
    all that are matched.
    """
    if "matching_theta" not in runs:
        return None
    thetas = runs.loc[runs["matching_rule"] == "equal_force", "matching_theta"].dropna().unique()
    return float(thetas[0]) if len(thetas) == 1 else None


def gaps(records: Records, group: str, out: Path, name: str = "") -> list[Path]:
    def draw(some: pd.DataFrame, runs: pd.DataFrame):
        fig, axis = plt.subplots(figsize=(style.WIDE_IN, 4.2), layout="constrained")
        numbers = []
        for _, row in some.iterrows():
            if not (steps := _rows_of(records.steps, row["run"])).empty:
                touching = steps[pd.to_numeric(steps["gap_min_rel"]).notna()]
                style.draw(axis, touching["t_s"].to_numpy(), touching["gap_min_rel"].to_numpy(float), row)
                numbers.append(touching[GAPS[2:]].assign(series=row["series"]))
        if any(map(len, numbers)):
            axis.set_yscale("log")
        else:
            style.not_measured(axis, "no contact")
        style.keep_span(axis)
        style.reference_line(axis, 1, r"$\hat d$: contact begins")
        if (theta := _matched_at(runs)) is not None:
            words = rf"{theta:g} $\hat d$: forces are matched here"
            style.reference_line(axis, theta, words, ":", below=True)
        axis.set(xlabel="time (s)", ylabel=r"smallest gap / $\hat d$", title=group)
        return fig, axis, numbers

    return _parts(records, group, out, name or f"gaps_{group}", GAPS, OF_GAPS, draw)


# --- iterations


def _ecdf(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners of the share of values that are at most x, from 0 on; to be drawn with steps-post."""
    x = np.sort(values)
    return np.concatenate([x[:1], x]), np.arange(len(x) + 1) / max(1, len(x))


def _draw_work(axes, records: Records, row: pd.Series) -> list[pd.DataFrame]:
    """The run's line in every panel; the numbers."""
    steps, trace = _rows_of(records.steps, row["run"]), _rows_of(records.trace, row["run"])
    numbers = []

    def keep(what: str, at: pd.Series, count: np.ndarray, axis) -> None:
        style.draw(axis, *_ecdf(count), row, end_mark=False, steps="steps-post")
        numbers.append(pd.DataFrame({"what": what, "series": row["series"], "at": at, "count": count}))

    if not steps.empty:
        newton = steps["newton_iterations"].to_numpy()
        style.draw(axes[0], steps["t_s"].to_numpy(), newton, row, steps="steps-mid")
        keep("newton_per_step", steps["t_s"], newton, axes[1])
    probes = trace[trace["probe_pcg_iterations"].notna()] if not trace.empty else trace
    if not probes.empty:
        keep("probe_pcg", probes["n"], probes["probe_pcg_iterations"].to_numpy(float), axes[2])
    return numbers


def _set_axes(axes) -> None:
    axes[0].set(xlabel="time (s)", ylabel="Newton iterations")
    axes[1].set(xlabel="Newton iterations of a step", ylabel="share of steps", ylim=(0, 1.02))
    axes[2].set(xlabel="block-Jacobi PCG iterations", ylabel="share of matrices", ylim=(0, 1.02))
    axes[0].locator_params(axis="x", nbins=4)
    style.log_if_decades(axes[0])
    if axes[0].get_yscale() == "log":
        axes[1].set_xscale("log")
    for axis, which in zip(axes, "yxx"):
        style.keep_span(axis, which)
    style.letter_panels(axes)
    if not axes[2].lines:
        style.not_measured(axes[2])


def iterations(records: Records, group: str, out: Path, name: str = "") -> list[Path]:
    """Newton iterations of each step, their distribution, and PCG iterations on each diagnosed matrix."""

    def draw(some: pd.DataFrame, _: pd.DataFrame):
        fig, axes = plt.subplots(1, 3, figsize=(style.WIDE_IN, 3.2), layout="constrained")
        numbers = [table for _, row in some.iterrows() for table in _draw_work(axes, records, row)]
        _set_axes(axes)
        fig.suptitle(f"{group}: work of every step and of every diagnosed matrix", fontsize=8)
        return fig, axes[0], numbers

    return _parts(records, group, out, name or f"iterations_{group}", ITERATIONS, OF_ITERATIONS, draw)


# --- as kinds of the comparison


def _kind(draw: Callable, statistic: str, has: Callable[[Records], bool], what: str) -> Callable:
    def figure(subject: SweepRecords, drawing: Drawing) -> list[Path]:
        records = subject.records
        if not has(records):
            raise drawing.nothing(f"no run has {what} ({outcomes(records.runs)})")
        paths = draw(records, records.runs["group"].iloc[0], drawing.stem.parent, drawing.stem.name)
        return drawing.state(paths, Facts(outcomes(records.runs), statistic, "none", common(records.runs)))

    return figure


def _has_estimate(records: Records) -> bool:
    return not records.cond.empty and records.cond["cond"].notna().any()


def _has_gap(records: Records) -> bool:
    return _has_step(records) and records.steps["gap_min_rel"].notna().any()


def _has_step(records: Records) -> bool:
    return not records.steps.empty


DISTRIBUTIONS = "empirical distributions over the steps, and over the diagnosed matrices, of a run"
EVERY = "none: every estimate is drawn"
KINDS = {
    "condition": _kind(of_condition.figure, EVERY, _has_estimate, "a condition estimate"),
    "iterations": _kind(iterations, DISTRIBUTIONS, _has_step, "a step"),
    "gaps": _kind(gaps, "smallest gap of a step end", _has_gap, "a gap"),
}
