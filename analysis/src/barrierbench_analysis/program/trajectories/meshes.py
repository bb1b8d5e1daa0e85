"""One frame from a mesh file, as the program reads it."""

from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.mesh_arrays import SUFFIXES, MeshArrays, read_frame_file

from .trajectory import Topology


def read_mesh(path: Path, fields: tuple[str, ...] = ()) -> MeshArrays:
    """Errors: UserError for a file that is not there, of another format, or broken."""
    if path.suffix.lower() not in SUFFIXES:
        raise UserError(f"{path}: extension {path.suffix!r}; allowed: {', '.join(SUFFIXES)}")
    return read_frame_file(path, fields)


def topology_of_mesh(mesh: MeshArrays) -> Topology:
    polygons = int((mesh.sizes > 3).sum())
    return Topology(len(mesh.points), mesh.triangles, mesh.segments, mesh.tetrahedra, polygons)


def same_topology(path: Path, first: MeshArrays, other: MeshArrays) -> None:
    """Errors: UserError with the first difference."""
    if len(first.points) != len(other.points):
        raise UserError(f"{path}: {len(other.points)} vertices; the first frame has {len(first.points)}")
    for names, what in (
        (("sizes", "corners"), "faces"),
        (("segments",), "segments"),
        (("tetrahedra",), "tetrahedra"),
    ):
        if not all(np.array_equal(getattr(first, name), getattr(other, name)) for name in names):
            raise UserError(
                f"{path}: {what} are others than those of the first frame; one topology is needed"
            )
