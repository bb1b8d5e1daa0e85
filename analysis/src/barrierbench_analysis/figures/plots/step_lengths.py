"""How far every Newton iteration of a time step may go and goes: time of impact and accepted fraction."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.tables.records import Records

from . import one_step
from .drawing import OF_RUNS, Drawing, common, outcomes
from .subjects import SweepRecords

PANELS = {
    "alpha_ccd": "time of impact / step",
    "alpha_strain": "bound of the strain limit",
    "alpha": "accepted fraction",
}
SHOWN = (
    "Every Newton iteration of time step {step}, in which steps are held back most: the largest"
    " fraction of the Newton direction that CCD allows (a), that the strain limit allows (b), and the"
    " fraction that is taken (c). 1: the whole direction. {failed}"
)


def table(records: Records, step: int) -> pd.DataFrame:
    parts = []
    for _, row in records.runs.iterrows():
        mine = one_step.of_step(records, row["run"], step)[["iteration", *PANELS]]
        parts.append(mine.assign(formulation=row["formulation"], run=row["run"], outcome=row["outcome"]))
    return pd.concat(parts, ignore_index=True)


def draw(axis, found: pd.DataFrame, column: str, row: pd.Series, is_end: bool) -> None:
    """is_end: the step is the last one of the run."""
    known = found[pd.to_numeric(found[column]).notna()]
    style.draw(axis, known["iteration"].to_numpy() + 1, known[column].to_numpy(dtype=float), row, is_end)


def figure(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    records = subject.records
    trace = records.trace
    step = one_step.least(trace["alpha"], trace) if "alpha" in trace else None
    if step is None:
        raise drawing.nothing("no step has iterations in every run")
    numbers = table(records, step).assign(step=step)
    if numbers[list(PANELS)].isna().all().all():
        raise drawing.nothing(f"no iteration of step {step} has a step length")
    fig, axes = plt.subplots(
        1, len(PANELS), figsize=(drawing.width_in, 2.6), sharex=True, sharey=True, layout="constrained"
    )
    for _, row in style.runs_of(records.runs, records.runs["group"].iloc[0]).iterrows():
        for axis, column in zip(axes, PANELS):
            is_end = one_step.ends_in(records, row["run"], step)
            draw(axis, numbers[numbers["run"] == row["run"]], column, row, is_end)
    small = numbers[list(PANELS)].min().min() < 0.05
    for axis, title in zip(axes, PANELS.values()):
        axis.set(title=title, yscale="log" if small else "linear")
        if not small:
            axis.set_ylim(0, 1.06)
    one_step.count_from_one(axes, numbers)
    axes[0].set_ylabel("fraction of the direction")
    style.letter_panels(axes)
    style.legend_below(fig, axes[0], records.runs)
    facts = Facts(
        f"{len(numbers)} iterations of {outcomes(records.runs)}",
        "none: every iteration is drawn",
        "the whole Newton direction, 1",
        f"step {step} of {common(records.runs, OF_RUNS)}",
    )
    shown = SHOWN.format(step=step, failed=style.marker_sentence(records.runs))
    return drawing.save(fig, numbers, shown, facts, records.runs)
