"""Meshes of Gmsh (MSH 2.2 and 4.1) and of VTK (VTU) as PLY that the program reads: triangles, lone edges,
tetrahedra; and tetrahedra within a closed surface.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path
from typing import NamedTuple

import meshio
import numpy as np

from .errors import UserError, tells
from .front.arguments import parser_of
from .tetrahedra import INSTALL, filled
from .whole_file import write_whole_bytes

READERS = {".msh": meshio.gmsh.read, ".vtu": meshio.vtu.read}
SURFACES = {**READERS, ".ply": meshio.ply.read, ".obj": meshio.obj.read, ".stl": meshio.stl.read}
KEPT = {"line": 2, "triangle": 3, "tetra": 4}  # cells and their corners
IGNORED = {"vertex"}  # points that a geometry names


class Cells(NamedTuple):
    """Vertices in m; corners 0-based."""

    points: np.ndarray  # [n, 3]
    lines: np.ndarray  # [n, 2]
    triangles: np.ndarray  # [n, 3]
    tetrahedra: np.ndarray  # [n, 4]


def read_cells(path: Path, readers: dict = READERS) -> Cells:
    """readers: extension -> function of meshio. Errors: UserError for a format that is not read here, a file
    that is none, and cells that the program has not.
    """
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise UserError(f"{path}: extension {path.suffix!r}; allowed: {', '.join(readers)}")
    if not path.is_file():
        raise UserError(f"{path}: no such file")
    try:
        mesh = reader(str(path))
    except Exception as error:  # noqa: BLE001 (a reader of foreign files fails in any way)
        raise UserError(f"{path}: no mesh that meshio can read: {error or type(error).__name__}") from error
    found = {
        name: np.concatenate([block.data for block in mesh.cells if block.type == name])
        for name in KEPT
        if name in mesh.cells_dict
    }
    others = sorted({block.type for block in mesh.cells} - set(KEPT) - IGNORED)
    if others:
        raise UserError(
            f"{path}: cells of type {', '.join(others)}; allowed: {', '.join(KEPT)} (of first order)"
        )
    if "triangle" not in found and "tetra" not in found:
        raise UserError(f"{path}: no tetrahedron and no triangle; at least one of them is needed")
    lists = {name: found.get(name, np.empty((0, n))).astype(np.int64) for name, n in KEPT.items()}
    points = np.zeros((len(mesh.points), 3))
    points[:, : mesh.points.shape[1]] = mesh.points
    return checked(path, Cells(points, lists["line"], lists["triangle"], lists["tetra"]))


def checked(path: Path, cells: Cells) -> Cells:
    """Errors: UserError for a corner that is no vertex, and for the first tetrahedron that is flat or
    inverted.
    """
    for name, corners in (("line", cells.lines), ("triangle", cells.triangles), ("tetra", cells.tetrahedra)):
        wrong = np.flatnonzero(((corners < 0) | (corners >= len(cells.points))).any(axis=1))
        if len(wrong):
            raise UserError(
                f"{path}: {name} {wrong[0]} with corners {corners[wrong[0]].tolist()}; "
                f"allowed: 0 to {len(cells.points) - 1}"
            )
    x = cells.points[cells.tetrahedra]
    volumes = np.einsum("ni,ni->n", x[:, 3] - x[:, 0], np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])) / 6
    wrong = np.flatnonzero(~(volumes > 0))
    if len(wrong):
        raise UserError(f"{path}: tetrahedron {wrong[0]} of {volumes[wrong[0]]:g} m^3; allowed: volume > 0")
    return cells


def sharers_of(corners: np.ndarray, cells: np.ndarray, choices: list[tuple[int, ...]]) -> np.ndarray:
    """Of each row of `corners`, how many cells have it, in any order, as a choice of their corners."""
    faces = (
        np.concatenate([cells[:, list(choice)] for choice in choices])
        if len(cells)
        else np.empty((0, corners.shape[1]))
    )
    known = Counter(tuple(face) for face in np.sort(faces, axis=1).tolist())
    return np.array([known[tuple(row)] for row in np.sort(corners, axis=1).tolist()], int)


def without_sides(cells: Cells, skin: bool) -> Cells:
    """Without the triangles that are faces of tetrahedra (as a skin, those of one tetrahedron stay), and the
    lines that are sides of what there is.
    """
    sharers = sharers_of(cells.triangles, cells.tetrahedra, [(0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)])
    triangles = cells.triangles[(sharers == 0) | (skin & (sharers == 1))]
    sides = sharers_of(cells.lines, cells.triangles, [(0, 1), (0, 2), (1, 2)])
    edges = sharers_of(cells.lines, cells.tetrahedra, [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)])
    return cells._replace(triangles=triangles, lines=cells.lines[sides + edges == 0])


def without_loose_points(cells: Cells) -> Cells:
    """Without the vertices of no cell, which would have no mass."""
    lists = (cells.lines, cells.triangles, cells.tetrahedra)
    used = np.unique(np.concatenate([corners.ravel() for corners in lists]))
    number = np.zeros(len(cells.points), np.int64)
    number[used] = np.arange(len(used))
    return Cells(cells.points[used], *(number[corners] for corners in lists))


def ply_bytes(cells: Cells) -> bytes:
    """Binary PLY; coordinates keep every bit."""

    def listed(corners: np.ndarray) -> bytes:
        out = np.empty(len(corners), [("n", "u1"), ("v", "<i4", corners.shape[1])])
        out["n"], out["v"] = corners.shape[1], corners
        return out.tobytes()

    header = "ply\nformat binary_little_endian 1.0\n"
    header += f"element vertex {len(cells.points)}\n" + "".join(f"property double {axis}\n" for axis in "xyz")
    for name, corners in (("face", cells.triangles), ("tetrahedron", cells.tetrahedra)):
        header += f"element {name} {len(corners)}\nproperty list uchar int vertex_indices\n"
    header += f"element edge {len(cells.lines)}\nproperty int vertex1\nproperty int vertex2\nend_header\n"
    body = cells.points.astype("<f8").tobytes() + listed(cells.triangles) + listed(cells.tetrahedra)
    return header.encode() + body + cells.lines.astype("<i4").tobytes()


def parse(argv: list[str]) -> argparse.Namespace:
    parser = parser_of("mesh", "Lengths are taken as m.")
    parser.add_argument(
        "source",
        type=Path,
        metavar="IN",
        help=f"one of {', '.join(READERS)}; with --tetrahedra of {', '.join(SURFACES)}",
    )
    parser.add_argument("target", type=Path, metavar="OUT.ply")
    parser.add_argument(
        "--skin",
        action="store_true",
        help="keep triangles that are faces of tetrahedra, as a membrane on the solid",
    )
    parser.add_argument(
        "--tetrahedra",
        action="store_true",
        help="fill the closed surface IN, which stays as it is, by TetGen (AGPL-3.0;"
        f" {INSTALL} installs it); a surface within another is filled too",
    )
    parser.add_argument(
        "--edge", type=float, metavar="LENGTH", help="with --tetrahedra: about the length of edges within (m)"
    )
    options = parser.parse_args(argv)
    if options.edge is not None and not (options.tetrahedra and 0 < options.edge < float("inf")):
        raise UserError("--edge: a length > 0 (m), and --tetrahedra with it")
    if options.skin and options.tetrahedra:
        raise UserError("--skin and --tetrahedra contradict each other")
    return options


def solid_of(path: Path, edge: float | None) -> Cells:
    """Tetrahedra within the surface in a file. Errors: UserError, as read_cells and `filled`; one for lone
    edges and tetrahedra in the file.
    """
    surface = read_cells(path, SURFACES)
    if len(surface.lines) or len(surface.tetrahedra):
        raise UserError(
            f"{path}: {len(surface.lines)} lone edges and {len(surface.tetrahedra)} tetrahedra beside the"
            " triangles; --tetrahedra needs triangles alone"
        )
    points, tetrahedra = filled(path, surface.points, surface.triangles, edge)
    return checked(path, Cells(points, surface.lines, surface.triangles[:0], tetrahedra))


@tells("mesh")
def main(argv: list[str]) -> int:
    options = parse(argv)
    if options.target.suffix.lower() != ".ply":
        raise UserError(f"{options.target}: extension {options.target.suffix!r}; allowed: .ply")
    given = solid_of(options.source, options.edge) if options.tetrahedra else read_cells(options.source)
    cells = without_loose_points(without_sides(given, options.skin))
    write_whole_bytes(options.target, ply_bytes(cells))
    dropped = len(given.triangles) - len(cells.triangles)
    if dropped:
        print(
            f"bench mesh: {dropped} triangles are faces of tetrahedra and were left out (--skin keeps them)",
            file=sys.stderr,
        )
    print(
        f"{options.target}: {len(cells.points)} vertices, {len(cells.triangles)} triangles, "
        f"{len(cells.lines)} lone edges, {len(cells.tetrahedra)} tetrahedra"
    )
    return 0
