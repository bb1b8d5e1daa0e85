"""Which runs of a grid get through: a cell a pair of settings, a letter an outcome, colour the iterations of
a step.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.colors import LogNorm

from barrierbench_analysis.figures import panels, style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.io import fields

from .drawing import Drawing, common, formulations, outcomes
from .subjects import SweepRecords

OPTIONS = {
    "x": "/time/dt_s",
    "y": "/scene/youngs_N_per_m",
    "x_label": "time step (s)",
    "y_label": "Young's modulus x thickness (N/m)",
}
WORDS = tuple(fields.schema("run")["$defs"]["Status"]["properties"]["outcome"]["enum"])
LETTERS = {
    "ok": "o",
    "invalid_scene": "V",
    "given_parts_cross": "G",
    "initial_intersection": "X",
    "pin_infeasible": "F",
    "kernel_failed": "K",
    "penetration": "P",
    "unproven": "U",
    "nan": "N",
    "ccd_cap": "C",
    "stall_overload": "S",
    "newton_stall": "I",
    "linear_failure": "L",
    "not_pd": "D",
    "timeout": "T",
    "oom": "M",
}
FAILED = "#bdbdbd"
SHOWN = (
    "A cell is {x} (across) and {y} (up); its letter the outcome: {letters}; a number behind a letter: so"
    " many of the {n} runs of the cell ended so, where not all did. Colour: Newton iterations a step where"
    " every run ends ok; grey, hatched: some run failed."
)


@dataclass(frozen=True)
class Cell:
    letter: str  # with how many of the runs it is of, where not all
    iterations: float  # Newton iterations a step, mean of the runs; nan where one failed


def cell(runs: pd.DataFrame) -> Cell:
    """Of the runs of one pair of settings: the outcome that comes first in the order of the schema."""
    rank = {word: k for k, word in enumerate(WORDS)}
    bad = runs[runs["outcome"] != "ok"]
    if bad.empty:
        return Cell(LETTERS["ok"], float((runs["newton_iterations"] / runs["steps"]).mean()))
    worst = min(bad["outcome"], key=lambda word: rank.get(word, len(rank)))
    count = int((bad["outcome"] == worst).sum())
    return Cell(LETTERS.get(worst, "?") + (f"{count}" if count < len(runs) else ""), np.nan)


def table(runs: pd.DataFrame, x: str, y: str) -> pd.DataFrame:
    """A row a formulation and cell that was run."""
    rows = []
    for (formulation, at_x, at_y), of_cell in runs.groupby(["formulation", x, y], sort=True):
        found = cell(of_cell)
        words = " ".join(of_cell["outcome"])
        rows.append(
            {"formulation": formulation, "x": at_x, "y": at_y, "letter": found.letter}
            | {"iterations": found.iterations, "runs": len(of_cell), "outcomes": words}
        )
    return pd.DataFrame(rows)


def draw(axis, cells: pd.DataFrame, norm: LogNorm):
    """One formulation; the picture, for a colour bar. A cell that was not run is white and empty."""
    across, up = sorted(cells["x"].unique()), sorted(cells["y"].unique())
    grid = cells.pivot(index="y", columns="x", values="iterations").reindex(index=up, columns=across)
    picture = axis.imshow(grid.to_numpy(), origin="lower", aspect="auto", cmap="cividis", norm=norm)
    for row in cells.itertuples():
        i, j, failed = up.index(row.y), across.index(row.x), np.isnan(row.iterations)
        if failed:
            axis.add_patch(
                plt.Rectangle(
                    (j - 0.5, i - 0.5), 1, 1, facecolor=FAILED, edgecolor="white", hatch="////", linewidth=0
                )
            )
        dark = not failed and norm(row.iterations) < 0.5
        axis.text(
            j,
            i,
            row.letter,
            ha="center",
            va="center",
            fontsize=7,
            fontweight="bold" if failed else "normal",
            color="white" if dark else "black",
        )
    axis.set_xticks(range(len(across)), [f"{v:g}" for v in across], fontsize=5.5)
    axis.set_yticks(range(len(up)), [f"{v:g}" for v in up], fontsize=6)
    axis.grid(False)
    return picture


def figure(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    runs, options = subject.records.runs, drawing.options
    if runs.empty or not {options["x"], options["y"]} <= set(runs):
        raise drawing.nothing(f"no run has {options['x']} and {options['y']}")
    cells = table(runs, options["x"], options["y"])
    names = formulations(runs)
    most = max(2.0, np.nanmax(cells["iterations"], initial=0.0))
    norm = LogNorm(max(0.5, np.nanmin(cells["iterations"], initial=most / 2)), most)
    fig, axes = panels.grid(len(names), drawing.width_in, 2.2, most=3, sharex=True, sharey=True)
    for axis, name in zip(axes, names):
        picture = draw(axis, cells[cells["formulation"] == name], norm)
        axis.set_title(name, fontsize=7)
    for axis in axes:
        place = axis.get_subplotspec()
        if place.is_first_col():
            axis.set_ylabel(options["y_label"], fontsize=7)
        below = place.rowspan.stop < place.get_gridspec().nrows
        if not below or len(names) <= axes.index(axis) + place.get_gridspec().ncols:
            axis.set_xlabel(options["x_label"], fontsize=7)
            axis.tick_params(labelbottom=True)
    style.letter_panels(axes)
    bar = fig.colorbar(picture, ax=axes, shrink=0.8)
    bar.set_label("Newton iterations a step")
    used = [word for word in WORDS if word in set(runs["outcome"])]
    shown = SHOWN.format(
        x=options["x_label"],
        y=options["y_label"],
        n=int(cells["runs"].max()),
        letters=", ".join(f"{LETTERS.get(word, '?')} {word}" for word in used),
    )
    facts = Facts(
        f"{outcomes(runs)}; {int(cells['runs'].max())} a cell",
        "mean of Newton iterations over steps",
        "none",
        common(runs, {"scene": "scene", "scene_free_dofs": "unknowns", "d_hat_m": "d_hat (m)"})
        + f"; kappa: {common(runs, {'matching_rule': 'by', 'matching_load_N': 'load (N)'})}",
    )
    return drawing.save(fig, cells, shown, facts, runs)
