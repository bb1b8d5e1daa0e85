"""Smallest gap at the end of each converged time step in units of d_hat."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from .. import style
from ..load import Records

MATCHED_AT = 0.1  # the gap at which equal_force makes the forces equal, d_hat


def figure(records: Records, group: str, out: Path) -> list[Path]:
    runs = records.runs[records.runs["group"] == group]
    fig, axis = plt.subplots(figsize=(4.8, 3.2), layout="constrained")
    numbers = []
    for _, row in runs.iterrows():
        steps = records.steps[records.steps["run"] == row["run"]] if not records.steps.empty else records.steps
        if steps.empty:
            continue
        touching = steps[pd.to_numeric(steps["gap_min_rel"]).notna()]
        style.draw(axis, touching["t_s"].to_numpy(), touching["gap_min_rel"].to_numpy(dtype=float), row)
        numbers.append(touching[["run", "step", "t_s", "gap_min_m", "gap_min_rel"]].assign(series=row["series"]))
    axis.axhline(1, color="#666666", linewidth=0.5)
    axis.axhline(MATCHED_AT, color="#666666", linewidth=0.5, linestyle=":")
    if numbers and any(len(table) for table in numbers):
        axis.set_yscale("log")
    else:
        style.not_measured(axis, "no contact")
    axis.set(xlabel="time (s)", ylabel=r"smallest gap at the end of the step / $\hat d$", title=group)
    style.legend_below(fig, axis, runs)
    columns = ["group", "series", "run", "step", "t_s", "gap_min_m", "gap_min_rel"]
    table = pd.concat(numbers).assign(group=group)[columns] if numbers else pd.DataFrame(columns=columns)
    return style.save(fig, out / f"gaps_{group}", table)
