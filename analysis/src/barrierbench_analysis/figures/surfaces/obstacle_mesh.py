"""Analytic obstacles as triangles, for tools that know no others.

A sphere or a cylinder is a polyhedron inside it, so that what touches the obstacle is seen to stay outside;
of one that bodies are inside of, the polyhedron is round it.
"""

import numpy as np

AROUND = 96  # sides of a circle; a chord is within 1 - cos(pi/96) = 0.054% of the radius


def _basis(axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors that are, with `axis`, a right-handed basis."""
    u = np.cross(np.eye(3)[np.argmin(np.abs(axis))], axis)
    u /= np.linalg.norm(u)
    return u, np.cross(axis, u)


def _circle(axis: np.ndarray, radius: float) -> np.ndarray:
    """[AROUND, 3] m, round 0."""
    u, v = _basis(axis)
    angle = 2 * np.pi * np.arange(AROUND) / AROUND
    return radius * (np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v)


def _between(rows: int) -> np.ndarray:
    """[., 3] triangles of a tube of `rows` circles, normals outwards where the circles go along their
    axis."""
    i, k = np.meshgrid(np.arange(rows - 1), np.arange(AROUND), indexing="ij")
    a, b = (i * AROUND + k).ravel(), (i * AROUND + (k + 1) % AROUND).ravel()
    return np.concatenate([np.stack([a, b, b + AROUND], 1), np.stack([a, b + AROUND, a + AROUND], 1)])


def _sphere(radius: float) -> tuple[np.ndarray, np.ndarray]:
    axis, rows = np.array([0.0, 0.0, 1.0]), AROUND // 2 - 1
    polar = np.pi * np.arange(rows, 0, -1) / (rows + 1)
    rings = [_circle(axis, radius * np.sin(t)) + radius * np.cos(t) * axis for t in polar]
    south, north, k = rows * AROUND, rows * AROUND + 1, np.arange(AROUND)
    after, last = (k + 1) % AROUND, (rows - 1) * AROUND
    caps = [
        np.stack([np.full(AROUND, south), after, k], 1),
        np.stack([np.full(AROUND, north), last + k, last + after], 1),
    ]
    points = np.concatenate([*rings, [-radius * axis, radius * axis]])
    return points, np.concatenate([_between(rows), *caps])


def obstacle_mesh(obstacle: dict, center: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Points [n, 3] m and triangles [k, 3] with normals towards the allowed side. obstacle: of scene.json. A
    plane is a square and a cylinder a tube of half length `reach` round the point nearest `center`, as
    ./bench draw still draws them.
    """
    point = np.array(obstacle["point_m"], float)
    inside = bool(obstacle.get("inside"))
    radius = obstacle.get("radius_m", 0.0) / (np.cos(np.pi / AROUND) ** 2 if inside else 1)
    if obstacle["kind"] == "sphere":
        points, triangles = _sphere(radius)
        points = points + point
    else:
        axis = np.array(obstacle["axis"], float) / np.linalg.norm(obstacle["axis"])
        along = np.dot(center - point, axis)
        if obstacle["kind"] == "plane":
            (u, v), middle = _basis(axis), center - along * axis
            points = middle + reach * np.stack([-u - v, u - v, u + v, v - u])
            triangles = np.array([[0, 1, 2], [0, 2, 3]])
        else:
            middle = point + along * axis
            points = np.concatenate([_circle(axis, radius) + middle + s * reach * axis for s in (-1, 1)])
            triangles = _between(2)
    return points, triangles[:, ::-1] if inside else triangles
