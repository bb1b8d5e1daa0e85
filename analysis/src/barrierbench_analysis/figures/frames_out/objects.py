"""What formats of films have of a mesh: an object a body with points of its own, rods as curves."""

from dataclasses import dataclass

import numpy as np

from barrierbench_analysis.figures.surfaces.sequence import Mesh

SURFACE, CURVES, POINTS = "surface", "curves", "points"


@dataclass(frozen=True)
class Part:
    """A surface has triangles, curves have how many of its points each of them has."""

    name: str
    kind: str
    numbers: np.ndarray  # of its points in the mesh, in its order
    triangles: np.ndarray  # [n, 3] of its own points
    counts: np.ndarray  # [curves]


def curves_of(edges: np.ndarray) -> list[list[int]]:
    """Edges, one after the other as long as each begins where the one before it ends: numbers of points."""
    curves: list[list[int]] = []
    for a, b in edges.tolist():
        if curves and curves[-1][-1] == a:
            curves[-1].append(b)
        else:
            curves.append([a, b])
    return curves


def _curves(name: str, edges: np.ndarray) -> Part:
    """A vertex in which more than two edges meet, or a ring closes, is a point of each curve through it, and
    readers join these points by their numbers (film_files/joins.py).
    """
    curves = curves_of(edges)
    counts = np.array([len(curve) for curve in curves])
    return Part(name, CURVES, np.concatenate(curves), np.zeros((0, 3), int), counts)


def parts_of(mesh: Mesh) -> list[Part]:
    """Objects of all bodies. A body without triangles and rods is points; rods of a body with triangles are
    an object of their own.
    """
    parts, no_curves = [], np.zeros(0, int)
    for body, name in enumerate(mesh.names):
        own = np.flatnonzero(mesh.of_points == body)
        triangles = np.searchsorted(own, mesh.triangles[mesh.of_triangles == body])
        edges = mesh.edges[mesh.of_points[mesh.edges[:, 0]] == body]
        if len(triangles):
            parts.append(Part(name, SURFACE, own, triangles, no_curves))
        if len(edges):
            parts.append(_curves(f"{name}_rods" if len(triangles) else name, edges))
        if not len(triangles) and not len(edges):
            parts.append(Part(name, POINTS, own, triangles, no_curves))
    return parts
