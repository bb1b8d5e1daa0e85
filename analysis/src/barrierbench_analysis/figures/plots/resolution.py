"""Error against mesh size: how far the centre of mass is from where it is on the finest mesh."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.tables.run import Run

from . import slopes
from .drawing import Drawing, SweepRecords, common, outcomes

SHOWN = (
    "Height of the centre of mass at the end of the run (gravity_J of its last step over m g): distance from"
    " the reference over the size of the scene, against the side of a cell. Left: the reference is the same"
    " formulation on its finest mesh, which shows the error of the mesh alone. Right: it is the middle of all"
    " formulations on their finest meshes, and grey is how far these are from it: barriers of the same width"
    " differ by so much, and what lies in the grey is not ranked. Crosses at the upper edge: runs that"
    " failed, or ended early."
)


def weight(config: dict) -> float:
    """m g (N) of a scene of one shell whose mesh is a grid. Errors: KeyError, IndexError for another."""
    body, gravity = config["scene"]["bodies"][0], config["scene"]["gravity_m_per_s2"]
    area = body["mesh"]["size_x_m"] * body["mesh"]["size_y_m"]
    return body["material"]["density_kg_per_m2"] * area * float(np.linalg.norm(gravity))


def cell_m(config: dict) -> float:
    mesh = config["scene"]["bodies"][0]["mesh"]
    return mesh["size_x_m"] / (mesh["n_x"] - 1)


@dataclass(frozen=True)
class Heights:
    """A row a run: formulation, outcome, cell_m, height_m (nan where it failed), extent_m."""

    table: pd.DataFrame

    def finest(self) -> dict[str, float]:
        """Formulation -> height on the finest mesh of all, where it got through."""
        least = self.table["cell_m"].min()
        mine = self.table[(self.table["cell_m"] == least) & self.table["height_m"].notna()]
        return dict(zip(mine["formulation"], mine["height_m"]))

    def errors(self) -> tuple[pd.DataFrame, float]:
        """With `own` and `common`, the errors of both references over the extent; and the band of the
        second.
        """
        finest = self.finest()
        middle = float(np.mean(list(finest.values()))) if finest else np.nan
        size = self.table["extent_m"]
        own = self.table["formulation"].map(finest)
        found = self.table.assign(
            own=(self.table["height_m"] - own).abs() / size,
            common=(self.table["height_m"] - middle).abs() / size,
        )
        band = max((abs(h - middle) for h in finest.values()), default=np.nan) / size.iloc[0]
        return found, float(band)


def heights(runs: list[tuple[pd.Series, Run]]) -> Heights:
    """Errors: UserError where a scene is not one grid."""
    rows = []
    for row, run in runs:
        last = run.steps.iloc[-1] if len(run.steps) else None
        whole = row["outcome"] == "ok" and last is not None
        rows.append(
            {"formulation": row["formulation"], "outcome": row["outcome"], "cell_m": cell_m(run.config)}
            | {"height_m": last["gravity_J"] / weight(run.config) if whole else np.nan}
            | {"extent_m": row["scene_extent_m"], "unknowns": row["scene_free_dofs"]}
        )
    return Heights(pd.DataFrame(rows))


def figure(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    runs = subject.records.runs
    found, band = heights(subject.each_run()).errors()
    if not (found["own"] > 0).any():
        raise drawing.nothing(f"no run beside one on the finest mesh ({outcomes(runs)})")
    fig, axes = drawing.panels(2, 2.8)
    slopes.note(axes[0], slopes.draw(axes[0], found, "cell_m", "own"))
    slopes.draw(axes[1], found, "cell_m", "common")
    low, high = axes[1].get_ylim()
    axes[1].axhspan(low / 10, band, color="#bbbbbb", alpha=0.5, linewidth=0, zorder=0, gid=style.REFERENCE)
    axes[1].set_ylim(min(low, band / 3), high)
    axes[0].set(ylabel="error of the height / size", title="reference: own finest mesh")
    axes[1].set_title("reference: middle of the finest")
    for axis in axes:
        axis.set_xlabel("side of a cell (m)")
    facts = Facts(
        f"{outcomes(runs)}; {found['cell_m'].nunique()} meshes",
        "absolute difference at the end of the run; slopes: least squares of logarithms",
        f"finest mesh, cells of {found['cell_m'].min():.4g} m; band {band:.2g}",
        common(runs, "scene scene_free_dofs steps dt_s d_hat_m"),
    )
    return drawing.finish(fig, axes, found.assign(band=band), SHOWN, facts, runs=runs)
