"""Numbers of a frame that need no audit: stretch, volumes, momentum and energies. Where a material or a time
is not given, they are not computed; what overflows, or is relative to a first frame that is not finite,
is None.
"""

import numpy as np

from barrierbench_analysis.program.trajectories.trajectory import Topology, surface_of

from .about import About


def finite_or_none(values: np.ndarray | float) -> list | float | None:
    """For JSON: the numbers; None where one of them is none."""
    return np.asarray(values).tolist() if np.isfinite(values).all() else None


def _frames_of(x: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """[n, 2, 2] edge vectors of triangles in their own planes, as columns."""
    a, b = (x[triangles[:, k]] - x[triangles[:, 0]] for k in (1, 2))
    length = np.linalg.norm(a, axis=1)
    along = (a * b).sum(1) / length
    across = np.linalg.norm(np.cross(a, b), axis=1) / length
    zero = np.zeros(len(a))
    return np.stack([np.stack([length, along], 1), np.stack([zero, across], 1)], 1)


class Physics:
    """Of the frames of one trajectory, in order."""

    @np.errstate(all="ignore")
    def __init__(self, topology: Topology, about: About, rest: np.ndarray, times_s: np.ndarray | None):
        self.topology, self.about, self.times_s = topology, about, times_s
        frames = _frames_of(rest, topology.triangles)
        finite = np.isfinite(frames).all(axis=(1, 2))
        self.rest_is_known = bool(finite.all())
        self.sound = finite & (np.abs(np.linalg.det(frames)) > 0)
        self.to_rest = np.linalg.inv(frames[self.sound])
        self.mass = self._masses(rest)
        self.volumes = self._volumes(rest)
        self.last: np.ndarray | None = None

    def _masses(self, rest: np.ndarray) -> np.ndarray | None:
        """[n] kg of vertices, a share of each cell at each corner; None without any density."""
        if not self.about.density:
            return None
        t, body = self.topology, self.topology.body_of_vertices()
        density = np.array([self.about.density.get(name, 0.0) for name in t.names])
        mass = np.zeros(t.n_vertices)
        a, b = (rest[t.triangles[:, k]] - rest[t.triangles[:, 0]] for k in (1, 2))
        inner = rest[t.tetrahedra[:, 1:]] - rest[t.tetrahedra[:, :1]]
        sizes = (
            (t.triangles, np.linalg.norm(np.cross(a, b), axis=1) / 2),
            (t.segments, np.linalg.norm(np.diff(rest[t.segments], axis=1)[:, 0], axis=1)),
            (t.tetrahedra, np.abs(np.linalg.det(inner)) / 6),
        )
        solid = set(body[t.tetrahedra].ravel().tolist())
        for cells, size in sizes:
            if cells.shape[1] == 3 and solid:  # the skin of a solid weighs nothing
                size = np.where(np.isin(body[cells[:, 0]], list(solid)), 0.0, size)
            share = size * density[body[cells[:, 0]]] / cells.shape[1] if len(cells) else size
            np.add.at(mass, cells, share[:, None])
        return mass

    def _volumes(self, x: np.ndarray) -> np.ndarray:
        """[bodies] m^3 that the triangles of each body enclose, with sign; means nothing for open ones."""
        t = surface_of(self.topology)
        body = self.topology.body_of_vertices()
        six = np.einsum("ni,ni->n", x[t[:, 0]], np.cross(x[t[:, 1]], x[t[:, 2]]))
        return np.bincount(body[t[:, 0]], six / 6, len(self.topology.names))

    def _stretches(self, x: np.ndarray) -> dict[str, float | None]:
        """Of the triangles that have an area at rest; nothing without any."""
        none = {"stretch_max": None, "stretch_min": None}
        if not self.rest_is_known:
            return none
        if not self.sound.any():
            return {}
        gradient = _frames_of(x, self.topology.triangles[self.sound]) @ self.to_rest
        if not np.isfinite(gradient).all():
            return none
        stretches = np.linalg.svd(gradient, compute_uv=False)
        return {
            "stretch_max": finite_or_none(stretches.max()),
            "stretch_min": finite_or_none(stretches.min()),
        }

    @np.errstate(all="ignore")
    def of(self, number: int, x: np.ndarray) -> dict:
        """A frame that is not finite has no numbers. Volumes are of all bodies, open ones too."""
        out: dict = {}
        if not np.isfinite(x).all():
            self.last = None
            return out
        t = self.topology
        out |= self._stretches(x)
        if len(t.tetrahedra):
            inner = np.linalg.det(x[t.tetrahedra[:, 1:]] - x[t.tetrahedra[:, :1]])
            out["tetrahedra_inverted"] = int((inner <= 0).sum()) if np.isfinite(inner).all() else None
        volumes = self._volumes(x) / self.volumes
        out["volume_rel"] = {name: finite_or_none(v) for name, v in zip(t.names, volumes)}
        if self.mass is not None and self.last is not None:
            dt = self.times_s[number] - self.times_s[number - 1]
            v = (x - self.last) / dt
            out["momentum_kg_m_s"] = finite_or_none(self.mass @ v)
            out["kinetic_J"] = finite_or_none(0.5 * self.mass @ (v * v).sum(1))
        if self.mass is not None:
            out["gravity_J"] = finite_or_none(-self.mass @ (x @ np.array(self.about.gravity_m_s2)))
        self.last = x
        return out
