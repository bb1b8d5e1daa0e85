"""Rods as round tubes, so that they have pixels and a shade."""

import numpy as np

from .rasterizer import unit

SIDES = 12


def chains(edges: np.ndarray) -> list[list[int]]:
    """Vertices of rods in a row, each edge in one of them; a row ends where not two edges meet. A closed loop
    begins and ends with one vertex.
    """
    of: dict[int, list[int]] = {}
    for number, edge in enumerate(edges.tolist()):
        for vertex in edge:
            of.setdefault(vertex, []).append(number)
    used, found = set(), []

    def walk(vertex: int, edge: int) -> list[int]:
        row = [vertex]
        while edge not in used:
            used.add(edge)
            a, b = edges[edge].tolist()
            row.append(b if row[-1] == a else a)
            following = of[row[-1]]
            if len(following) != 2:
                break
            edge = following[0] if following[1] == edge else following[1]
        return row

    ends = [vertex for vertex, at in of.items() if len(at) != 2]
    for vertex in [*ends, *of]:
        found += [walk(vertex, edge) for edge in of[vertex] if edge not in used]
    return found


def rounded(x: np.ndarray, times: int) -> np.ndarray:
    """[., 3] a row of points [n, 3] with points between them on a Catmull-Rom spline through them, `times`
    pieces for each segment."""
    if times == 1 or len(x) < 3:
        return x
    closed = np.array_equal(x[0], x[-1])
    before = np.concatenate([x[-2:-1] if closed else 2 * x[:1] - x[1:2], x[:-2]])
    after = np.concatenate([x[2:], x[1:2] if closed else 2 * x[-1:] - x[-2:-1]])
    a, b = x[:-1], x[1:]
    t = (np.arange(times) / times)[None, :, None]
    m, n = ((b - before) / 2)[:, None], ((after - a) / 2)[:, None]
    a, b = a[:, None], b[:, None]
    curve = a * (2 * t**3 - 3 * t**2 + 1) + m * (t**3 - 2 * t**2 + t)
    curve = curve + b * (3 * t**2 - 2 * t**3) + n * (t**3 - t**2)
    return np.concatenate([curve.reshape(-1, 3), x[-1:]])


def tube(x: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Points [n SIDES + 2, 3] and triangles of a tube with flat ends along a row of points [n, 3], whose
    circles do not turn about it from one to the next.
    """
    ways = unit(np.diff(x, axis=0))
    tangents = unit(np.concatenate([ways[:1], ways[:-1] + ways[1:], ways[-1:]]))
    u = np.cross(tangents[0], np.eye(3)[np.argmin(np.abs(tangents[0]))])
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    rings = []
    for p, t in zip(x, tangents):
        u = u - (u @ t) * t
        u = u / max(np.linalg.norm(u), 1e-300)
        rings.append(p + radius * (np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * np.cross(t, u)))
    n, k = len(x), np.arange(SIDES)
    i, k = (g.ravel() for g in np.meshgrid(np.arange(n - 1) * SIDES, k, indexing="ij"))
    a, b = i + k, i + (k + 1) % SIDES
    sides = np.concatenate([np.stack([a, b, b + SIDES], 1), np.stack([a, b + SIDES, a + SIDES], 1)])
    k, last = np.arange(SIDES), (n - 1) * SIDES
    after = (k + 1) % SIDES
    caps = [
        np.stack([np.full(SIDES, n * SIDES), after, k], 1),
        np.stack([np.full(SIDES, n * SIDES + 1), last + k, last + after], 1),
    ]
    return np.concatenate([*rings, x[:1], x[-1:]]), np.concatenate([sides, *caps])


def tubes(
    x: np.ndarray, edges: np.ndarray, radius: np.ndarray, times: int = 1
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """All rods: points, triangles, and of each triangle a vertex of its rod. radius: [n] m, of the vertices
    x."""
    points, triangles, of, first = [np.zeros((0, 3))], [np.zeros((0, 3), int)], [np.zeros(0, int)], 0
    for row in chains(edges):
        made, sides = tube(rounded(x[row], times), float(radius[row[0]]))
        points.append(made)
        triangles.append(sides + first)
        of.append(np.full(len(sides), row[0]))
        first += len(made)
    return np.concatenate(points), np.concatenate(triangles), np.concatenate(of)
