"""Time and iterations of conjugate gradients against the number of unknowns."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from barrierbench_analysis.figures import panels, style
from barrierbench_analysis.figures.captions import Facts

from . import slopes
from .drawing import Drawing, common, formulations, outcomes
from .subjects import SweepRecords

PANELS = (  # solver, column of table(), label
    ("cholmod", "ms_an_iteration", "ms a Newton iteration, direct"),
    ("pcg", "ms_an_iteration", "ms a Newton iteration, PCG"),
    ("pcg", "pcg_a_solve", "PCG iterations a solve"),
    ("cholmod", "newton_a_step", "Newton iterations a step, direct"),
    ("pcg", "newton_a_step", "Newton iterations a step, PCG"),
    ("pcg", "ms_outside", "ms a Newton iteration outside the solve, PCG"),
)
SOLVE = ("time_linear_factor_s", "time_linear_solve_s")  # with the set-up of a preconditioner
SHOWN = (
    "What a run takes against its unknowns, logarithmic, a panel each: {panels}. PCG is with the"
    " preconditioner of the runs; outside the solve: without its set-up either. The exponents are least"
    " squares over all sizes of a line: a number grows as unknowns to that power. Crosses at the upper edge:"
    " runs that failed. Times are of one machine, one thread."
)


def table(runs: pd.DataFrame) -> pd.DataFrame:
    """A row a run, numbers nan where it failed."""
    good = runs["outcome"] == "ok"
    iterations, solves = runs["newton_iterations"].where(good), runs["linear_solves"].where(good)
    seconds = pd.to_numeric(runs["solve_s"])
    outside = seconds - sum(pd.to_numeric(runs[column]) for column in SOLVE)
    return pd.DataFrame(
        {
            "formulation": runs["formulation"],
            "solver": runs["linear_solver"],
            "unknowns": runs["scene_free_dofs"],
            "outcome": runs["outcome"],
            "ms_an_iteration": 1e3 * seconds / iterations,
            "ms_outside": 1e3 * outside / iterations,
            "pcg_a_solve": pd.to_numeric(runs["linear_iterations"]) / solves,
            "newton_a_step": iterations / runs["steps"],
        }
    ).reset_index(drop=True)


def draw(axis, found: pd.DataFrame, column: str) -> dict[str, float | None]:
    """The lines of one solver; their slopes."""
    found_slopes = {}
    for row, name in enumerate(formulations(found)):
        mine = found[found["formulation"] == name].sort_values("unknowns")
        good = mine[np.isfinite(mine[column]) & (mine[column] > 0)]
        failed = mine.loc[mine["outcome"] != "ok", "unknowns"]
        slopes.draw(axis, good["unknowns"], good[column], name, failed, row)
        found_slopes[name] = slopes.slope(good["unknowns"], good[column])
    axis.set(xscale="log", yscale="log")
    style.keep_span(axis)
    low, high = axis.get_ylim()
    axis.set_ylim(low, high * (high / low) ** 0.45)  # room for the slopes
    slopes.note(axis, found_slopes)
    return found_slopes


def figure(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    runs = subject.records.runs
    numbers = table(runs)
    shown = [panel for panel in PANELS if numbers.loc[numbers["solver"] == panel[0], panel[1]].notna().any()]
    if not shown or numbers["unknowns"].nunique() < 2:
        raise drawing.nothing(f"fewer than two sizes with a run that ended ok ({outcomes(runs)})")
    fig, axes = panels.grid(len(shown), drawing.width_in, 2.4, most=2)
    rows = []
    for axis, (solver, column, label) in zip(axes, shown):
        found = draw(axis, numbers[numbers["solver"] == solver], column)
        axis.set(xlabel="unknowns", title=label)
        rows += [{"panel": label, "formulation": name, "slope": value} for name, value in found.items()]
    style.letter_panels(axes)
    style.legend_below(fig, axes[0])
    facts = Facts(
        f"1 repetition of {outcomes(runs)}; {numbers['unknowns'].nunique()} sizes",
        "means over the iterations, solves or steps of a run; slopes: least squares of logarithms",
        "none",
        common(runs, {"scene": "scene", "scene_free_dofs": "unknowns", "steps": "steps", "dt_s": "dt (s)"}),
    )
    both = pd.concat([numbers, pd.DataFrame(rows)], ignore_index=True)
    said = SHOWN.format(panels=", ".join(label for _, _, label in shown))
    return drawing.save(fig, both, said, facts, runs)
