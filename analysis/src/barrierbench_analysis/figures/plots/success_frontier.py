"""How large a step every run gets through with, over a second setting."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.tables.robustness import Trial, frontier

from . import heat_map
from .drawing import Drawing, common, formulations, outcomes
from .subjects import SweepRecords

OPTIONS = heat_map.OPTIONS
APART = 1.035  # factor between lines of two formulations, which often lie on one another
SHOWN = (
    "The largest {x} up to which every run of every smaller one ends ok, over {y}; lines are drawn a little"
    " apart. An arrow upwards: the largest that was tried, the end is not known. A cross: some run fails at"
    " the smallest one. Dotted: what was tried."
)


def table(runs: pd.DataFrame, x: str, y: str) -> pd.DataFrame:
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


def draw(axis, found: pd.DataFrame, names: list[str], tried: list[float]) -> None:
    low = min(tried)
    for value in tried:
        axis.axhline(value, color="#999999", linewidth=0.4, linestyle=":", gid=style.REFERENCE)
    for k, name in enumerate(names):
        mine, look = found[found["formulation"] == name].sort_values("y"), style.look(name)
        shift = APART ** (k - (len(names) - 1) / 2)
        up = mine["reached"] * shift
        axis.plot(
            mine["y"], up, color=look.color, linestyle=look.dash, marker=look.marker, alpha=0.9, label=name
        )
        for row, at in zip(mine.itertuples(), up):
            if np.isnan(row.reached):
                style.draw_failure(axis, row.y, low / 1.35 * shift, look.color)
            elif np.isnan(row.fails_at):
                axis.annotate(
                    "",
                    (row.y, at * 1.3),
                    (row.y, at),
                    arrowprops={"arrowstyle": "->", "color": look.color, "linewidth": 0.8},
                )
    axis.set(xscale="log", yscale="log", ylim=(low / 1.7, max(tried) * 1.6))


def figure(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    runs, options = subject.records.runs, drawing.options
    if runs.empty or not {options["x"], options["y"]} <= set(runs):
        raise drawing.nothing(f"no run has {options['x']} and {options['y']}")
    found = table(runs, options["x"], options["y"])
    fig, axis = plt.subplots(figsize=(drawing.width_in, 2.9), layout="constrained")
    draw(axis, found, formulations(runs), sorted(runs[options["x"]].unique()))
    axis.set(xlabel=options["y_label"], ylabel=f"largest {options['x_label']}")
    style.legend_below(fig, axis)
    facts = Facts(
        outcomes(runs),
        "largest value with all runs ok, from the smallest on",
        "the values that were tried",
        common(runs, {"scene": "scene", "scene_free_dofs": "unknowns", "d_hat_m": "d_hat (m)"}),
    )
    shown = SHOWN.format(x=options["x_label"], y=options["y_label"])
    return drawing.save(fig, found, shown, facts, runs)
