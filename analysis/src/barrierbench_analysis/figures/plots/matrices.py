"""Figures of single matrices: all eigenvalues of selected ones, and conditioning against the iterations of
conjugate gradients.
"""

import math
from pathlib import Path

import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.tables.records import Records, condition_of

from .drawing import Drawing, Spectrum, SweepRecords, about, common, each, outcomes

# Matrices are no formulations, and have looks of their own (Okabe-Ito).
LOOKS = (
    ("#0072B2", "-"),
    ("#D55E00", "--"),
    ("#009E73", "-."),
    ("#CC79A7", (0, (5, 1))),
    ("#000000", ":"),
    ("#E69F00", (0, (3, 1, 1, 1))),
)
TOLERANCE = 1e-6  # of the probe: relative residual
EIGENVALUES = (
    "Newton matrices of results/matrices: the share of the eigenvalues that are at most so large. Conjugate"
    " gradients take about one iteration for an eigenvalue that stands alone, at either end; many eigenvalues"
    " spread over decades cost them more. {below}"
)
PRECONDITIONED = (
    "A point is a diagnosed Newton matrix: condition number scaled by block Jacobi (across) and iterations of"
    " conjugate gradients with the same preconditioner to a relative residual of 1e-6 on one right-hand side"
    " (up). Grey line: sqrt(cond)/2 ln(2/1e-6), the bound of the theory for the energy norm of the error."
    " Rank correlation of Spearman: {ranks}."
)


# --- all eigenvalues


def ecdf(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of the values above 0, rising, the share of all values that are at most so large."""
    good = values > 0
    return values[good], _shares(values)[good]


def _shares(values: np.ndarray) -> np.ndarray:
    return np.arange(1, len(values) + 1) / len(values)


def _of(one: Spectrum) -> str:
    if one.values[0] <= 0:
        return f"{one.name}: not positive definite"
    where = f"{one.about.get('formulation', '?')} in {one.about.get('scene', '?')}"
    return f"{one.name}: {where}, cond {one.values[-1] / one.values[0]:.2g}"


def eigenvalues(subject: list[Spectrum], drawing: Drawing) -> list[Path]:
    if len(subject) > len(LOOKS):
        raise drawing.nothing(f"{len(subject)} matrices; at most {len(LOOKS)} in one figure")
    if not any((one.values > 0).any() for one in subject):
        raise drawing.nothing("no matrix has a positive eigenvalue")
    fig, (axis,) = drawing.panels(1, 3.4)
    for (color, dash), one in zip(LOOKS, subject):
        label = f"{one.name} ({len(one.values)} rows)"
        axis.plot(*ecdf(one.values), drawstyle="steps-post", color=color, linestyle=dash, label=label)
    axis.set(xscale="log", ylim=(0, 1.02), xlabel="eigenvalue (N/m)", ylabel="share of the eigenvalues")
    columns = 1 if drawing.width_in < 5 else 2
    fig.legend(*axis.get_legend_handles_labels(), loc="outside lower center", ncols=columns, frameon=False)
    counts = ((one.name, int((one.values <= 0).sum())) for one in subject)
    words = ", ".join(f"{name} {n}" for name, n in counts if n)
    tables = [
        pd.DataFrame({"matrix": one.name, "eigenvalue_N_per_m": one.values, "share": _shares(one.values)})
        for one in subject
    ]
    numbers = pd.concat(tables, ignore_index=True)
    n = f"{len(numbers)} eigenvalues of {len(subject)} matrices, all of them, dense"
    facts = Facts(n, "empirical distribution", "none", "; ".join(map(_of, subject)))
    below = f"Eigenvalues of at most 0, which are on no axis: {words}." if words else ""
    return drawing.save(fig, numbers, EIGENVALUES.format(below=below), facts)


# --- conditioning and iterations


def bound(cond: np.ndarray) -> np.ndarray:
    """Iterations after which the error of conjugate gradients has fallen to TOLERANCE, at most."""
    return np.sqrt(cond) / 2 * math.log(2 / TOLERANCE)


def table(records: Records) -> pd.DataFrame:
    """A row a matrix that has both numbers."""
    parts = []
    for _, row in records.runs.iterrows():
        found = condition_of(records, row["run"], "block_jacobi")
        trace = records.trace[records.trace["run"] == row["run"]]
        probes = trace[["n", "probe_pcg_iterations"]].dropna()
        both = found[found["status"] == "ok"].merge(probes, on="n")
        parts.append(both[["step", "iteration", "cond", "probe_pcg_iterations"]].assign(**about(row)))
    return pd.concat(parts, ignore_index=True)


def ranks(found: pd.DataFrame) -> dict[str, float]:
    """Formulation -> Spearman's correlation of its points; left out where it has fewer than 3."""
    of = {
        name: mine["cond"].rank().corr(mine["probe_pcg_iterations"].rank())
        for name, mine in found.groupby("formulation", sort=False)
        if len(mine) >= 3
    }
    return {name: value for name, value in of.items() if value == value}


def preconditioned(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    records = subject.records
    found = table(records) if not records.cond.empty else pd.DataFrame()
    if found.empty:
        raise drawing.nothing("no run has condition numbers and PCG iterations of the same matrices")
    fig, axes = drawing.panels(1, 3.2)
    for _, name, mine, look in each(found):
        line = look.line(linestyle="none", markersize=3, alpha=0.55, markeredgewidth=0, label=name)
        axes[0].plot(mine["cond"], mine["probe_pcg_iterations"], **line)
    low, high, counts = found["cond"].min(), found["cond"].max(), found["probe_pcg_iterations"]
    across = np.geomspace(low, max(high, 1.01 * low), 50)
    axes[0].set(xscale="log", yscale="log", xlabel="condition number, block Jacobi", ylabel="PCG iterations")
    axes[0].autoscale(False)
    axes[0].set_ylim(counts.min() / 1.3, 1.5 * counts.max())
    axes[0].plot(across, bound(across), color="#888888", linewidth=0.8, gid=style.REFERENCE)
    of_each = ", ".join(f"{name} {n}" for name, n in found["formulation"].value_counts().sort_index().items())
    facts = Facts(
        f"{len(found)} matrices ({of_each}) of {outcomes(records.runs)}",
        "none: every matrix with both numbers is drawn",
        "the bound of the theory",
        common(records.runs),
    )
    words = ", ".join(f"{name} {value:.2f}" for name, value in ranks(found).items()) or "too few points"
    return drawing.finish(fig, axes, found, PRECONDITIONED.format(ranks=words), facts, runs=records.runs)
