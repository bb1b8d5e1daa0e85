"""What a run spends its time on: stacked bars of phases."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from barrierbench_analysis.figures.captions import Facts

from .drawing import Drawing, common, formulations, outcomes
from .subjects import SweepRecords

OPTIONS = {"level": "/scene/n", "per": "newton_iterations"}
SLICE = {"scene": "scene", "scene_free_dofs": "unknowns", "steps": "steps"}
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


def _seconds(value) -> float:
    """0 where a run has no such phase."""
    return 0.0 if pd.isna(value) else float(value)


def table(runs: pd.DataFrame) -> pd.DataFrame:
    """A row a run and phase: ms a Newton iteration."""
    rows = []
    for _, row in runs.iterrows():
        for phase, (columns, _, _) in PHASES.items():
            seconds = sum(_seconds(row[f"time_{column}_s"]) for column in columns)
            rows.append(
                {"formulation": row["formulation"], "solver": row["linear_solver"], "phase": phase}
                | {"outcome": row["outcome"], "unknowns": row["scene_free_dofs"], "seconds": seconds}
                | {"ms_an_iteration": 1e3 * seconds / max(1, row["newton_iterations"])}
            )
    return pd.DataFrame(rows)


def draw(axis, found: pd.DataFrame) -> None:
    bars = [
        (name, solver)
        for name in formulations(found)
        for solver in dict.fromkeys(found["solver"])
        if ((found["formulation"] == name) & (found["solver"] == solver)).any()
    ]
    left = [0.0] * len(bars)
    for phase, (_, color, hatch) in PHASES.items():
        of = found[found["phase"] == phase].set_index(["formulation", "solver"])["ms_an_iteration"]
        widths = [float(of.loc[bar]) for bar in bars]
        axis.barh(
            range(len(bars)),
            widths,
            left=left,
            color=color,
            hatch=hatch,
            edgecolor="white",
            linewidth=0.3,
            height=0.75,
            label=phase,
        )
        left = [a + b for a, b in zip(left, widths)]
    outcome = found.drop_duplicates(["formulation", "solver"]).set_index(["formulation", "solver"])["outcome"]
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
    fig, axis = plt.subplots(figsize=(drawing.width_in, 0.9 + 0.24 * largest.shape[0]), layout="constrained")
    draw(axis, numbers)
    axis.set_xlabel("ms a Newton iteration")
    handles, labels = axis.get_legend_handles_labels()
    fig.legend(handles, labels, loc="outside lower center", ncols=5, frameon=False)
    facts = Facts(
        f"1 repetition of {outcomes(largest)}",
        "sum of a phase over the run / its Newton iterations",
        "none",
        f"{level} {largest[level].iloc[0]:g}, {common(largest, SLICE)}",
    )
    return drawing.save(fig, numbers, SHOWN, facts, largest)
