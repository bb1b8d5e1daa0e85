"""Error against mesh size: how far the centre of mass is from where it is on the finest mesh."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.tables.run import Run

from . import slopes
from .drawing import Drawing, common, formulations, outcomes
from .subjects import SweepRecords

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
    body = config["scene"]["bodies"][0]
    mesh = body["mesh"]
    area = mesh["size_x_m"] * mesh["size_y_m"]
    return (
        body["material"]["density_kg_per_m2"]
        * area
        * float(np.linalg.norm(config["scene"]["gravity_m_per_s2"]))
    )


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


def draw(axis, found: pd.DataFrame, column: str) -> dict[str, float | None]:
    of = {}
    for row, name in enumerate(formulations(found)):
        mine = found[found["formulation"] == name].sort_values("cell_m")
        good = mine[mine[column] > 0]
        failed = mine.loc[mine["outcome"] != "ok", "cell_m"]
        slopes.draw(axis, good["cell_m"], good[column], name, failed, row)
        of[name] = slopes.slope(good["cell_m"], good[column])
    axis.set(xscale="log", yscale="log", xlabel="side of a cell (m)")
    style.keep_span(axis)
    return of


def figure(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    runs = subject.records.runs
    found, band = heights([(row, subject.run(row)) for _, row in runs.iterrows()]).errors()
    if not (found["own"] > 0).any():
        raise drawing.nothing(f"no run beside one on the finest mesh ({outcomes(runs)})")
    fig, axes = plt.subplots(1, 2, figsize=(drawing.width_in, 2.8), layout="constrained")
    of = draw(axes[0], found, "own")
    draw(axes[1], found, "common")
    slopes.note(axes[0], of)
    low, high = axes[1].get_ylim()
    axes[1].axhspan(low / 10, band, color="#bbbbbb", alpha=0.5, linewidth=0, zorder=0, gid=style.REFERENCE)
    axes[1].set_ylim(min(low, band / 3), high)
    axes[0].set(ylabel="error of the height / size", title="reference: own finest mesh")
    axes[1].set_title("reference: middle of the finest")
    style.letter_panels(axes)
    style.legend_below(fig, axes[0])
    facts = Facts(
        f"{outcomes(runs)}; {found['cell_m'].nunique()} meshes",
        "absolute difference at the end of the run; slopes: least squares of logarithms",
        f"finest mesh, cells of {found['cell_m'].min():.4g} m; band {band:.2g}",
        common(
            runs,
            {
                "scene": "scene",
                "scene_free_dofs": "unknowns",
                "steps": "steps",
                "dt_s": "dt (s)",
                "d_hat_m": "d_hat (m)",
            },
        ),
    )
    return drawing.save(fig, found.assign(band=band), SHOWN, facts, runs)
