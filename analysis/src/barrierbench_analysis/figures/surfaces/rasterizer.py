"""Triangles to pixels with a depth buffer, in numpy: needs no display, no OpenGL and no library beside it.

A general toolkit would do, but VTK is 565 MB and needs OpenGL of the system, Mitsuba 206 MB; a still of
forty thousand triangles takes this file about a second.
"""

from dataclasses import dataclass

import numpy as np

AT_ONCE = 1 << 19  # pixels of boxes of triangles that are looked at together
CREASE_DEG = 40.0  # angle between normals from which on an edge is sharp


@dataclass(frozen=True)
class Camera:
    """A camera at `eye` that looks at `target`; `up` is upwards in the picture. `scale`: pixels for the
    tangent of an angle (perspective) or for a metre (orthographic)."""

    eye: np.ndarray
    target: np.ndarray
    up: np.ndarray
    scale: float
    center: tuple[float, float]  # pixel of the target
    perspective: bool = True

    def axes(self) -> np.ndarray:
        """Rows: right, down, forward; unit vectors."""
        forward = (self.target - self.eye) / np.linalg.norm(self.target - self.eye)
        right = np.cross(forward, self.up)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(forward, right), forward])

    def project(self, x: np.ndarray) -> np.ndarray:
        """[n, 3] points (m) to [n, 3]: pixel x, pixel y, and a depth that is linear on the screen, larger
        is nearer (1/m in perspective)."""
        local = (x - self.eye) @ self.axes().T
        z = local[:, 2]
        near = 1 / np.maximum(z, 1e-9) if self.perspective else np.ones(len(z))
        on_screen = [self.center[k] + self.scale * local[:, k] * near for k in (0, 1)]
        return np.stack([*on_screen, near if self.perspective else -z], axis=1)

    def rays(self, width: int, height: int) -> tuple[np.ndarray, np.ndarray]:
        """Of the middles of all pixels: origins [3] or [height, width, 3] and ways [height, width, 3] (m),
        such that origin + z way is z metres in front of the camera.
        """
        x = (np.arange(width) + 0.5 - self.center[0]) / self.scale
        y = (np.arange(height) + 0.5 - self.center[1]) / self.scale
        right, down, forward = self.axes()
        side = x[None, :, None] * right + y[:, None, None] * down
        if self.perspective:
            return self.eye, side + forward
        return self.eye + side, np.broadcast_to(forward, side.shape)

    def depth(self, z: np.ndarray) -> np.ndarray:
        """project()'s depth of points z metres in front of the camera."""
        return 1 / np.maximum(z, 1e-9) if self.perspective else -z


