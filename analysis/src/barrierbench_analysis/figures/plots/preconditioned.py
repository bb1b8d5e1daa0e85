"""Conditioning of the preconditioned matrix against the iterations that conjugate gradients take on it."""

from __future__ import annotations

import math
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.tables.records import Records, condition_of

from .drawing import OF_RUNS, Drawing, common, formulations, outcomes
from .subjects import SweepRecords

TOLERANCE = 1e-6  # of the probe: relative residual
SHOWN = (
    "A point is a diagnosed Newton matrix: condition number scaled by block Jacobi (across) and iterations of"
    " conjugate gradients with the same preconditioner to a relative residual of 1e-6 on one right-hand side"
    " (up). Grey line: sqrt(cond)/2 ln(2/1e-6), the bound of the theory for the energy norm of the error."
    " Rank correlation of Spearman: {ranks}."
)


def bound(cond: np.ndarray) -> np.ndarray:
    """Iterations after which the error of conjugate gradients has fallen to TOLERANCE, at most."""
    return np.sqrt(cond) / 2 * math.log(2 / TOLERANCE)


def table(records: Records) -> pd.DataFrame:
    """A row a matrix that has both numbers."""
    parts = []
    for _, row in records.runs.iterrows():
        found = condition_of(records, row["run"], "block_jacobi")
        found = found[found["status"] == "ok"]
        trace = records.trace[records.trace["run"] == row["run"]]
        probes = trace[["n", "probe_pcg_iterations"]].dropna()
        both = found.merge(probes, on="n")[["step", "iteration", "cond", "probe_pcg_iterations"]]
        parts.append(both.assign(formulation=row["formulation"], run=row["run"], outcome=row["outcome"]))
    return pd.concat(parts, ignore_index=True)


def ranks(found: pd.DataFrame) -> dict[str, float]:
    """Formulation -> Spearman's correlation of its points; left out where it has fewer than 3."""
    of = {
        name: mine["cond"].rank().corr(mine["probe_pcg_iterations"].rank())
        for name, mine in found.groupby("formulation", sort=False)
        if len(mine) >= 3
    }
    return {name: value for name, value in of.items() if value == value}


def draw(axis, found: pd.DataFrame) -> None:
    for name in formulations(found):
        mine, look = found[found["formulation"] == name], style.look(name)
        axis.plot(
            mine["cond"],
            mine["probe_pcg_iterations"],
            linestyle="none",
            marker=look.marker,
            color=look.color,
            markersize=3,
            alpha=0.55,
            markeredgewidth=0,
            label=name,
        )
    low, high = found["cond"].min(), found["cond"].max()
    across = np.geomspace(low, max(high, 1.01 * low), 50)
    axis.set(xscale="log", yscale="log")
    axis.autoscale(False)
    top = 1.5 * found["probe_pcg_iterations"].max()
    axis.set_ylim(found["probe_pcg_iterations"].min() / 1.3, top)
    axis.plot(across, bound(across), color="#888888", linewidth=0.8, gid=style.REFERENCE)


def figure(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    records = subject.records
    numbers = table(records) if not records.cond.empty else pd.DataFrame()
    if numbers.empty:
        raise drawing.nothing("no run has condition numbers and PCG iterations of the same matrices")
    fig, axis = plt.subplots(figsize=(drawing.width_in, 3.2), layout="constrained")
    draw(axis, numbers)
    axis.set(xlabel="condition number, block Jacobi", ylabel="PCG iterations")
    style.legend_below(fig, axis)
    counts = ", ".join(
        f"{name} {n}" for name, n in numbers["formulation"].value_counts().sort_index().items()
    )
    facts = Facts(
        f"{len(numbers)} matrices ({counts}) of {outcomes(records.runs)}",
        "none: every matrix with both numbers is drawn",
        "the bound of the theory",
        common(records.runs, OF_RUNS),
    )
    words = ", ".join(f"{name} {value:.2f}" for name, value in ranks(numbers).items()) or "too few points"
    return drawing.save(fig, numbers, SHOWN.format(ranks=words), facts, records.runs)
