"""Analytic obstacles in a picture, each pixel by its own ray: no facets, so that no gap looks wider or
narrower than it is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .rasterizer import Camera


@dataclass
class Hits:
    """Where the rays of all pixels meet one obstacle: arrays [height, width], points and normals [height,
    width, 3].
    """

    depth: np.ndarray  # as Camera.project's, -inf where the ray misses
    points: np.ndarray  # m
    normals: np.ndarray  # unit


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


def _round_times(obstacle: dict, origin: np.ndarray, way: np.ndarray) -> list[np.ndarray]:
    """Both roots, nearer first; nan where the ray misses."""
    o, d = _radial(obstacle, origin - np.array(obstacle["point_m"], float)), _radial(obstacle, way)
    a, b, c = (d * d).sum(-1), (o * d).sum(-1), (o * o).sum(-1) - obstacle["radius_m"] ** 2
    with np.errstate(invalid="ignore", divide="ignore"):
        root = np.sqrt(b * b - a * c)
        return [(-b - root) / a, (-b + root) / a]


def hits(obstacle: dict, camera: Camera, width: int, height: int, center: np.ndarray, reach: float) -> Hits:
    """The surface of an obstacle that a camera sees. A plane is shown as a square and a cylinder as a tube of
    half length `reach` (m) round the point nearest `center`; a plane is seen from its allowed side alone, and
    of an obstacle that bodies are inside of the far side is shown.
    """
    origin, way = camera.rays(width, height)
    point = np.array(obstacle["point_m"], float)
    axis = np.array(obstacle.get("axis", (0, 0, 1)), float)
    if obstacle["kind"] == "plane":
        with np.errstate(invalid="ignore", divide="ignore"):
            times = [np.where(way @ axis < 0, ((point - origin) @ axis) / (way @ axis), np.nan)]
    else:
        times = _round_times(obstacle, origin, way)
        times = times[1:] if obstacle.get("inside") else times
    best = np.full(way.shape[:2], np.nan)
    for t in reversed(times):
        x = origin + np.where(np.isfinite(t), t, 0.0)[..., None] * way
        shown = np.isfinite(t) & ((t > 0) | (not camera.perspective))
        if obstacle["kind"] != "sphere":
            middle = center if obstacle["kind"] == "plane" else point + axis * np.dot(center - point, axis)
            off = x - middle
            across = (
                off - (off @ axis)[..., None] * axis
                if obstacle["kind"] == "plane"
                else (off @ axis)[..., None] * axis
            )
            shown &= (np.abs(across) <= reach).all(axis=-1)
        best = np.where(shown, t, best)
    x = origin + np.where(np.isfinite(best), best, 0.0)[..., None] * way
    normal = (
        np.broadcast_to(axis, x.shape)
        if obstacle["kind"] == "plane"
        else _radial(obstacle, x - point) / obstacle["radius_m"]
    )
    depth = camera.depth(np.where(np.isfinite(best), best, 1.0))
    return Hits(np.where(np.isfinite(best), depth, -np.inf), x, normal)


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
