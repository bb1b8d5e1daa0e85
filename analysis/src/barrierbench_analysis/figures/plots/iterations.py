"""Work of a run: Newton iterations of each step, their distribution, and PCG iterations on each diagnosed
matrix.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.tables import series
from barrierbench_analysis.tables.records import Records

SHOWN = (
    "{group}: (a) Newton iterations of every time step; (b) the share of time steps that took at most so"
    " many; (c) the share of diagnosed Newton matrices on which block-Jacobi preconditioned conjugate"
    " gradients (PCG), started from zero on one fixed right-hand side, took at most so many iterations to a"
    " relative residual of 1e-6."
)
COLUMNS = ["group", "what", "series", "at", "count"]


def _ecdf(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners of the share of values that are at most x, from 0 on; to be drawn with steps-post."""
    x = np.sort(values)
    return np.concatenate([x[:1], x]), np.arange(len(x) + 1) / max(1, len(x))


def _rows_of(table: pd.DataFrame, run: str) -> pd.DataFrame:
    return table[table["run"] == run] if not table.empty else table


def _draw_run(axes, records: Records, row: pd.Series) -> list[pd.DataFrame]:
    """The run's line in every panel; the numbers."""
    steps, trace = _rows_of(records.steps, row["run"]), _rows_of(records.trace, row["run"])
    numbers = []
    if not steps.empty:
        newton = steps["newton_iterations"].to_numpy()
        style.draw(axes[0], steps["t_s"].to_numpy(), newton, row, steps="steps-mid")
        style.draw(axes[1], *_ecdf(newton), row, end_mark=False, steps="steps-post")
        numbers.append(
            pd.DataFrame(
                {"what": "newton_per_step", "series": row["series"], "at": steps["t_s"], "count": newton}
            )
        )
    probes = trace[trace["probe_pcg_iterations"].notna()] if not trace.empty else trace
    if not probes.empty:
        pcg = probes["probe_pcg_iterations"].to_numpy(dtype=float)
        style.draw(axes[2], *_ecdf(pcg), row, end_mark=False, steps="steps-post")
        numbers.append(
            pd.DataFrame({"what": "probe_pcg", "series": row["series"], "at": probes["n"], "count": pcg})
        )
    return numbers


def _set_axes(axes) -> None:
    axes[0].set(xlabel="time (s)", ylabel="Newton iterations")
    axes[1].set(xlabel="Newton iterations of a step", ylabel="share of steps", ylim=(0, 1.02))
    axes[2].set(xlabel="block-Jacobi PCG iterations", ylabel="share of matrices", ylim=(0, 1.02))
    axes[0].locator_params(axis="x", nbins=4)
    style.log_if_decades(axes[0])
    if axes[0].get_yscale() == "log":
        axes[1].set_xscale("log")
    style.keep_span(axes[0])
    style.keep_span(axes[1], "x")
    style.keep_span(axes[2], "x")
    style.letter_panels(axes)
    if not axes[2].lines:
        style.not_measured(axes[2])


def figure(records: Records, group: str, out: Path, name: str = "") -> list[Path]:
    """`name` (iterations_GROUP), and its supplement where there are more series than one figure holds."""
    runs, paths, name = style.runs_of(records.runs, group), [], name or f"iterations_{group}"
    for part, some in series.parts_of_runs(runs, name):
        fig, axes = plt.subplots(1, 3, figsize=(style.WIDE_IN, 3.2), layout="constrained")
        numbers = [table for _, row in some.iterrows() for table in _draw_run(axes, records, row)]
        _set_axes(axes)
        fig.suptitle(f"{group}: work of every step and of every diagnosed matrix", fontsize=8)
        style.legend_below(fig, axes[0], runs)
        table = pd.concat(numbers).assign(group=group)[COLUMNS] if numbers else pd.DataFrame(columns=COLUMNS)
        shown = " ".join(filter(None, [SHOWN.format(group=group), part.says, style.marker_sentence(runs)]))
        paths += style.save(fig, out / f"{name}{part.suffix}", table, shown, some)
    return paths
