"""Frames whose bodies are grids, drawn with more points: cubic splines along the two directions of a grid,
through its vertices, as the animation of jaxls's cloth has them (45 x 45 points of 15 x 15).
"""

from dataclasses import dataclass

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.frames import Frame

ALLOWED = "allowed: bodies whose mesh is of the generator grid; ./bench draw still --hide leaves others out"


@dataclass(frozen=True)
class Piece:
    """A body in the frames as they are: its vertices and triangles, and of a grid its rows and columns."""

    vertices: np.ndarray  # indices
    triangles: np.ndarray  # indices
    grid: tuple[int, int] | None  # rows, columns; None: drawn as it is


def _grid_of(record: dict, name: str) -> tuple[int, int]:
    """Rows and columns. Errors: UserError where the body is no grid."""
    bodies = record["config"]["scene"].get("bodies") or []
    mesh = next((body["mesh"] for body in bodies if body.get("name") == name), {})
    if mesh.get("generator") != "grid":
        made = mesh.get("generator") or mesh.get("file") or f"made by the scene {record['labels']['scene']}"
        raise UserError(f"--bicubic: body {name}: its mesh is no grid but {made}; {ALLOWED}")
    return int(mesh["n_y"]), int(mesh["n_x"])


def _samples(values: np.ndarray, grid: tuple[int, int], counts: tuple[int, int], order: int) -> np.ndarray:
    """[rows columns] or [rows columns, 3] at counts points, ends included."""
    from scipy.ndimage import map_coordinates  # a quarter of a second, which other pictures do not need

    at = np.meshgrid(*(np.linspace(0, n - 1, m) for n, m in zip(grid, counts)), indexing="ij")
    channels = np.asarray(values, float).reshape(*grid, -1)
    made = [map_coordinates(channels[..., k], at, order=order).ravel() for k in range(channels.shape[-1])]
    return np.stack(made, axis=-1).reshape(-1, *np.shape(values)[1:])


def _cells(counts: tuple[int, int]) -> np.ndarray:
    """[m, 3] triangles of a grid of points, two a cell, as the generator grid has them."""
    number = np.arange(counts[0] * counts[1]).reshape(counts)
    a, b, c, d = (
        number[i : counts[0] - 1 + i, j : counts[1] - 1 + j].ravel() for i in (0, 1) for j in (0, 1)
    )
    return np.stack([a, b, d, a, d, c], axis=1).reshape(-1, 3)


def _sources(grid: tuple[int, int], counts: tuple[int, int], triangles: np.ndarray) -> np.ndarray:
    """[m] the triangle of the grid that the middle of each of `triangles`, of the finer one, lies in."""
    ends = [(n - 1) / (m - 1) for n, m in zip(grid, counts)]
    row, column = np.divmod(triangles, counts[1])
    v, u = row.mean(axis=1) * ends[0], column.mean(axis=1) * ends[1]
    j, i = np.minimum(v.astype(int), grid[0] - 2), np.minimum(u.astype(int), grid[1] - 2)
    return 2 * (j * (grid[1] - 1) + i) + (v - j > u - i)


class GridSplines:
    """Makes frames of a run finer; the first one says which vertices and triangles a body has."""

    def __init__(
        self, record: dict, scene: dict, start: Frame, counts: tuple[int, int], hidden: tuple[str, ...] = ()
    ) -> None:
        """counts: points along columns and along rows. hidden: bodies that may be no grid. Errors: UserError
        where another one is none, or is larger."""
        bodies = np.asarray(start.of_vertices["body"])[: len(start.vertices) - self._obstacles(scene)]
        of_triangles = np.asarray(start.of_triangles["body"])
        self.counts, self.pieces, self.added = (counts[1], counts[0]), [], 0
        for k, name in enumerate(scene["bodies"]):
            grid = None if name in hidden else _grid_of(record, name)
            if grid and (grid[0] > self.counts[0] or grid[1] > self.counts[1]):
                found, needed = (
                    "{} {}".format(*counts),
                    f"{grid[1]} {grid[0]}, as many as {name} has, or more",
                )
                raise UserError(f"--bicubic: found {found}; allowed: {needed}")
            self.pieces.append(Piece(np.flatnonzero(bodies == k), np.flatnonzero(of_triangles == k), grid))
            self.added += self.counts[0] * self.counts[1] - grid[0] * grid[1] if grid else 0

    @staticmethod
    def _obstacles(scene: dict) -> int:
        return sum("vertex" in o for o in scene["obstacles"])

    def scene(self, scene: dict) -> dict:
        """With the vertices that stand for obstacles where finer frames have them."""
        moved = [
            {**o, "vertex": o["vertex"] + self.added} if "vertex" in o else o for o in scene["obstacles"]
        ]
        return {**scene, "obstacles": moved}

    def finer(self, frame: Frame) -> Frame:
        own = sum(len(piece.vertices) for piece in self.pieces)
        number, points, triangles, sources = np.arange(len(frame.vertices)), [], [], []
        fields: dict[str, list] = {name: [] for name in frame.of_vertices}
        first = 0
        for piece in self.pieces:
            made, corners, source = self._piece(frame, piece)
            points.append(made)
            for name, values in frame.of_vertices.items():
                fields[name].append(self._field(np.asarray(values)[piece.vertices], piece, name))
            number[piece.vertices] = first + np.arange(len(piece.vertices))
            triangles.append(first + corners)
            sources.append(source)
            first += len(made)
        source = np.concatenate(sources)
        return Frame(
            np.concatenate([*points, frame.vertices[own:]]),
            np.concatenate(triangles),
            number[frame.edges],
            {n: np.concatenate([*v, np.asarray(frame.of_vertices[n])[own:]]) for n, v in fields.items()},
            {name: np.asarray(values)[source] for name, values in frame.of_triangles.items()},
        )

    def _piece(self, frame: Frame, piece: Piece) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Points, triangles by the numbers of these, and the triangle of the frame that each is of."""
        x = frame.vertices[piece.vertices]
        if piece.grid is None:
            return x, np.searchsorted(piece.vertices, frame.triangles[piece.triangles]), piece.triangles
        corners = _cells(self.counts)
        source = piece.triangles[_sources(piece.grid, self.counts, corners)]
        return _samples(x, piece.grid, self.counts, 3), corners, source

    def _field(self, values: np.ndarray, piece: Piece, name: str) -> np.ndarray:
        """Gaps and loads go straight from vertex to vertex."""
        if piece.grid is None:
            return values
        if name == "body":
            return np.full(self.counts[0] * self.counts[1], values[0])
        return _samples(values, piece.grid, self.counts, 1)
