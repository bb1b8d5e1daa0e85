"""Points bound to the surface of a frame: where each of them is in any other frame.

A bound point is a barycentric point of a triangle and a signed offset along its normal. Finer triangles come
from a file (bound_mesh) or from the triangles of the frame (refined).
"""

from dataclasses import dataclass, replace

import numpy as np

from .obstacle_rays import triangle_distances
from .rasterizer import corner_normals, smoothed_corners, unit

BULGE = 0.75  # share of the way to the curved surface (alpha of Boubekeur and Alexa 2008, their value)
PASSES = 30  # of point and normal in turn, until they agree
CHUNK = 4096  # points that are searched at once


@dataclass(frozen=True)
class Binding:
    """n points and k triangles on them, of a frame with m triangles."""

    triangles: np.ndarray  # [k, 3] indices of bound points
    source: np.ndarray  # [k] triangle of the frame that a triangle has its values from
    corners: np.ndarray  # [n, 3] vertices of the frame; a vertex itself stands three times
    weights: np.ndarray  # [n, 3] their sum is 1
    owner: np.ndarray  # [n] triangle of the frame, -1: a vertex itself
    offset_m: np.ndarray  # [n] along the normal
    smooth: bool = False  # the normal is that between the vertices' normals, not the triangle's
    curved: bool = False  # points leave flat triangles towards a curved surface
    pairs: tuple[np.ndarray, np.ndarray] | None = None  # smoothed_corners() of the start

    def points(self, x: np.ndarray, frame_triangles: np.ndarray) -> np.ndarray:
        """[n, 3] m: the bound points where the vertices of the frame are x [., 3] m."""
        corners = x[self.corners]
        found = np.einsum("nk,nkc->nc", self.weights, corners)
        has = np.flatnonzero(self.owner >= 0)
        if len(has) == 0 or not (self.curved or self.offset_m.any()):
            return found
        normals = _normals_of(x, frame_triangles, self.smooth or self.curved, self.pairs)[self.owner[has]]
        if self.curved:
            found[has] += BULGE * _to_planes(found[has], corners[has], normals, self.weights[has])
        along = normal_at(normals, self.weights[has])
        found[has] += self.offset_m[has, None] * along
        return found

    def values(self, of_vertices: np.ndarray) -> np.ndarray:
        """[n] a field of the frame's vertices at the bound points, between the corners' smallest and largest
        value.
        """
        inside = _inside(self.weights)
        return np.einsum("nk,nk->n", inside, np.asarray(of_vertices, float)[self.corners])


def _inside(weights: np.ndarray) -> np.ndarray:
    """Weights of a point of the triangle for those of a point of its plane."""
    held = np.clip(weights, 0, None)
    return held / held.sum(axis=1, keepdims=True)


def _normals_of(x: np.ndarray, triangles: np.ndarray, smooth: bool, pairs) -> np.ndarray:
    """[m, 3, 3] unit normals at the corners of every triangle."""
    if smooth:
        return corner_normals(x, triangles, pairs)
    a, b, c = x[triangles].transpose(1, 0, 2)
    return np.repeat(unit(np.cross(b - a, c - a))[:, None, :], 3, axis=1)


