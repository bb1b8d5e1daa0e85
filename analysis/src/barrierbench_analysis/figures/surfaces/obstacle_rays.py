"""Analytic obstacles in a picture, each pixel by its own ray: no facets, so that no gap looks wider or
narrower than it is.
"""

from dataclasses import dataclass

import numpy as np

from .rasterizer import Camera


@dataclass
class Hits:
    """Where the rays of pixels meet one obstacle: whether a ray does, and of the n that do, row by row,
    depth, point and normal.
    """

    mask: np.ndarray  # [height, width]
    depth: np.ndarray  # [n] as Camera.project's
    points: np.ndarray  # [n, 3] m
    normals: np.ndarray  # [n, 3] unit

    def depth_image(self) -> np.ndarray:
        """[height, width], -inf where the ray misses."""
        image = np.full(self.mask.shape, -np.inf)
        image[self.mask] = self.depth
        return image


def _radial(obstacle: dict, v: np.ndarray) -> np.ndarray:
    """The part of vectors that the distance depends on: across the axis for a cylinder."""
    if obstacle["kind"] == "sphere":
        return v
    axis = np.array(obstacle["axis"], float)
    return v - (v @ axis)[..., None] * axis


def signed_gap(obstacle: dict, x: np.ndarray) -> np.ndarray:
    """[...] signed distance (m) of points [..., 3], positive on the allowed side."""
    q = x - np.array(obstacle["point_m"], float)
    if obstacle["kind"] == "plane":
        return q @ np.array(obstacle["axis"], float)
    gap = np.linalg.norm(_radial(obstacle, q), axis=-1) - obstacle["radius_m"]
    return -gap if obstacle.get("inside") else gap


def _dot(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Of vectors [..., 3], or of one vector and many."""
    if u.ndim == 1:
        return v @ u
    return u @ v if v.ndim == 1 else np.einsum("...c,...c->...", u, v)


def _times(obstacle: dict, origin: np.ndarray, way: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """Which rays [height, width] meet the unbounded obstacle, and when those do: of a round one twice, nearer
    first.
    """
    point = np.array(obstacle["point_m"], float)
    if obstacle["kind"] == "plane":
        axis = np.array(obstacle["axis"], float)
        down = way @ axis
        meets = np.broadcast_to(down < 0, way.shape[:2])
        height = np.broadcast_to((point - origin) @ axis, way.shape[:2])
        return meets, [height[meets] / down[meets]]
    o, d = _radial(obstacle, origin - point), _radial(obstacle, way)
    a, b, c = _dot(d, d), _dot(o, d), _dot(o, o) - obstacle["radius_m"] ** 2
    inner = b * b - a * c
    meets = (inner >= 0) & (a > 0)
    a, b, root = np.broadcast_to(a, meets.shape)[meets], b[meets], np.sqrt(inner[meets])
    return meets, [(-b - root) / a, (-b + root) / a]


def hits(
    obstacle: dict, camera: Camera, rays: tuple[np.ndarray, np.ndarray], center: np.ndarray, reach: float
) -> Hits:
    """The surface of an obstacle that a camera sees by its rays. A plane is shown as a square and a cylinder
    as a tube of half length `reach` (m) round the point nearest `center`; a plane is seen from its allowed
    side alone, and of an obstacle that bodies are inside of the far side is shown.
    """
    point = np.array(obstacle["point_m"], float)
    axis = np.array(obstacle.get("axis", (0, 0, 1)), float)
    mask, times = _times(obstacle, *rays)
    origin, way = rays[0] if rays[0].ndim == 1 else rays[0][mask], rays[1][mask]
    best = np.full(len(way), np.nan)
    for t in reversed(times[1:] if obstacle.get("inside") else times):
        shown = (t > 0) | (not camera.perspective)
        if obstacle["kind"] != "sphere":
            middle = center if obstacle["kind"] == "plane" else point + axis * np.dot(center - point, axis)
            off = origin + t[:, None] * way - middle
            along = (off @ axis)[:, None] * axis
            across = off - along if obstacle["kind"] == "plane" else along
            for coordinate in across.T:
                shown &= np.abs(coordinate) <= reach
        best = np.where(shown, t, best)
    seen = np.isfinite(best)
    mask = mask.copy()
    mask[mask] = seen
    best, way, origin = best[seen], way[seen], origin if origin.ndim == 1 else origin[seen]
    x = origin + best[:, None] * way
    if obstacle["kind"] == "plane":
        return Hits(mask, camera.depth(best), x, np.broadcast_to(axis, x.shape))
    return Hits(mask, camera.depth(best), x, _radial(obstacle, x - point) / obstacle["radius_m"])


# --- how far a surface is from an obstacle


def _segment_distances(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """[n] distance of the origin to segments."""
    side = b - a
    length_sq = np.maximum((side * side).sum(-1), 1e-300)
    t = np.clip(-(a * side).sum(-1) / length_sq, 0, 1)
    return np.linalg.norm(a + t[:, None] * side, axis=-1)


def triangle_distances(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """[n] distance of the origin to triangles."""
    n = np.cross(b - a, c - a)
    inside = np.ones(len(a), bool)
    for p, q in ((a, b), (b, c), (c, a)):
        inside &= (n * np.cross(p, q)).sum(-1) >= 0
    length = np.linalg.norm(n, axis=-1)
    height = np.abs((n * a).sum(-1)) / np.maximum(length, 1e-300)
    sides = np.minimum(
        np.minimum(_segment_distances(a, b), _segment_distances(b, c)), _segment_distances(c, a)
    )
    return np.where(inside & (length > 0), height, sides)


def primitive_gaps(obstacle: dict, corners: np.ndarray) -> np.ndarray:
    """[n] smallest signed gap (m) over flat primitives [n, k, 3] (k = 2: edges, 3: triangles), negative
    beyond the surface. Where the allowed side is convex the corners decide.
    """
    if obstacle["kind"] == "plane" or obstacle.get("inside"):
        return signed_gap(obstacle, corners).min(axis=1)
    arms = _radial(obstacle, corners - np.array(obstacle["point_m"], float))
    distance = (
        _segment_distances(*arms.transpose(1, 0, 2))
        if arms.shape[1] == 2
        else triangle_distances(*arms.transpose(1, 0, 2))
    )
    return distance - obstacle["radius_m"]
