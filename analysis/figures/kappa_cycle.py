"""The step in which a refresh of kappa in every iteration does not settle, beside the runs that get through it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from .. import style
from ..load import Records

# Copies of settled_kappa and unsettled_iterations in core/newton/iteration.cpp.
SETTLED = 0.01  # a change of kappa below it leaves Newton alone
UNSETTLED_ITERATIONS = 10  # that many above it in a row are a cycle
SHOWN = (
    "{group}, time step {step}, in which the stiffness kappa of the {whose}, computed anew in every Newton iteration, does not settle: the smallest gap "
    "that this kappa is computed from, and the largest relative change of a kappa since the iteration before. All iterations of the step are drawn, on "
    "logarithmic axes."
)
EDGE = 0.5  # of the width: below it kappa = m/gap^2 with the cubic amplifies an error (docs/design.md)


@dataclass(frozen=True)
class Kappa:
    """One of the two stiffnesses that a policy refreshes: where the trace keeps its change and its gap, and their names."""

    whose: str
    change: str
    gap: str
    gap_label: str


KAPPAS = (
    Kappa("contacts", "kappa_change_rel", "gap_min_iterates_rel", r"smallest gap / $\hat d$"),
    Kappa("strain limit", "limit_kappa_change_rel", "limit_gap_min_rel", "smallest distance to the limit / width"),
)


def _column(trace: pd.DataFrame, key: str) -> pd.Series:
    """Numbers of a column, nan where the record has none or is older than the column."""
    return pd.to_numeric(trace[key]) if key in trace else pd.Series(np.nan, index=trace.index)


def _cycling(trace: pd.DataFrame) -> list[tuple[int, Kappa]]:
    """The last step of a run's trace with every kappa that was still changing at its end."""
    if trace.empty:
        return []
    last = trace[trace["step"] == trace["step"].max()].tail(UNSETTLED_ITERATIONS)
    if len(last) < UNSETTLED_ITERATIONS:
        return []
    return [(int(last["step"].iloc[0]), kappa) for kappa in KAPPAS if (_column(last, kappa.change) > SETTLED).all()]


def _draw(axes: np.ndarray, kappa: Kappa, step: int, runs: pd.DataFrame, traces: dict[str, pd.DataFrame]) -> pd.DataFrame:
    """One row of panels: the gap that this kappa is computed from, and how much the kappa changes. Returns the numbers."""
    numbers = []
    for _, row in runs.iterrows():
        part = traces[row["run"]]
        part = part[part["step"] == step]
        gap, change = (_column(part, key).to_numpy(dtype=float) for key in (kappa.gap, kappa.change))
        iteration = part["iteration"].to_numpy()
        style.draw(axes[0], 1 + iteration, gap, row, end_mark=False)
        style.draw(axes[1], 1 + iteration[change > 0], change[change > 0], row, end_mark=False)
        numbers.append(pd.DataFrame({"series": row["series"], "kappa": kappa.whose, "step": step, "iteration": iteration,
                                     "gap_min_iterates_rel": gap, "kappa_change_rel": change}))
    for axis in axes:
        if any(len(line.get_ydata()) for line in axis.lines):
            axis.set_yscale("log")
        axis.set(xscale="log", xlabel=f"Newton iteration of step {step}, counted from 1")
        style.keep_span(axis)
    style.reference_line(axes[0], EDGE, r"half of it: below, $\kappa = m/$gap$^2$ amplifies errors")
    style.reference_line(axes[1], SETTLED, "1%: settled below", ":")
    axes[0].set_ylabel(kappa.gap_label)
    axes[1].set_ylabel(rf"relative change of a $\kappa$, {kappa.whose}")
    return pd.concat(numbers)


def figure(records: Records, group: str, out: Path) -> list[Path]:
    """One row of panels for each kappa, of the contacts or of the strain limit, that does not settle; nothing where both do."""
    runs = style.runs_of(records.runs, group)
    traces = {row["run"]: records.trace[records.trace["run"] == row["run"]] for _, row in runs.iterrows()} if not records.trace.empty else {}
    stopped = [row["run"] for _, row in runs.iterrows() if row["outcome"] != "ok"]
    found = [cycle for run in stopped for cycle in _cycling(traces.get(run, pd.DataFrame()))]
    first = {kappa: min(step for step, other in found if other == kappa) for kappa in KAPPAS if any(other == kappa for _, other in found)}
    if not first:
        return []
    fig, axes = plt.subplots(len(first), 2, figsize=(style.WIDE_IN, 3.4 * len(first)), layout="constrained", squeeze=False)
    numbers = [_draw(axes[i], kappa, step, runs, traces) for i, (kappa, step) in enumerate(first.items())]
    style.letter_panels(axes.flatten())
    whose = " and ".join(kappa.whose for kappa in first)
    fig.suptitle(f"{group}: kappa of the {whose}, refreshed in every iteration, does not settle", fontsize=8)
    style.legend_below(fig, axes[0, 0], runs)
    caption = " ".join(SHOWN.format(group=group, step=step, whose=kappa.whose) for kappa, step in first.items())
    return style.save(fig, out / f"kappa_cycle_{group}", pd.concat(numbers).assign(group=group), f"{caption} {style.marker_sentence(runs)}", runs)
