"""Smallest gap at the end of each converged time step in units of d_hat."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from .. import style
from ..load import Records

SHOWN = "{group}: the smallest gap between any two surfaces at the end of each converged time step, in units of d_hat, the gap at which contact begins. Steps without contact have no point."


def _matched_at(runs: pd.DataFrame) -> float | None:
    """The gap / d_hat at which equal_force makes the forces of the formulations equal, if one rule holds for all that are matched."""
    if "matching_theta" not in runs:
        return None
    thetas = runs.loc[runs["matching_rule"] == "equal_force", "matching_theta"].dropna().unique()
    return float(thetas[0]) if len(thetas) == 1 else None


def figure(records: Records, group: str, out: Path) -> list[Path]:
    runs = style.runs_of(records.runs, group)
    fig, axis = plt.subplots(figsize=(5.6, 4.2), layout="constrained")
    numbers = []
    for _, row in runs.iterrows():
        steps = records.steps[records.steps["run"] == row["run"]] if not records.steps.empty else records.steps
        if steps.empty:
            continue
        touching = steps[pd.to_numeric(steps["gap_min_rel"]).notna()]
        style.draw(axis, touching["t_s"].to_numpy(), touching["gap_min_rel"].to_numpy(dtype=float), row)
        numbers.append(touching[["run", "step", "t_s", "gap_min_m", "gap_min_rel"]].assign(series=row["series"]))
    if numbers and any(len(table) for table in numbers):
        axis.set_yscale("log")
    else:
        style.not_measured(axis, "no contact")
    style.keep_span(axis)
    style.reference_line(axis, 1, r"$\hat d$: contact begins")
    if (theta := _matched_at(runs)) is not None:
        style.reference_line(axis, theta, rf"{theta:g} $\hat d$: forces are matched here", ":")
    axis.set(xlabel="time (s)", ylabel=r"smallest gap / $\hat d$", title=group)
    style.legend_below(fig, axis, runs)
    columns = ["group", "series", "run", "step", "t_s", "gap_min_m", "gap_min_rel"]
    table = pd.concat(numbers).assign(group=group)[columns] if numbers else pd.DataFrame(columns=columns)
    return style.save(fig, out / f"gaps_{group}", table, f"{SHOWN.format(group=group)} {style.marker_sentence(runs)}", runs)