class DepthBuffer:
    """The nearest triangle of every pixel."""

    def __init__(self, width: int, height: int):
        self.depth = np.full((height, width), -np.inf)
        self.owner = np.full((height, width), -1)  # index of the triangle, -1: none
        self.weights = np.zeros((height, width, 3))  # of the corners, linear on the screen

    def draw(self, points: np.ndarray, triangles: np.ndarray) -> None:
        """points: [n, 3] as Camera.project gives them; triangles: [m, 3]. Triangles that are edge-on draw
        nothing.
        """
        height, width = self.depth.shape
        corners = points[triangles]
        low = np.maximum(np.ceil(corners.min(axis=1)[:, :2] - 0.5), 0).astype(int)
        high = np.floor(corners.max(axis=1)[:, :2] - 0.5)
        high = np.minimum(high, (width - 1, height - 1)).astype(int)
        a, b, c = corners.transpose(1, 0, 2)
        area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
        drawn = np.flatnonzero((high >= low).all(axis=1) & (area != 0))
        boxes = (high - low + 1)[drawn]
        ends = np.cumsum(boxes.prod(axis=1))
        at = 0
        while at < len(drawn):
            before = ends[at - 1] if at else 0
            to = max(at + 1, int(np.searchsorted(ends, before + AT_ONCE, side="right")))
            self._draw(corners, area, low, boxes[at:to], drawn[at:to])
            at = to

    def _draw(self, corners, area, low, boxes, of) -> None:
        """The triangles `of`, by all pixels of their boxes [., 2] from `low` on."""
        count = boxes.prod(axis=1)
        index = np.repeat(of, count)
        within = np.arange(len(index)) - np.repeat(np.cumsum(count) - count, count)
        across = np.repeat(boxes[:, 0], count)
        column, row = low[index, 0] + within % across, low[index, 1] + within // across
        a, b, c = (corners[:, k].take(index, axis=0).T for k in range(3))
        x, y = column + 0.5 - a[0], row + 0.5 - a[1]
        u = (x * (c[1] - a[1]) - y * (c[0] - a[0])) / area[index]
        v = (y * (b[0] - a[0]) - x * (b[1] - a[1])) / area[index]
        depth = a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2])
        pixel = row * self.depth.shape[1] + column
        seen = np.flatnonzero((u >= 0) & (v >= 0) & (u + v <= 1) & (depth > self.depth.ravel()[pixel]))
        # of a pixel the nearest, of equally near ones the first
        seen = seen[np.lexsort((-index[seen], depth[seen], pixel[seen]))]
        seen = seen[np.append(np.diff(pixel[seen]) != 0, True)[: len(seen)]]
        where = row[seen], column[seen]
        self.depth[where], self.owner[where] = depth[seen], index[seen]
        self.weights[where] = np.stack([1 - u[seen] - v[seen], u[seen], v[seen]], axis=-1)


def unit(v: np.ndarray) -> np.ndarray:
    """Vectors [..., 3] of length 1 in the same directions; 0 stays 0."""
    length = np.linalg.norm(v, axis=-1, keepdims=True)
    return np.divide(v, length, out=np.zeros_like(v), where=length > 0)


def _areas(x: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """[m, 3] normals of triangles, as long as twice their area."""
    return np.cross(x[triangles[:, 1]] - x[triangles[:, 0]], x[triangles[:, 2]] - x[triangles[:, 0]])


def sharp_corners(x: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """[m, 3] whether a triangle's own normal differs from the mean over the triangles of the vertex, weighted
    by area, by more than CREASE_DEG.
    """
    areas, sums = _areas(x, triangles), np.zeros_like(x)
    for corner in range(3):
        np.add.at(sums, triangles[:, corner], areas)
    cosines = np.einsum("mkc,mc->mk", unit(sums)[triangles], unit(areas))
    return cosines < np.cos(np.radians(CREASE_DEG))


def smoothed_corners(x: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of corners (3 t + k is corner k of triangle t) that are one smooth surface: of one vertex, and of
    triangles whose normals differ by no more than CREASE_DEG. Every corner is paired with itself.
    """
    vertex = triangles.reshape(-1)
    order = np.argsort(vertex, kind="stable")
    count = np.bincount(vertex, minlength=len(x))
    first = np.cumsum(count) - count
    one = np.repeat(np.arange(len(vertex)), count[vertex])
    within = np.arange(len(one)) - np.repeat(np.cumsum(count[vertex]) - count[vertex], count[vertex])
    other = order[first[vertex[one]] + within]
    normals = unit(_areas(x, triangles))
    alike = np.einsum("pc,pc->p", normals[one // 3], normals[other // 3]) >= np.cos(np.radians(CREASE_DEG))
    alike |= one == other
    return one[alike], other[alike]


def corner_normals(
    x: np.ndarray, triangles: np.ndarray, pairs: tuple[np.ndarray, np.ndarray] | None = None
) -> np.ndarray:
    """[m, 3, 3] unit normals at the corners of every triangle: the mean over the triangles that are one
    smooth surface with it there, weighted by area (a sharp edge stays sharp). pairs: smoothed_corners() of
    another state; None: of x.
    """
    one, other = smoothed_corners(x, triangles) if pairs is None else pairs
    sums = np.zeros((3 * len(triangles), 3))
    np.add.at(sums, one, _areas(x, triangles)[other // 3])
    return unit(sums).reshape(-1, 3, 3)
