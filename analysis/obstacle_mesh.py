"""Analytic obstacles as triangles, for pictures only: spheres, cylinders and planes cut off around the bodies."""

from __future__ import annotations

import numpy as np


def _grid(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """[r, c, 3] points to vertices and two triangles a cell."""
    rows, columns = points.shape[:2]
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a = (i * columns + j).ravel()
    b, c, d = a + 1, a + columns + 1, a + columns
    return points.reshape(-1, 3), np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def _across(axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors at right angles to the axis and to each other."""
    u = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    u /= np.linalg.norm(u)
    return u, np.cross(axis, u)


def obstacle_mesh(obstacle: dict, center: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Vertices [n, 3] (m) and triangles [m, 3] of one entry of frames/scene.json.

    A plane becomes a square and a cylinder a tube of half length `reach` (m) around the point nearest `center`.
    """
    point = np.array(obstacle["point_m"], float)
    if obstacle["kind"] == "sphere":
        polar, around = np.meshgrid(np.linspace(0, np.pi, 49), np.linspace(0, 2 * np.pi, 97), indexing="ij")
        unit = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], -1)
        return _grid(point + obstacle["radius_m"] * unit)
    axis = np.array(obstacle["axis"], float)
    u, v = _across(axis)
    if obstacle["kind"] == "plane":
        middle = center - axis * np.dot(center - point, axis)
        s = np.linspace(-reach, reach, 41)
        return _grid(middle + s[:, None, None] * u + s[None, :, None] * v)
    middle = point + axis * np.dot(center - point, axis)
    around = np.linspace(0, 2 * np.pi, 97)
    ring = obstacle["radius_m"] * (np.cos(around)[:, None] * u + np.sin(around)[:, None] * v)
    return _grid(middle + np.linspace(-reach, reach, 25)[:, None, None] * axis + ring)