def normal_at(normals: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """[n, 3] unit normals between those of the corners, [n, 3, 3]."""
    return unit(np.einsum("nk,nkc->nc", _inside(weights), normals))


def _to_planes(p: np.ndarray, corners: np.ndarray, normals: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """[n, 3] from points to the mean of their projections onto the corners' tangent planes (Phong
    tessellation, Boubekeur and Alexa 2008).
    """
    heights = np.einsum("nkc,nkc->nk", p[:, None, :] - corners, normals)
    return -np.einsum("nk,nk,nkc->nc", weights, heights, normals)


def whole(n_vertices: int) -> Binding:
    """Every vertex itself, without triangles."""
    own = np.repeat(np.arange(n_vertices)[:, None], 3, axis=1)
    weights = np.tile([1.0, 0.0, 0.0], (n_vertices, 1))
    none = np.full(n_vertices, -1)
    return Binding(np.zeros((0, 3), int), np.zeros(0, int), own, weights, none, np.zeros(n_vertices))


# --- a mesh from elsewhere


@dataclass(frozen=True)
class Fit:
    """How well a mesh is bound."""

    distance_m: np.ndarray  # [n] to the closest triangle, at the start
    error_m: float  # largest distance of a bound point from the vertex of the file, at the start


def closest_triangles(points: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of every point [n, 3] the closest of triangles [m, 3, 3] (the first of equally close ones) and its
    distance, m. A triangle that is closer than the closest corner has its middle within that distance and
    the largest circle round a middle: those alone are measured.   Cost: memory of CHUNK points.
    """
    from scipy.spatial import cKDTree  # half a second, which stills of frames as they are do not need

    middles = corners.mean(axis=1)
    reach = np.linalg.norm(corners - middles[:, None], axis=2).max()
    tree, of_corners = cKDTree(middles), cKDTree(corners.reshape(-1, 3))
    best, distance = np.zeros(len(points), int), np.zeros(len(points))
    for low in range(0, len(points), CHUNK):
        x = points[low : low + CHUNK]
        near = tree.query_ball_point(x, (of_corners.query(x)[0] + reach) * (1 + 1e-12), return_sorted=True)
        first = np.cumsum([0, *map(len, near)])
        which = np.concatenate(near).astype(int)
        of = np.repeat(np.arange(len(x)), np.diff(first))
        gaps = triangle_distances(*(corners[which] - x[of][:, None]).transpose(1, 0, 2))
        for k in range(len(x)):
            at = first[k] + int(np.argmin(gaps[first[k] : first[k + 1]]))
            best[low + k], distance[low + k] = which[at], gaps[at]
    return best, distance


def _along(x: np.ndarray, corners: np.ndarray, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Weights [n, 3] and offset [n] with which points of the planes, moved along `normal`, are x."""
    a, b, c = corners.transpose(1, 0, 2)
    plane = np.cross(b - a, c - a)
    offset = ((x - a) * plane).sum(-1) / (normal * plane).sum(-1)
    p = x - offset[:, None] * normal
    size = (plane * plane).sum(-1)
    u = (np.cross(p - a, c - a) * plane).sum(-1) / size
    v = (np.cross(b - a, p - a) * plane).sum(-1) / size
    return np.stack([1 - u - v, u, v], axis=1), offset


def bound_mesh(
    points: np.ndarray,
    triangles: np.ndarray,
    x: np.ndarray,
    frame_triangles: np.ndarray,
    allowed: np.ndarray,
    smooth: bool,
) -> tuple[Binding, Fit]:
    """Binds vertices [n, 3] m of a mesh to the closest of the triangles `allowed` (indices) of a frame at x.
    The point lies in the plane of the triangle, beyond its sides where the vertex is beside it, so that flat
    normals give every vertex back; smooth ones do as far as Fit.error_m says.
    """
    surface = frame_triangles[allowed]
    flat = np.linalg.norm(np.cross(*(x[surface[:, 1:]] - x[surface[:, :1]]).transpose(1, 0, 2)), axis=-1)
    allowed = allowed[flat > 0]
    index, distance = closest_triangles(points, x[frame_triangles[allowed]])
    owner = allowed[index]
    corners, pairs = frame_triangles[owner], smoothed_corners(x, frame_triangles)
    normals = _normals_of(x, frame_triangles, smooth, pairs)[owner]
    weights, offset = _along(points, x[corners], unit(normals.sum(axis=1)))
    for _ in range(PASSES if smooth else 0):
        weights, offset = _along(points, x[corners], normal_at(normals, weights))
    made = Binding(triangles, owner[triangles[:, 0]], corners, weights, owner, offset, smooth, False, pairs)
    back = np.linalg.norm(made.points(x, frame_triangles) - points, axis=1)
    return made, Fit(distance, float(back.max(initial=0)))


# --- a mesh from the frame


def refined(
    x: np.ndarray, frame_triangles: np.ndarray, chosen: np.ndarray, times: int, curved: bool
) -> Binding:
    """The triangles `chosen` (indices) of a frame at x, each cut into 4, `times` times; their vertices come
    first, in their order. curved: Phong tessellation by the normals of the corners that are one smooth
    surface at x.
    """
    used, local = np.unique(frame_triangles[chosen], return_inverse=True)
    made = whole(len(used))
    owner = np.full(len(used), -1)
    triangles, source = local.reshape(-1, 3), np.asarray(chosen)
    corners, weights = used[made.corners], made.weights
    for _ in range(times):
        triangles, source, corners, weights, owner = _halved(
            frame_triangles, triangles, source, corners, weights, owner
        )
    pairs = smoothed_corners(x, frame_triangles)
    return Binding(triangles, source, corners, weights, owner, np.zeros(len(owner)), curved, curved, pairs)


def _halved(frame_triangles, triangles, source, corners, weights, owner):
    """Every triangle in four, with a point in the middle of each side, which the first of its triangles
    owns."""
    n = len(corners)
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]], axis=2).reshape(-1, 2)
    both, first, number = np.unique(sides, axis=0, return_index=True, return_inverse=True)
    of = source[first // 3]
    new_corners = frame_triangles[of]
    new_weights = sum(_of_corners(corners[both[:, k]], weights[both[:, k]], new_corners) for k in (0, 1)) / 2
    ab, bc, ca = (n + number.reshape(-1, 3)).T
    a, b, c = triangles.T
    four = np.stack([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca], axis=1).reshape(-1, 3)
    return (
        four,
        np.repeat(source, 4),
        np.concatenate([corners, new_corners]),
        np.concatenate([weights, new_weights]),
        np.concatenate([owner, of]),
    )


def _of_corners(corners: np.ndarray, weights: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Weights [n, 3] of the same points for the corners `wanted`, which have all with a weight above 0."""
    return ((corners[:, :, None] == wanted[:, None, :]) * weights[:, :, None]).sum(axis=1)


def joined(parts: list[Binding]) -> Binding:
    """One binding of several, in their order; they are smooth and curved alike where they have an owner."""
    starts = np.cumsum([0, *(len(part.corners) for part in parts)])[:-1]
    owned = next((part for part in parts if (part.owner >= 0).any()), parts[0])
    together = {
        name: np.concatenate([getattr(part, name) for part in parts])
        for name in ("source", "corners", "weights", "owner", "offset_m")
    }
    triangles = np.concatenate([part.triangles + start for part, start in zip(parts, starts)])
    return replace(owned, triangles=triangles, **together)
