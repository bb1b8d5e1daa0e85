"""Time and iterations of conjugate gradients against the number of unknowns."""

from pathlib import Path

import pandas as pd

from barrierbench_analysis.figures import panels
from barrierbench_analysis.figures.captions import Facts

from . import slopes
from .drawing import Drawing, SweepRecords, common, outcomes

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


def figure(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    runs = subject.records.runs
    numbers = table(runs)
    shown = [panel for panel in PANELS if numbers.loc[numbers["solver"] == panel[0], panel[1]].notna().any()]
    if not shown or numbers["unknowns"].nunique() < 2:
        raise drawing.nothing(f"fewer than two sizes with a run that ended ok ({outcomes(runs)})")
    fig, axes = panels.grid(len(shown), drawing.width_in, 2.4, most=2)
    rows = []
    for axis, (solver, column, label) in zip(axes, shown):
        of = slopes.draw(axis, numbers[numbers["solver"] == solver], "unknowns", column)
        low, high = axis.get_ylim()
        axis.set(
            xlabel="unknowns", title=label, ylim=(low, high * (high / low) ** 0.45)
        )  # room for the slopes
        slopes.note(axis, of)
        rows += [{"panel": label, "formulation": name, "slope": value} for name, value in of.items()]
    facts = Facts(
        f"1 repetition of {outcomes(runs)}; {numbers['unknowns'].nunique()} sizes",
        "means over the iterations, solves or steps of a run; slopes: least squares of logarithms",
        "none",
        common(runs, "scene scene_free_dofs steps dt_s"),
    )
    both = pd.concat([numbers, pd.DataFrame(rows)], ignore_index=True)
    words = SHOWN.format(panels=", ".join(label for _, _, label in shown))
    return drawing.finish(fig, axes, both, words, facts, runs=runs)
