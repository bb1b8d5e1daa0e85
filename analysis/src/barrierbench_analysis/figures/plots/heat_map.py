"""Which runs of a grid of two settings get through: a cell a pair of settings with a letter for the outcome,
and how large a step every formulation gets through with.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.colors import LogNorm

from barrierbench_analysis.figures import panels, style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.io import fields
from barrierbench_analysis.tables.robustness import Trial, frontier

from .drawing import NAMES, Drawing, SweepRecords, common, each, formulations, outcomes

OPTIONS = {
    "x": "/time/dt_s",
    "y": "/scene/youngs_N_per_m",
    "x_label": "time step (s)",
    "y_label": "Young's modulus x thickness (N/m)",
}
WORDS = tuple(fields.schema("run")["$defs"]["Status"]["properties"]["outcome"]["enum"])
LETTERS = dict(
    word.split(":")
    for word in (
        "ok:o invalid_scene:V given_parts_cross:G initial_intersection:X pin_infeasible:F kernel_failed:K"
        " penetration:P unproven:U nan:N ccd_cap:C stall_overload:S newton_stall:I linear_failure:L not_pd:D"
        " timeout:T oom:M"
    ).split()
)
FAILED = "#bdbdbd"
APART = 1.035  # factor between lines of two formulations, which often lie on one another
SHOWN = (
    "A cell is {x} (across) and {y} (up); its letter the outcome: {letters}; a number behind a letter: so"
    " many of the {n} runs of the cell ended so, where not all did. Colour: Newton iterations a step where"
    " every run ends ok; grey, hatched: some run failed."
)
REACHED = (
    "The largest {x} up to which every run of every smaller one ends ok, over {y}; lines are drawn a little"
    " apart. An arrow upwards: the largest that was tried, the end is not known. A cross: some run fails at"
    " the smallest one. Dotted: what was tried."
)


def _cell(runs: pd.DataFrame) -> tuple[str, float]:
    """Of the runs of one pair of settings: the letter of the outcome that comes first in the order of the
    schema, with how many of the runs it is of where not all; and Newton iterations a step, the mean of the
    runs, nan where one failed.
    """
    bad = runs.loc[runs["outcome"] != "ok", "outcome"]
    if bad.empty:
        return LETTERS["ok"], float((runs["newton_iterations"] / runs["steps"]).mean())
    worst = min(bad, key=lambda word: WORDS.index(word) if word in WORDS else len(WORDS))
    count = int((bad == worst).sum())
    return LETTERS.get(worst, "?") + (f"{count}" if count < len(runs) else ""), np.nan


def table(runs: pd.DataFrame, x: str, y: str) -> pd.DataFrame:
    """A row a formulation and cell that was run."""
    rows = []
    for (formulation, at_x, at_y), of_cell in runs.groupby(["formulation", x, y], sort=True):
        letter, iterations = _cell(of_cell)
        words = " ".join(of_cell["outcome"])
        rows.append(
            {"formulation": formulation, "x": at_x, "y": at_y, "letter": letter, "iterations": iterations}
            | {"runs": len(of_cell), "outcomes": words}
        )
    return pd.DataFrame(rows)


def draw(axis, cells: pd.DataFrame, norm: LogNorm):
    """One formulation; the picture, for a colour bar. A cell that was not run is white and empty."""
    across, up = sorted(cells["x"].unique()), sorted(cells["y"].unique())
    grid = cells.pivot(index="y", columns="x", values="iterations").reindex(index=up, columns=across)
    picture = axis.imshow(grid.to_numpy(), origin="lower", aspect="auto", cmap="cividis", norm=norm)
    hatched = {"facecolor": FAILED, "edgecolor": "white", "hatch": "////", "linewidth": 0}
    for row in cells.itertuples():
        i, j, failed = up.index(row.y), across.index(row.x), np.isnan(row.iterations)
        if failed:
            axis.add_patch(plt.Rectangle((j - 0.5, i - 0.5), 1, 1, **hatched))
        color = "white" if not failed and norm(row.iterations) < 0.5 else "black"
        weight = "bold" if failed else "normal"
        axis.text(j, i, row.letter, ha="center", va="center", fontsize=7, fontweight=weight, color=color)
    axis.set_xticks(range(len(across)), [f"{v:g}" for v in across], fontsize=5.5)
    axis.set_yticks(range(len(up)), [f"{v:g}" for v in up], fontsize=6)
    axis.grid(False)
    return picture


def _label_edges(axes, options: dict) -> None:
    for k, axis in enumerate(axes):
        place = axis.get_subplotspec()
        if place.is_first_col():
            axis.set_ylabel(options["y_label"], fontsize=7)
        if len(axes) <= k + place.get_gridspec().ncols:  # nothing stands below it
            axis.set_xlabel(options["x_label"], fontsize=7)
            axis.tick_params(labelbottom=True)


def _runs_of(subject: SweepRecords, drawing: Drawing) -> pd.DataFrame:
    runs, x, y = subject.records.runs, drawing.options["x"], drawing.options["y"]
    if runs.empty or not {x, y} <= set(runs):
        raise drawing.nothing(f"no run has {x} and {y}")
    return runs


def figure(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    """A panel a formulation, a cell a pair of settings."""
    runs, options = _runs_of(subject, drawing), drawing.options
    cells, names = table(runs, options["x"], options["y"]), formulations(runs)
    most = max(2.0, np.nanmax(cells["iterations"], initial=0.0))
    norm = LogNorm(max(0.5, np.nanmin(cells["iterations"], initial=most / 2)), most)
    fig, axes = panels.grid(len(names), drawing.width_in, 2.2, most=3, sharex=True, sharey=True)
    for axis, name in zip(axes, names):
        picture = draw(axis, cells[cells["formulation"] == name], norm)
        axis.set_title(name, fontsize=7)
    _label_edges(axes, options)
    style.letter_panels(axes)
    fig.colorbar(picture, ax=axes, shrink=0.8).set_label("Newton iterations a step")
    used = [word for word in WORDS if word in set(runs["outcome"])]
    n, letters = int(cells["runs"].max()), ", ".join(f"{LETTERS.get(word, '?')} {word}" for word in used)
    kappa = common(runs, "matching_rule matching_load_N").removeprefix(NAMES["matching_rule"]).strip()
    facts = Facts(
        f"{outcomes(runs)}; {n} a cell",
        "mean of Newton iterations over steps",
        "none",
        common(runs, "scene scene_free_dofs d_hat_m") + f"; kappa: by {kappa}",
    )
    shown = SHOWN.format(x=options["x_label"], y=options["y_label"], n=n, letters=letters)
    return drawing.save(fig, cells, shown, facts, runs)


# --- the frontier


def reached(runs: pd.DataFrame, x: str, y: str) -> pd.DataFrame:
    """A row a formulation and value of y: `reached`, nan where not even the smallest x; `fails_at`, the next
    one, nan where none was tried.
    """
    rows = []
    for (formulation, at), some in runs.groupby(["formulation", y], sort=True):
        tried = [
            Trial(str(row.run), float(value), row.outcome == "ok", 0.0)
            for row, value in zip(some.itertuples(), some[x])
        ]
        found = frontier(tried, min(t.value for t in tried))
        rows.append(
            {"formulation": formulation, "y": at, "reached": found.high, "fails_at": found.fails_above}
            | {"tried": len({t.value for t in tried}), "runs": len(tried)}
        )
    return pd.DataFrame(rows).astype({"reached": float, "fails_at": float})


def _draw_reached(axis, found: pd.DataFrame, tried: list[float]) -> None:
    low, count = min(tried), found["formulation"].nunique()
    for value in tried:
        axis.axhline(value, color="#999999", linewidth=0.4, linestyle=":", gid=style.REFERENCE)
    for k, name, mine, look in each(found, "y"):
        shift = APART ** (k - (count - 1) / 2)
        axis.plot(mine["y"], mine["reached"] * shift, **look.line(alpha=0.9, label=name))
        arrow = {"arrowstyle": "->", "color": look.color, "linewidth": 0.8}
        for row in mine.itertuples():
            if np.isnan(row.reached):
                style.draw_failure(axis, row.y, low / 1.35 * shift, look.color)
            elif np.isnan(row.fails_at):
                at = row.reached * shift
                axis.annotate("", (row.y, at * 1.3), (row.y, at), arrowprops=arrow)
    axis.set(xscale="log", yscale="log", ylim=(low / 1.7, max(tried) * 1.6))


def success_frontier(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    """A line a formulation: up to where it gets through."""
    runs, options = _runs_of(subject, drawing), drawing.options
    found = reached(runs, options["x"], options["y"])
    fig, axes = drawing.panels(1, 2.9)
    _draw_reached(axes[0], found, sorted(runs[options["x"]].unique()))
    axes[0].set(xlabel=options["y_label"], ylabel=f"largest {options['x_label']}")
    facts = Facts(
        outcomes(runs),
        "largest value with all runs ok, from the smallest on",
        "the values that were tried",
        common(runs, "scene scene_free_dofs d_hat_m"),
    )
    shown = REACHED.format(x=options["x_label"], y=options["y_label"])
    return drawing.finish(fig, axes, found, shown, facts, runs=runs)
