"""All eigenvalues of selected matrices: which share of them is at most so large."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from barrierbench_analysis.figures.captions import Facts

from .drawing import Drawing
from .subjects import Spectrum

# Matrices are no formulations, and have looks of their own (Okabe-Ito).
LOOKS = (
    ("#0072B2", "-"),
    ("#D55E00", "--"),
    ("#009E73", "-."),
    ("#CC79A7", (0, (5, 1))),
    ("#000000", ":"),
    ("#E69F00", (0, (3, 1, 1, 1))),
)
SHOWN = (
    "Newton matrices of results/matrices: the share of the eigenvalues that are at most so large. Conjugate"
    " gradients take about one iteration for an eigenvalue that stands alone, at either end; many eigenvalues"
    " spread over decades cost them more. {below}"
)


def ecdf(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of the values above 0, rising, the share of all values that are at most so large."""
    good = values > 0
    share = np.arange(1, len(values) + 1) / len(values)
    return values[good], share[good]


def draw(axis, found: list[Spectrum]) -> None:
    for (color, dash), one in zip(LOOKS, found):
        x, y = ecdf(one.values)
        label = f"{one.name} ({len(one.values)} rows)"
        axis.plot(x, y, drawstyle="steps-post", color=color, linestyle=dash, label=label)
    axis.set(xscale="log", ylim=(0, 1.02))


def figure(subject: list[Spectrum], drawing: Drawing) -> list[Path]:
    if len(subject) > len(LOOKS):
        raise drawing.nothing(f"{len(subject)} matrices; at most {len(LOOKS)} in one figure")
    if not any((one.values > 0).any() for one in subject):
        raise drawing.nothing("no matrix has a positive eigenvalue")
    fig, axis = plt.subplots(figsize=(drawing.width_in, 3.4), layout="constrained")
    draw(axis, subject)
    axis.set(xlabel="eigenvalue (N/m)", ylabel="share of the eigenvalues")
    handles, labels = axis.get_legend_handles_labels()
    fig.legend(
        handles, labels, loc="outside lower center", ncols=1 if drawing.width_in < 5 else 2, frameon=False
    )
    below = {one.name: int((one.values <= 0).sum()) for one in subject}
    words = ", ".join(f"{name} {n}" for name, n in below.items() if n)
    numbers = pd.concat(
        [
            pd.DataFrame({"matrix": one.name, "eigenvalue_N_per_m": one.values}).assign(
                share=np.arange(1, len(one.values) + 1) / len(one.values)
            )
            for one in subject
        ],
        ignore_index=True,
    )
    of = "; ".join(
        f"{one.name}: {one.about.get('formulation', '?')} in {one.about.get('scene', '?')}, cond"
        f" {one.values[-1] / one.values[0]:.2g}"
        if one.values[0] > 0
        else f"{one.name}: not positive definite"
        for one in subject
    )
    facts = Facts(
        f"{len(numbers)} eigenvalues of {len(subject)} matrices, all of them, dense",
        "empirical distribution",
        "none",
        of,
    )
    shown = SHOWN.format(below=f"Eigenvalues of at most 0, which are on no axis: {words}." if words else "")
    return drawing.save(fig, numbers, shown, facts)
