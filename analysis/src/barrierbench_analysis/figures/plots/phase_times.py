"""What a run spends its time on: stacked bars of phases."""

import itertools
from pathlib import Path

import numpy as np
import pandas as pd

from barrierbench_analysis.figures.captions import Facts

from .drawing import Drawing, SweepRecords, common, formulations, outcomes

OPTIONS = {"level": "/scene/n", "per": "newton_iterations"}
PHASES = {  # name -> columns of a record without `time_` and `_s`, colour (Okabe-Ito), hatch
    "elasticity": (("elastic",), "#56B4E9", ""),
    "strain limit": (("strain_limit", "strain_bound"), "#F0E442", ""),
    "contact pairs": (("broad_phase", "contact_rows"), "#D55E00", "\\\\\\"),
    "barrier": (("stiffness", "contact_terms"), "#E69F00", ""),
    "assembly": (("assembly",), "#999999", "..."),
    "linear system": (("linear_analyze", "linear_factor", "linear_solve"), "#0072B2", "///"),
    "CCD": (("step_bound",), "#009E73", ""),
    "line search": (("line_search",), "#CC79A7", "xxx"),
    "end check": (("end_check",), "#000000", "||"),
    "rest": (("prediction", "step_control"), "#DDDDDD", ""),
}
SHOWN = (
    "Milliseconds of processor time on a clock of the program, a Newton iteration, by phase; without output"
    " and diagnosis. Each bar is one run of the largest size of the sweep; behind its name its linear solver."
    " A bar with an outcome on it is of a run that failed, up to where it failed. Times are of one machine."
)


def table(runs: pd.DataFrame) -> pd.DataFrame:
    """A row a run and phase: ms a Newton iteration."""
    rows = []
    for _, row in runs.iterrows():
        for phase, (columns, _, _) in PHASES.items():
            seconds = pd.to_numeric(
                row[[f"time_{column}_s" for column in columns]]
            ).sum()  # nan: no such phase
            rows.append(
                {"formulation": row["formulation"], "solver": row["linear_solver"], "phase": phase}
                | {"outcome": row["outcome"], "unknowns": row["scene_free_dofs"], "seconds": seconds}
                | {"ms_an_iteration": 1e3 * seconds / max(1, row["newton_iterations"])}
            )
    return pd.DataFrame(rows)


def draw(axis, found: pd.DataFrame) -> None:
    solvers = list(dict.fromkeys(found["solver"]))
    keys = ["formulation", "solver"]
    there = set(found[keys].itertuples(index=False, name=None))
    bars = [bar for bar in itertools.product(formulations(found), solvers) if bar in there]
    left = np.zeros(len(bars))
    for phase, (_, color, hatch) in PHASES.items():
        widths = found[found["phase"] == phase].set_index(keys)["ms_an_iteration"].loc[bars].to_numpy(float)
        how = {"color": color, "hatch": hatch, "edgecolor": "white", "linewidth": 0.3, "height": 0.75}
        axis.barh(range(len(bars)), widths, left=left, label=phase, **how)
        left = left + widths
    outcome = found.drop_duplicates(keys).set_index(keys)["outcome"]
    for k, bar in enumerate(bars):
        if outcome.loc[bar] != "ok":
            axis.text(left[k], k, f"  {outcome.loc[bar]}", va="center", fontsize=6)
    axis.set_yticks(range(len(bars)), [f"{name}, {solver}" for name, solver in bars])
    axis.invert_yaxis()
    axis.grid(axis="y", visible=False)


def figure(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    runs, level = subject.records.runs, drawing.options["level"]
    if level not in runs:
        raise drawing.nothing(f"no run has {level}")
    largest = runs[
        (runs[level] == runs[level].max()) & runs["solve_s"].notna() & (runs["newton_iterations"] > 0)
    ]
    if largest.empty:
        raise drawing.nothing(f"no run with {level} {runs[level].max():g} was timed (/passes/time)")
    numbers = table(largest)
    fig, (axis,) = drawing.panels(1, 0.9 + 0.24 * largest.shape[0])
    draw(axis, numbers)
    axis.set_xlabel("ms a Newton iteration")
    fig.legend(*axis.get_legend_handles_labels(), loc="outside lower center", ncols=5, frameon=False)
    facts = Facts(
        f"1 repetition of {outcomes(largest)}",
        "sum of a phase over the run / its Newton iterations",
        "none",
        f"{level} {largest[level].iloc[0]:g}, {common(largest, 'scene scene_free_dofs steps')}",
    )
    return drawing.save(fig, numbers, SHOWN, facts, largest)
