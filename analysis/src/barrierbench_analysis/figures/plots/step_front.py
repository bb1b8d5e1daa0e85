"""Error against work over the time step: each formulation against its own run at the smallest step."""

from pathlib import Path

import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.frames import frame_of, frame_paths, points_of_bodies, read_scene
from barrierbench_analysis.tables.run import Run

from .drawing import Drawing, SweepRecords, common, each, outcomes

SHOWN = (
    "Distance of vertices at the end of the run from the same formulation at the smallest time step, root"
    " mean square over vertices, over the size of the scene, against the Newton iterations of the run; each"
    " line goes over the time step, which is written beside its points (ms). The smallest step is the"
    " reference and is not drawn."
)
COLUMNS = ("formulation", "outcome", "dt_s", "newton_iterations", "solve_s")


def end(run: Run) -> np.ndarray:
    """[n, 3] m, vertices of bodies after the last step. Errors: UserError where its frame is not kept."""
    last = run.record["summary"]["steps"] - 1
    if last not in frame_paths(run.record, run.folder):
        raise UserError(
            f"{run.folder}: no frame of step {last} is kept; allowed: /output/frames_every from 1"
        )
    vertices = frame_of(run.record, run.folder, last).vertices
    return points_of_bodies(read_scene(run.record, run.folder), vertices)


def table(runs: list[tuple[pd.Series, Run]]) -> pd.DataFrame:
    """A row a run: formulation, outcome, dt_s, newton_iterations, solve_s, and error, which is nan of runs
    that failed, of the reference, and where a formulation has none. Errors: UserError where no frame is kept,
    or two runs are of one formulation and time step.
    """
    rows = [row for row, _ in runs]
    found = pd.DataFrame([{key: row[key] for key in COLUMNS} for row in rows])
    twice = found[found.duplicated(["formulation", "dt_s"])]
    if len(twice):
        name, dt = twice.iloc[0][["formulation", "dt_s"]]
        raise UserError(f"found two runs of {name} at {dt:g} s; allowed: one a formulation and time step")
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


def draw(axis, found: pd.DataFrame) -> None:
    for _, name, mine, look in each(found, "dt_s"):
        axis.plot(mine["newton_iterations"], mine["error"], **look.line(label=name))
        for at in mine[["newton_iterations", "error", "dt_s"]].itertuples(index=False):
            axis.annotate(f"{1e3 * at.dt_s:g}", at[:2], (2, 2), textcoords="offset points", fontsize=5)
    axis.set(xscale="log", yscale="log", xlabel="Newton iterations", ylabel="error / size")
    style.keep_span(axis)


def left_out(found: pd.DataFrame) -> str:
    """What is not drawn beside the references, for the caption."""
    drawn = found[found["error"] > 0]
    coarse = found[(found["dt_s"] > found["dt_s"].min()) & ~found.index.isin(drawn.index)]
    names = [
        f"{one['formulation']} at {1e3 * one['dt_s']:g} ms ({one['outcome']})" for _, one in coarse.iterrows()
    ]
    return f" Not drawn, since the run or its reference failed: {', '.join(names)}." if names else ""


def figure(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    runs = subject.records.runs
    if runs["dt_s"].nunique() < 3:
        raise drawing.nothing(f"fewer than three time steps ({outcomes(runs)})")
    found = table(subject.each_run())
    if not (found["error"] > 0).any():
        raise drawing.nothing(f"no run beside one at the smallest time step ({outcomes(runs)})")
    fig, axes = drawing.panels(1, 2.8)
    draw(axes[0], found[found["error"] > 0])
    facts = Facts(
        f"1 repetition of {outcomes(runs)}; {found['dt_s'].nunique()} time steps",
        "root mean square over vertices",
        f"each formulation at a time step of {1e3 * found['dt_s'].min():.4g} ms",
        common(runs, "scene scene_free_dofs d_hat_m"),
    )
    return drawing.finish(fig, axes, found, SHOWN + left_out(found), facts, runs=runs)
