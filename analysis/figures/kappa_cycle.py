"""The step in which a refresh of kappa in every iteration does not settle, beside the runs that get through it."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from .. import style
from ..load import Records

# Copies of settled_kappa and unsettled_iterations in core/newton/iteration.cpp.
SETTLED = 0.01  # a change of kappa below it leaves Newton alone
UNSETTLED_ITERATIONS = 10  # that many above it in a row are a cycle
SHOWN = (
    "{group}, time step {step}, in which a stiffness kappa that is computed anew in every Newton iteration does not settle: (a) the smallest gap of every "
    "iterate, (b) the largest relative change of a kappa since the iteration before. All iterations of the step are drawn, on logarithmic axes."
)
EDGE = 0.5  # of d_hat: below it kappa = m/d^2 with the cubic amplifies an error (docs/design.md)


def _cycling_step(trace: pd.DataFrame) -> int | None:
    """The last step of a run's trace when kappa was still changing at its end."""
    if trace.empty or "kappa_change_rel" not in trace:
        return None
    last = trace[trace["step"] == trace["step"].max()]
    change = pd.to_numeric(last["kappa_change_rel"]).tail(UNSETTLED_ITERATIONS)
    unsettled = len(change) == UNSETTLED_ITERATIONS and (change > SETTLED).all()
    return int(last["step"].iloc[0]) if unsettled else None


def figure(records: Records, group: str, out: Path) -> list[Path]:
    """Nothing where no run cycles."""
    runs = style.runs_of(records.runs, group)
    traces = {row["run"]: records.trace[records.trace["run"] == row["run"]] for _, row in runs.iterrows()} if not records.trace.empty else {}
    stopped = [row["run"] for _, row in runs.iterrows() if row["outcome"] != "ok"]
    steps = [step for run in stopped if (step := _cycling_step(traces.get(run, pd.DataFrame()))) is not None]
    if not steps:
        return []
    step = min(steps)
    fig, axes = plt.subplots(1, 2, figsize=(style.WIDE_IN, 3.4), layout="constrained")
    numbers = []
    for _, row in runs.iterrows():
        part = traces[row["run"]]
        part = part[part["step"] == step]
        gap, change = (pd.to_numeric(part[key]).to_numpy(dtype=float) for key in ("gap_min_iterates_rel", "kappa_change_rel"))
        iteration = part["iteration"].to_numpy()
        style.draw(axes[0], 1 + iteration, gap, row, end_word=False)
        style.draw(axes[1], 1 + iteration[change > 0], change[change > 0], row, end_word=False)
        numbers.append(pd.DataFrame({"series": row["series"], "iteration": iteration, "gap_min_iterates_rel": gap, "kappa_change_rel": change}))
    for axis in axes:
        if any(len(line.get_ydata()) for line in axis.lines):
            axis.set_yscale("log")
        axis.set(xscale="log", xlabel=f"Newton iteration of step {step}, counted from 1")
        style.keep_span(axis)
    style.reference_line(axes[0], EDGE, r"$\hat d/2$: below it $\kappa = m/d^2$ amplifies errors")
    style.reference_line(axes[1], SETTLED, "1%: settled below", ":")
    axes[0].set_ylabel(r"smallest gap / $\hat d$")
    axes[1].set_ylabel(r"relative change of a $\kappa$")
    style.letter_panels(axes)
    fig.suptitle(f"{group}: kappa refreshed in every iteration does not settle", fontsize=8)
    style.legend_below(fig, axes[0], runs)
    return style.save(fig, out / f"kappa_cycle_{group}", pd.concat(numbers).assign(group=group, step=step),
                      f"{SHOWN.format(group=group, step=step)} {style.marker_sentence(runs)}", runs)
