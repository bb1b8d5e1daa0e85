"""Hertz contact: the lower part of a ball, as tetrahedra that are fine where it touches, is pressed onto a plane, and what it bears is
held against F = 4/3 E* sqrt(R) delta^(3/2) (Hertz 1882; Johnson 1985, section 4.2), E* = E/(1 - nu^2).
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from motions import FIXED, run

from barrierbench_analysis.io.frames import read_frame
from barrierbench_analysis.program.mesh_arrays import MeshArrays
from barrierbench_analysis.program.mesh_file import ply_bytes

RADIUS, YOUNGS, POISSON = 0.1, 1e6, 0.3  # m, Pa
CONTACT = RADIUS / 20  # m, radius of the contact: the theory is of a small one
DELTA = CONTACT**2 / RADIUS  # m
D_HAT = DELTA / 16  # m
WIDEST_DEG = 55.0  # the part of the ball is within this angle of its lowest point, below its centre
STEPS = 3


def force_of(delta: float) -> float:
    """N at the approach delta (m)."""
    return 4 / 3 * YOUNGS / (1 - POISSON**2) * math.sqrt(RADIUS) * delta**1.5


def _graded(count: int, first: float, length: float) -> np.ndarray:
    """[count + 1] from 0 to length, each step longer than the one before by one factor, the first one `first`."""
    low, high = 1.0, 10.0
    for _ in range(200):
        factor = 0.5 * (low + high)
        low, high = (factor, high) if first * sum(factor**k for k in range(count)) < length else (low, factor)
    at = np.concatenate([[0.0], np.cumsum(first * high ** np.arange(count))])
    return at * length / at[-1]


def _disk(rings: int) -> tuple[np.ndarray, np.ndarray]:
    """Ring and angle of the vertices, and triangles: the k-th ring has 6 k edges."""
    first = [0] + [1 + 3 * k * (k - 1) for k in range(1, rings + 2)]
    polar = [(0, 0.0)] + [(k, 2 * math.pi * j / (6 * k)) for k in range(1, rings + 1) for j in range(6 * k)]
    triangles = []
    for k in range(rings):
        inner, outer = (lambda j, k=k: first[k] + j % (6 * k) if k else 0), (lambda j, k=k: first[k + 1] + j % (6 * (k + 1)))
        for sector in range(6):
            a, b = sector * k, sector * (k + 1)
            triangles += [(inner(a + j), outer(b + j), outer(b + j + 1)) for j in range(k + 1)]
            triangles += [(inner(a + j), outer(b + j + 1), inner(a + j + 1)) for j in range(k)]
    return np.array(polar), np.array(triangles)


def ball_part(rings: int) -> MeshArrays:
    """Of the ball round the origin what is below its centre and within WIDEST_DEG: `rings` rings and as many layers, a quarter of
    `rings` of them over the radius of the contact. Columns of prisms, each cut into three tetrahedra by the numbers of its
    vertices, so that neighbours agree.
    """
    polar, triangles = _disk(rings)
    first = 4 * CONTACT / rings
    rho = _graded(rings, first, RADIUS * math.sin(math.radians(WIDEST_DEG)))[polar[:, 0].astype(int)]
    x, y = rho * np.cos(polar[:, 1]), rho * np.sin(polar[:, 1])
    bottom = -np.sqrt(RADIUS**2 - rho**2)
    rise = _graded(rings, first, RADIUS) / RADIUS
    points = np.concatenate([np.stack([x, y, bottom * (1 - share)], axis=1) for share in rise])
    cells = []
    for layer in range(rings):
        for triangle in triangles:
            a, b, c = np.sort(triangle) + layer * len(x)
            d, e, f = a + len(x), b + len(x), c + len(x)
            cells += [(a, b, c, f), (a, b, f, e), (a, e, f, d)]
    cells = np.array(cells)
    corner = points[cells]
    volume = np.einsum("ni,ni->n", corner[:, 3] - corner[:, 0], np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]))
    cells[volume < 0] = cells[volume < 0][:, [0, 2, 1, 3]]
    return MeshArrays(points, np.empty((0, 3), int), np.empty((0, 2), int), cells)


@dataclass
class Measured:
    """What a run says of the contact, in equilibrium."""

    vertices: int
    contacts: int
    force: float  # N
    mean_gap: float  # m, by load: the surface that the ball rests on is as far above the plane
    radius: float  # m, of the contact, from the second moment of the load: that of Hertz's pressure is 2/5 a^2
    delta: float  # m, approach of the far ball

    @property
    def by_radius(self) -> float:
        """Force over that of Hertz with this radius."""
        return self.force / (4 / 3 * YOUNGS / (1 - POISSON**2) * self.radius**3 / RADIUS)

    @property
    def by_delta(self) -> float:
        """Force over that of Hertz with this approach."""
        return self.force / force_of(self.delta)


def _approach(cells: MeshArrays, moved: np.ndarray, force: float, mean_gap: float) -> float:
    """Of the far ball, from the vertex of the axis nearest to R/4 above the lowest one: how far it came down, and what a force on
    a half-space moves a point at this depth by, F (1 + nu) (3 - 2 nu)/(2 pi E z) (Boussinesq 1885), which it would have to come
    down by more. Nearer than the held vertices, whose distance R is finite.
    """
    axis = np.flatnonzero(np.linalg.norm(cells.points[:, :2], axis=1) < 1e-12)
    depth = cells.points[axis, 2] + RADIUS
    k = int(np.argmin(np.abs(depth - RADIUS / 4)))
    left = force * (1 + POISSON) * (3 - 2 * POISSON) / (2 * math.pi * YOUNGS * depth[k])
    return depth[k] - moved[axis[k], 2] + mean_gap + left


def measure(program: str, folder: Path, formulation: str, rings: int) -> Measured:
    """A run in equilibrium at each step; the plane is at z = 0."""
    cells = ball_part(rings)
    folder.mkdir(parents=True)
    (folder / "ball.ply").write_bytes(ply_bytes(cells))
    top = np.flatnonzero(cells.points[:, 2] > -1e-12).tolist()
    body = {"name": "ball", "mesh": {"file": str(folder / "ball.ply")}, "transform": {"translate_m": [0, 0, RADIUS + D_HAT]},
            "material": {"solid_model": "corotational", "solid_youngs_Pa": YOUNGS, "solid_poisson": POISSON, "solid_density_kg_per_m3": 1000},
            "pins": [{"indices": top, "motion": {"velocity_m_per_s": [0, 0, -(DELTA + D_HAT / 2) / STEPS]}}]}
    scene = {"name": "bodies", "gravity_m_per_s2": [0, 0, 0], "bodies": [body], "obstacles": [{"name": "plane", "kind": "plane"}]}
    load = force_of(DELTA) * (4 / rings) ** 2  # about that of the vertex in the middle
    config = {"schema": "barrierbench.config/1", "scene": scene, "formulation": {"name": formulation, "d_hat_m": D_HAT},
              "matching": {"rule": "equal_force", "load_N": load}, **FIXED}
    motion = run(program, config, "quasi_static", STEPS, STEPS, folder / "out", DELTA * 1e-4, every=STEPS - 1)
    frame = read_frame(sorted((folder / "out/run/frames").glob("step_*.ply"))[-1])
    load, gap = frame.of_vertices["load_N"], frame.of_vertices["gap_rel"] * D_HAT
    x, force = frame.vertices, motion.record["steps"][-1]["contact_load_sum_N"]
    mean_gap = float((load * gap).sum() / load.sum())
    radius = math.sqrt(2.5 * float((load * (x[:, :2] ** 2).sum(axis=1)).sum() / load.sum()))
    assert abs(load.sum() / force - 1) < 1e-6
    return Measured(len(x), motion.record["steps"][-1]["contacts"]["total"], force, mean_gap, radius, _approach(cells, x, force, mean_gap))
