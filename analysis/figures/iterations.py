"""Work of a run: Newton iterations of each step, their distribution, and PCG iterations of each solve."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from analysis import style
from analysis.load import Records


def _ecdf(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    x = np.sort(values)
    return x, np.arange(1, len(x) + 1) / max(1, len(x))


def _rows_of(table: pd.DataFrame, run: str) -> pd.DataFrame:
    return table[table["run"] == run] if not table.empty else table


def figure(records: Records, group: str, out: Path) -> list[Path]:
    runs = records.runs[records.runs["group"] == group]
    fig, axes = plt.subplots(1, 3, figsize=(style.WIDE_IN, 2.6), layout="constrained")
    numbers = []
    for _, row in runs.iterrows():
        steps, trace = _rows_of(records.steps, row["run"]), _rows_of(records.trace, row["run"])
        if not steps.empty:
            newton = steps["newton_iterations"].to_numpy()
            style.draw(axes[0], steps["step"].to_numpy(), newton, row)
            style.draw(axes[1], *_ecdf(newton), row)
            numbers.append(pd.DataFrame({"what": "newton_per_step", "series": row["series"], "at": steps["step"], "count": newton}))
        if not trace.empty and (trace["linear_iterations"] > 0).any():
            pcg = trace["linear_iterations"].to_numpy()
            style.draw(axes[2], *_ecdf(pcg), row)
            numbers.append(pd.DataFrame({"what": "pcg_per_solve", "series": row["series"], "at": trace["n"], "count": pcg}))
    axes[0].set(xlabel="time step", ylabel="Newton iterations")
    axes[1].set(xlabel="Newton iterations of a step", ylabel="share of steps", ylim=(0, 1.02))
    axes[2].set(xlabel="PCG iterations of a solve", ylabel="share of solves", ylim=(0, 1.02))
    if not axes[2].lines:
        style.not_measured(axes[2], "direct solver")
    fig.suptitle(f"{group}: every step, every solve", fontsize=8)
    style.legend_below(fig, axes[0])
    columns = ["group", "what", "series", "at", "count"]
    table = pd.concat(numbers).assign(group=group)[columns] if numbers else pd.DataFrame(columns=columns)
    return style.save(fig, out / f"iterations_{group}", table)
