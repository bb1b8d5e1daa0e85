"""Work of a run: Newton iterations of each step, their distribution, and PCG iterations on each diagnosed matrix."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from .. import style
from ..load import Records


SHOWN = (
    "{group}: (a) Newton iterations of every time step; (b) the share of time steps that took at most so many; (c) the share of diagnosed "
    "Newton matrices on which block-Jacobi preconditioned conjugate gradients (PCG), started from zero on one fixed right-hand side, took at most so many "
    "iterations to a relative residual of 1e-6."
)


def _ecdf(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners of the share of values that are at most x, from 0 on; to be drawn with steps-post."""
    x = np.sort(values)
    return np.concatenate([x[:1], x]), np.arange(len(x) + 1) / max(1, len(x))


def _rows_of(table: pd.DataFrame, run: str) -> pd.DataFrame:
    return table[table["run"] == run] if not table.empty else table


def figure(records: Records, group: str, out: Path) -> list[Path]:
    runs = style.runs_of(records.runs, group)
    fig, axes = plt.subplots(1, 3, figsize=(style.WIDE_IN, 2.6), layout="constrained")
    numbers = []
    for _, row in runs.iterrows():
        steps, trace = _rows_of(records.steps, row["run"]), _rows_of(records.trace, row["run"])
        if not steps.empty:
            newton = steps["newton_iterations"].to_numpy()
            style.draw(axes[0], steps["step"].to_numpy(), newton, row, steps="steps-mid")
            style.draw(axes[1], *_ecdf(newton), row, end_mark=False, steps="steps-post")
            numbers.append(pd.DataFrame({"what": "newton_per_step", "series": row["series"], "at": steps["step"], "count": newton}))
        probes = trace[trace["probe_pcg_iterations"].notna()] if not trace.empty else trace
        if not probes.empty:
            pcg = probes["probe_pcg_iterations"].to_numpy(dtype=float)
            style.draw(axes[2], *_ecdf(pcg), row, end_mark=False, steps="steps-post")
            numbers.append(pd.DataFrame({"what": "probe_pcg", "series": row["series"], "at": probes["n"], "count": pcg}))
    axes[0].set(xlabel="time step", ylabel="Newton iterations")
    axes[1].set(xlabel="Newton iterations of a step", ylabel="share of steps", ylim=(0, 1.02))
    axes[2].set(xlabel="block-Jacobi PCG iterations", ylabel="share of matrices", ylim=(0, 1.02))
    style.log_if_decades(axes[0])
    if axes[0].get_yscale() == "log":
        axes[1].set_xscale("log")
    style.keep_span(axes[0])
    style.keep_span(axes[1], "x")
    style.keep_span(axes[2], "x")
    style.letter_panels(axes)
    if not axes[2].lines:
        style.not_measured(axes[2])
    fig.suptitle(f"{group}: work of every step and of every diagnosed matrix", fontsize=8)
    style.legend_below(fig, axes[0], runs)
    columns = ["group", "what", "series", "at", "count"]
    table = pd.concat(numbers).assign(group=group)[columns] if numbers else pd.DataFrame(columns=columns)
    return style.save(fig, out / f"iterations_{group}", table, f"{SHOWN.format(group=group)} {style.marker_sentence(runs)}", runs)
