"""Error against work over the time step: each formulation against its own run at the smallest step."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from .. import style
from ..captions import Facts
from ..frames import frame_of
from ..run import Run
from . import slopes
from .drawing import Drawing, common, formulations, outcomes
from .subjects import SweepRecords

SHOWN = (
    "Distance of vertices at the end of the run from the same formulation at the smallest time step, root"
    " mean square over vertices, over the size of the scene, against what the run took; each line goes over"
    " the time step, which is written beside its points (ms). The smallest step is the reference and is not"
    " drawn. Left: Newton iterations. Right: seconds of one thread. Runs that failed are not drawn."
)
COST = (("newton_iterations", "Newton iterations"), ("solve_s", "seconds"))


def end(run: Run) -> np.ndarray:
    """[n, 3] m, after the last step. Errors: UserError where its frame is not kept."""
    return frame_of(run.record, run.folder, run.record["summary"]["steps"] - 1).vertices


def table(runs: list[tuple[pd.Series, Run]]) -> pd.DataFrame:
    """A row a run: formulation, outcome, dt_s, newton_iterations, solve_s, and error, which is nan of runs
    that failed, of the reference, and where a formulation has none. Errors: UserError where no frame is kept.
    """
    rows = [row for row, _ in runs]
    found = pd.DataFrame(
        [{key: row[key] for key in ("formulation", "outcome", "dt_s", *dict(COST))} for row in rows]
    )
    finest, good = found["dt_s"].min(), found["outcome"] == "ok"
    references = {
        found["formulation"][k]: end(runs[k][1]) for k in found.index[good & (found["dt_s"] == finest)]
    }
    errors = np.full(len(found), np.nan)
    for k in found.index[good & (found["dt_s"] > finest)]:
        reference = references.get(found["formulation"][k])
        if reference is None:
            continue
        apart = end(runs[k][1]) - reference
        errors[k] = np.sqrt((apart**2).sum(axis=1).mean()) / rows[k]["scene_extent_m"]
    return found.assign(error=errors)


def draw(axis, found: pd.DataFrame, cost: str) -> None:
    for row, name in enumerate(formulations(found)):
        mine = found[(found["formulation"] == name) & (found["error"] > 0)].sort_values("dt_s")
        slopes.draw(axis, mine[cost], mine["error"], name, (), row)
        for _, one in mine.iterrows():
            at, label = (one[cost], one["error"]), f"{1e3 * one['dt_s']:g}"
            axis.annotate(label, at, (2, 2), textcoords="offset points", fontsize=5)
    axis.set(xscale="log", yscale="log")
    style.keep_span(axis)


def figure(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    runs = subject.records.runs
    if runs["dt_s"].nunique() < 3:
        raise drawing.nothing(f"fewer than three time steps ({outcomes(runs)})")
    found = table([(row, subject.run(row)) for _, row in runs.iterrows()])
    if not (found["error"] > 0).any():
        raise drawing.nothing(f"no run beside one at the smallest time step ({outcomes(runs)})")
    fig, axes = plt.subplots(1, 2, figsize=(drawing.width_in, 2.8), layout="constrained", sharey=True)
    for axis, (column, label) in zip(axes, COST):
        draw(axis, found, column)
        axis.set_xlabel(label)
    axes[0].set_ylabel("error / size")
    style.letter_panels(axes)
    style.legend_below(fig, axes[0])
    facts = Facts(
        f"1 repetition of {outcomes(runs)}; {found['dt_s'].nunique()} time steps",
        "root mean square over vertices",
        f"each formulation at a time step of {1e3 * found['dt_s'].min():.4g} ms",
        common(runs, {"scene": "scene", "scene_free_dofs": "unknowns", "d_hat_m": "d_hat (m)"}),
    )
    return drawing.save(fig, found, SHOWN, facts, runs)
