"""Meshes of other programs as PLY: triangles, lone edges, tetrahedra; and tetrahedra within a closed surface.
The program reads the file (mesh_arrays.py).
"""

import argparse
import sys
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.whole_file import write_whole_bytes

from .arguments import axes_arguments, finite_number, parser_of
from .mesh_arrays import MESHES, MeshArrays, read_body_file
from .tetrahedra import INSTALL, filled

DOC = """IN: of a list of files (.vtm, .pvtu, .pvtp) all its meshes, of a film (USD, Alembic, VTKHDF) the
first frame. OUT.ply has m and z up; of most files lengths are taken as m and z as up."""


def read_cells(
    path: Path, skin: bool = False, unit_m: float | None = None, up: str | None = None
) -> MeshArrays:
    """As read_body_file. Errors: UserError of the reader, and without a tetrahedron and a triangle."""
    found = read_body_file(path, skin, unit_m, up)
    if not len(found.triangles) and not len(found.tetrahedra):
        raise UserError(f"{path}: no tetrahedron and no triangle; at least one of them is needed")
    return found


def ply_bytes(cells: MeshArrays) -> bytes:
    """Binary PLY; coordinates keep every bit."""

    def listed(corners: np.ndarray) -> bytes:
        out = np.empty(len(corners), [("n", "u1"), ("v", "<i4", corners.shape[1])])
        out["n"], out["v"] = corners.shape[1], corners
        return out.tobytes()

    header = "ply\nformat binary_little_endian 1.0\n"
    header += f"element vertex {len(cells.points)}\n" + "".join(f"property double {axis}\n" for axis in "xyz")
    for name, corners in (("face", cells.triangles), ("tetrahedron", cells.tetrahedra)):
        header += f"element {name} {len(corners)}\nproperty list uchar int vertex_indices\n"
    header += f"element edge {len(cells.segments)}\nproperty int vertex1\nproperty int vertex2\nend_header\n"
    body = cells.points.astype("<f8").tobytes() + listed(cells.triangles) + listed(cells.tetrahedra)
    return header.encode() + body + cells.segments.astype("<i4").tobytes()


def parse(argv: list[str]) -> argparse.Namespace:
    parser = parser_of("data mesh", DOC)
    parser.add_argument(
        "source",
        type=Path,
        metavar="IN",
        help=f"one of {', '.join(MESHES)}",
    )
    parser.add_argument("target", type=Path, metavar="OUT.ply")
    axes_arguments(parser, "IN")
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
        "--edge",
        type=finite_number,
        metavar="LENGTH",
        help="with --tetrahedra: about the length of edges within (m)",
    )
    options = parser.parse_args(argv)
    if options.edge is not None and not (options.tetrahedra and 0 < options.edge < float("inf")):
        raise UserError("--edge: a length > 0 (m), and --tetrahedra with it")
    if options.skin and options.tetrahedra:
        raise UserError("--skin and --tetrahedra contradict each other")
    return options


def solid_of(path: Path, surface: MeshArrays, edge: float | None) -> MeshArrays:
    """Tetrahedra within the surface of a file. Errors: UserError, as `filled`; one for lone edges and
    tetrahedra in the file.
    """
    if len(surface.segments) or len(surface.tetrahedra):
        raise UserError(
            f"{path}: {len(surface.segments)} lone edges and {len(surface.tetrahedra)} tetrahedra beside the"
            " triangles; --tetrahedra needs triangles alone"
        )
    points, tetrahedra = filled(path, surface.points, surface.triangles, edge)
    return MeshArrays(points, surface.triangles[:0], surface.segments, tetrahedra, notes=surface.notes)


@reported("data mesh")
def main(argv: list[str]) -> int:
    options = parse(argv)
    if options.target.suffix.lower() != ".ply":
        raise UserError(f"{options.target}: extension {options.target.suffix!r}; allowed: .ply")
    cells = read_cells(options.source, options.skin, options.scale, options.up)
    if options.tetrahedra:
        cells = solid_of(options.source, cells, options.edge)
    write_whole_bytes(options.target, ply_bytes(cells))
    for note in cells.notes:
        more = " (--skin keeps those of the surface)" if "face of tetrahedra" in note else ""
        print(f"bench data mesh: {note}{more}", file=sys.stderr)
    print(
        f"{options.target}: {len(cells.points)} vertices, {len(cells.triangles)} triangles, "
        f"{len(cells.segments)} lone edges, {len(cells.tetrahedra)} tetrahedra"
    )
    return 0
