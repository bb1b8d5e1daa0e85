"""What is measured of a run, from its frames: how far the card drifts, and what pushes it sideways.

The contacts are the only forces along the table, so the change of momentum of the card along it over a step
is their sum. Velocities are those of implicit Euler: the displacement of a step over its length.
"""

import numpy as np

from barrierbench_analysis.io.frames import frames_of
from barrierbench_analysis.studies.kit.metrics import FOLDER
from barrierbench_analysis.studies.kit.study.spec import Cell, Study
from barrierbench_analysis.tables.outcomes import OK, outcome_of

from .arms import GRAVITY

ENDS = 10  # last steps over which forces are averaged
MEASURED = {
    "gap": "mean height of the card's vertices at the end over d_hat",
    "drift_m": "way of the card's centre of mass along the table, from start to end",
    "tangential_J": "kinetic energy of the velocities along the table at the end",
    "pull": "mean norm of the sum of contact forces along the table over that normal to it, last ten steps",
    "border": "share of rows, over all steps, whose closest point is at an edge or a corner of a triangle or"
    " an end of an edge, or that are mollified",
}
AT_BORDER = ("point_point", "point_edge", "mollified")


def masses(vertices: np.ndarray, triangles: np.ndarray, density: float) -> np.ndarray:
    """[n] kg: a third of each triangle at its corners."""
    corners = vertices[triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    return density / 3 * np.bincount(triangles.ravel(), np.repeat(areas, 3), len(vertices))


def of_motion(start: np.ndarray, ends: np.ndarray, mass: np.ndarray, dt: float) -> dict[str, float]:
    """start: [n, 3] m; ends: [k, n, 3] of the last k > 2 steps, the table normal to the third axis."""
    along = slice(0, 2)
    centre = np.tensordot(ends, mass, (1, 0)) / mass.sum()
    velocity = np.diff(centre, axis=0) / dt
    forces = mass.sum() * (np.diff(velocity, axis=0) / dt + [0, 0, GRAVITY])
    last = (ends[-1] - ends[-2])[:, along] / dt
    return {
        "drift_m": float(np.linalg.norm(centre[-1, along] - (mass @ start / mass.sum())[along])),
        "tangential_J": float(0.5 * mass @ (last**2).sum(axis=1)),
        "pull": float(np.linalg.norm(forces[:, along], axis=1).mean() / forces[:, 2].mean()),
    }


def border_share(record: dict) -> float | None:
    counts = [step["contacts"] for step in record["steps"]]
    total = sum(one["total"] for one in counts)
    return sum(one[kind] for one in counts for kind in AT_BORDER) / total if total else None


def measure(study: Study, _cell: Cell, record: dict) -> dict:
    """Of a run that did not end well it measures nothing."""
    if outcome_of(record) != OK:
        return dict.fromkeys(MEASURED)
    steps = len(record["steps"])
    wanted = [-1, *range(steps - ENDS - 2, steps)]
    start, *ends = frames_of(record, record[FOLDER], wanted)
    card = np.flatnonzero(start.of_vertices["body"] == 0)
    triangles = start.triangles[np.isin(start.triangles[:, 0], card)]
    mass = masses(start.vertices, triangles, study.about["card"]["material"]["density_kg_per_m2"])[card]
    last = np.array([frame.vertices[card] for frame in ends])
    dt = record["config"]["time"]["dt_s"]
    gap = float(last[-1, :, 2].mean() / study.about["d_hat_m"])
    return {"gap": gap, "border": border_share(record)} | of_motion(start.vertices[card], last, mass, dt)
