"""A trajectory as it is judged: topology once, positions frame after frame."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from barrierbench_analysis.io.axes import OURS, Axes
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.film_files.film import Step
from barrierbench_analysis.program.mesh_arrays import MESHES, MeshArrays, read_frame_file

MOST_METRES = 1e15  # that the program takes of reach, thickness and obstacles


@dataclass(frozen=True)
class Topology:
    """Corners are 0-based numbers of vertices. `polygons`: how many were cut into triangles."""

    n_vertices: int
    triangles: np.ndarray  # [n, 3]
    segments: np.ndarray  # [n, 2] of rods
    tetrahedra: np.ndarray  # [n, 4]
    polygons: int = 0
    names: tuple[str, ...] = ()  # of bodies, in the order of their vertices
    first_vertex: tuple[int, ...] = ()  # [bodies] ascending

    def body_of_vertices(self) -> np.ndarray:
        """[n_vertices] number of the body."""
        return np.searchsorted(np.array(self.first_vertex), np.arange(self.n_vertices), side="right") - 1


@dataclass(frozen=True)
class Trajectory:
    """`frames` reads [n_vertices, 3] anew by every call, of a reader in the unit and axes of the file, of
    read_trajectory in m with z up. Errors of it: UserError with the file.
    """

    topology: Topology
    frames: Callable[[], Iterator[np.ndarray]]
    labels: list[str]  # of the frames: files, or numbers in a file
    source: str
    format: str
    times_s: list[float] | None = None
    obstacles: list[dict] = field(default_factory=list)  # as barrierbench.subject/1 has them
    planar: bool = False
    notes: tuple[str, ...] = ()
    half_thickness_m: np.ndarray | None = None  # [n_vertices], where the frames themselves say it
    heard: Iterable[str] = ()  # notes that come while the frames are read
    files: list[list[Path | Step]] | None = None  # of every frame, its parts, where they are meshes
    displacement: str | None = None  # the field that is added to points at rest
    frame_numbers: list[float] | None = None  # times in frames of the program that wrote them, not in seconds
    axes: Axes = OURS  # of the file


def no_cells(n: int) -> np.ndarray:
    return np.zeros((0, n), np.int64)


def has_cells(topology: Topology) -> bool:
    return any(len(cells) for cells in (topology.triangles, topology.segments, topology.tetrahedra))


def surface_of(topology: Topology) -> np.ndarray:
    """[n, 3] the triangles, and the faces of exactly one tetrahedron that are none of them."""
    if not len(topology.tetrahedra):
        return topology.triangles
    t = topology.tetrahedra
    faces = np.concatenate([t[:, [1, 2, 3]], t[:, [0, 3, 2]], t[:, [0, 1, 3]], t[:, [0, 2, 1]]])
    keys = np.concatenate([np.sort(faces, axis=1), np.sort(topology.triangles, axis=1)])
    _, first, count = np.unique(keys, axis=0, return_index=True, return_counts=True)
    alone = np.sort(first[(count == 1) & (first < len(faces))])
    return np.concatenate([topology.triangles, faces[alone]])


def with_parts(topology: Topology) -> tuple[Topology, tuple[str, ...]]:
    """With its connected parts as bodies "part 0", ..., and a note where that cannot be: the vertices of a
    part are not one after the other.
    """
    if topology.names:
        return topology, ()
    pairs = np.concatenate(
        [
            cells[:, [0, k]]
            for cells in (topology.triangles, topology.segments, topology.tetrahedra)
            for k in range(1, cells.shape[1])
        ]
    )
    ones = np.ones(len(pairs), bool)
    graph = coo_matrix((ones, (pairs[:, 0], pairs[:, 1])), shape=(topology.n_vertices,) * 2)
    _, part = connected_components(graph, directed=False)
    starts = np.flatnonzero(np.diff(part, prepend=-1))
    if len(starts) != part.max() + 1:
        note = 'the vertices of connected parts are not one after the other: all are one body, "surface"'
        return replace(topology, names=("surface",), first_vertex=(0,)), (note,)
    names = tuple(f"part {k}" for k in range(len(starts))) if len(starts) > 1 else ("surface",)
    return replace(topology, names=names, first_vertex=tuple(starts.tolist())), ()


def checked(trajectory: Trajectory) -> Trajectory:
    """Errors: UserError where a corner is no vertex or a cell has a corner twice, and without anything that
    could cross.
    """
    t = trajectory.topology
    for name in ("triangles", "segments", "tetrahedra"):
        cells = getattr(t, name)
        wrong = ((cells < 0) | (cells >= t.n_vertices)).any(axis=1)
        wrong |= (np.diff(np.sort(cells, axis=1), axis=1) == 0).any(axis=1)
        if wrong.any():
            k = int(np.flatnonzero(wrong)[0])
            raise UserError(
                f"{trajectory.source}: {name}[{k}] has the corners {cells[k].tolist()}; allowed: different "
                f"numbers from 0 to {t.n_vertices - 1}"
            )
    if not has_cells(t) and not trajectory.obstacles:
        raise UserError(
            f"{trajectory.source}: no triangle, rod, tetrahedron or obstacle; at least one is needed, or "
            "nothing can be judged (topology from another file: --topology; from JSON: --about)"
        )
    return trajectory


# --- times


def increasing(times_s: Sequence[float], place: Callable[[int], str]) -> list[float]:
    """The times. place: file and place of the k-th. Errors: UserError for the first that is not finite or not
    above the one before.
    """
    times = [float(t) for t in times_s]
    for k, t in enumerate(times):
        if not np.isfinite(t):
            raise UserError(f"{place(k)}: found the time {t}; a finite number is needed")
        if k and t <= times[k - 1]:
            raise UserError(
                f"{place(k)}: found the time {t!r} s after {times[k - 1]!r} s; a later one is needed"
            )
    return times


# --- meshes


def read_mesh(path: Path | Step, fields: tuple[str, ...] = ()) -> MeshArrays:
    """Errors: UserError for a file that is not there, of another format, or broken."""
    if path.suffix.lower() not in MESHES:
        raise UserError(f"{path}: extension {path.suffix!r}; allowed: {', '.join(MESHES)}")
    return read_frame_file(path, fields)


def topology_of_mesh(mesh: MeshArrays) -> Topology:
    polygons = int((mesh.sizes > 3).sum())
    return Topology(len(mesh.points), mesh.triangles, mesh.segments, mesh.tetrahedra, polygons)


def same_topology(path: Path | Step, first: MeshArrays, other: MeshArrays) -> None:
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
