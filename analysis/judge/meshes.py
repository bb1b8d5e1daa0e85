"""One frame from a mesh file: OBJ, PLY or VTU."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import meshio
import numpy as np

from ..errors import UserError
from ..frames import read_frame
from .obj import read_obj
from .trajectory import Topology, fans, no_cells

Mesh = tuple[np.ndarray, Topology]  # [n, 3] m
CORNERS = {"line": 2, "triangle": 3, "tetra": 4}
POLYGONS = ("quad", "polygon")


def read_foreign(path: Path, reader: Callable) -> Mesh:
    """A file that meshio reads; cells that are no surface, rod or tetrahedron are refused."""
    try:
        mesh = reader(str(path))
    except Exception as error:  # noqa: BLE001 (a reader of foreign files fails in any way)
        why = str(error) or "no reason is given"
        raise UserError(f"{path}: not readable: {type(error).__name__}: {why}") from error
    shape = np.shape(mesh.points)
    if len(shape) != 2 or shape[1] > 3:
        raise UserError(f"{path}: points of shape {shape}; three numbers each are needed")
    points = np.zeros((len(mesh.points), 3))
    points[:, : shape[1]] = mesh.points
    cells = {name: [no_cells(n)] for name, n in CORNERS.items()}
    polygons: list[np.ndarray] = []
    for block in mesh.cells:
        if block.type in CORNERS:
            cells[block.type].append(np.asarray(block.data, np.int64))
        elif block.type.startswith(POLYGONS) and "quad8" not in block.type:
            polygons += [np.asarray(corners, np.int64) for corners in block.data]
        elif block.type != "vertex":
            raise UserError(
                f"{path}: cells of type {block.type}; allowed, of first order: line, triangle, quad, polygon,"
                " tetra"
            )
    triangles = np.concatenate([*cells["triangle"], fans(polygons)])
    lines, tetrahedra = np.concatenate(cells["line"]), np.concatenate(cells["tetra"])
    return points, Topology(len(points), triangles, lines, tetrahedra, len(polygons))


def read_ply(path: Path) -> Mesh:
    """As this program writes it, with numbers at faces, which meshio does not read; else as meshio does."""
    try:
        frame = read_frame(path)
    except UserError:
        return read_foreign(path, meshio.ply.read)
    triangles, lines = (np.asarray(cells, np.int64) for cells in (frame.triangles, frame.edges))
    points = frame.vertices.astype(float)
    return points, Topology(len(points), triangles, lines, no_cells(4))


MESHES: dict[str, Callable[[Path], Mesh]] = {
    ".obj": read_obj,
    ".ply": read_ply,
    ".vtu": lambda path: read_foreign(path, meshio.vtu.read),
}


def read_mesh(path: Path) -> Mesh:
    """Errors: UserError for a file that is not there, of another format, or broken."""
    reader = MESHES.get(path.suffix.lower())
    if reader is None:
        raise UserError(f"{path}: extension {path.suffix!r}; allowed: {', '.join(MESHES)}")
    if not path.is_file():
        raise UserError(f"{path}: no such file")
    return reader(path)


def same_topology(path: Path, first: Topology, other: Topology) -> None:
    """Errors: UserError with the first difference."""
    if first.n_vertices != other.n_vertices:
        raise UserError(f"{path}: {other.n_vertices} vertices; the first frame has {first.n_vertices}")
    for name in ("triangles", "segments", "tetrahedra"):
        if not np.array_equal(getattr(first, name), getattr(other, name)):
            raise UserError(
                f"{path}: {name} are others than those of the first frame; one topology is needed"
            )
