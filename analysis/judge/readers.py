"""Trajectories of any program from files: sequences of OBJ, PLY or VTU, PVD, PC2, NPZ, and runs of
barrierbench.

The topology is that of the first frame; one of another topology is refused by name.
"""

from __future__ import annotations

import re
import struct
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import meshio
import numpy as np

from ..errors import UserError
from ..frames import frame_paths, frames_of, read_scene
from ..play.film import times_of
from ..record_file import read_record
from .obj import read_obj
from .trajectory import Topology, Trajectory, fans, no_cells

Mesh = tuple[np.ndarray, Topology]  # [n, 3] m
CORNERS = {"line": 2, "triangle": 3, "tetra": 4}
POLYGONS = ("quad", "polygon")
PC2_HEADER = struct.Struct("<12siiffi")


def read_foreign(path: Path, reader: Callable) -> Mesh:
    """A file that meshio reads; cells that are no surface, rod or tetrahedron are refused."""
    try:
        mesh = reader(str(path))
    except Exception as error:  # noqa: BLE001 (a reader of foreign files fails in any way)
        raise UserError(f"{path}: not readable: {error or type(error).__name__}") from error
    points = np.zeros((len(mesh.points), 3))
    points[:, : mesh.points.shape[1]] = mesh.points
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


MESHES: dict[str, Callable[[Path], Mesh]] = {
    ".obj": read_obj,
    ".ply": partial(read_foreign, reader=meshio.ply.read),
    ".vtu": partial(read_foreign, reader=meshio.vtu.read),
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


# --- one file a frame


def numbered(paths: list[Path]) -> list[Path]:
    """In the order of the last number in their names. Errors: UserError for two with one number, and for a
    sequence with holes.
    """
    if len(paths) < 2:
        return paths
    number = {}
    for path in sorted(paths):
        found = re.findall(r"\d+", path.stem)
        if not found:
            raise UserError(f"{path}: no number in the name of one of {len(paths)} frames")
        if int(found[-1]) in number:
            raise UserError(f"{path}: has the number of {number[int(found[-1])].name}")
        number[int(found[-1])] = path
    order = sorted(number)
    steps = np.diff(order)
    if len(set(steps)) > 1:
        k = int(np.flatnonzero(steps > steps.min())[0])
        raise UserError(
            f"{paths[0].parent}: no frame between {number[order[k]].name} and {number[order[k + 1]].name}; "
            f"numbers in even steps (here {steps.min()}) are needed"
        )
    return [number[k] for k in order]


def of_files(paths: list[Path], source: str, times_s: list[float] | None = None) -> Trajectory:
    _, topology = read_mesh(paths[0])

    def frames() -> Iterator[np.ndarray]:
        for path in paths:
            points, other = read_mesh(path)
            same_topology(path, topology, other)
            yield points

    labels = [path.name for path in paths]
    return Trajectory(topology, frames, labels, source, paths[0].suffix.lower()[1:], times_s)


def of_folder(folder: Path) -> Trajectory:
    """All files of the one format of frames that is there."""
    found = {suffix: sorted(folder.glob(f"*{suffix}")) for suffix in MESHES}
    there = [suffix for suffix, paths in found.items() if paths]
    if len(there) != 1:
        have = ", ".join(there) or "none of them"
        raise UserError(f"{folder}: found {have}; frames of one of {', '.join(MESHES)} are needed")
    return of_files(numbered(found[there[0]]), str(folder))


def of_pvd(path: Path) -> Trajectory:
    """The VTU files that a collection of ParaView names, with their times."""
    try:
        sets = ElementTree.parse(path).getroot().findall("Collection/DataSet")
        rows = sorted((float(one.get("timestep", k)), one.attrib["file"]) for k, one in enumerate(sets))
    except (ElementTree.ParseError, KeyError, ValueError) as error:
        raise UserError(f"{path}: not a collection of ParaView: {error}") from None
    if not rows:
        raise UserError(f"{path}: names no file; <Collection> with <DataSet timestep= file=> is needed")
    trajectory = of_files([path.parent / name for _, name in rows], str(path), [t for t, _ in rows])
    return Trajectory(**{**trajectory.__dict__, "format": "pvd"})


# --- one file for all frames


def topology_beside(path: Path, topology: Path | None, n_vertices: int) -> Topology:
    """Of a file without any: from the mesh that --topology names, else only what --about adds."""
    if topology is None:
        return Topology(n_vertices, no_cells(3), no_cells(2), no_cells(4))
    _, found = read_mesh(topology)
    if found.n_vertices != n_vertices:
        raise UserError(f"{topology}: {found.n_vertices} vertices; the frames of {path} have {n_vertices}")
    return found


def of_pc2(path: Path, topology: Path | None) -> Trajectory:
    """Float32 positions, as Blender's cache has them."""
    data = path.read_bytes()
    if len(data) < PC2_HEADER.size or not data.startswith(b"POINTCACHE2\0"):
        raise UserError(f"{path}: not a PC2 file (POINTCACHE2)")
    _, version, points, _, _, samples = PC2_HEADER.unpack_from(data)
    wanted = PC2_HEADER.size + 12 * points * samples
    if version != 1 or points < 1 or samples < 1 or len(data) != wanted:
        raise UserError(
            f"{path}: version {version}, {samples} samples of {points} points, {len(data)} bytes; "
            f"version 1 and {wanted} bytes are needed"
        )
    states = np.frombuffer(data, "<f4", offset=PC2_HEADER.size).reshape(samples, points, 3)
    found = topology_beside(path, topology, points)
    note = ("positions are float32 in the file: the states that were judged are the rounded ones",)
    labels = [f"sample {k}" for k in range(samples)]
    return Trajectory(found, lambda: map(np.float64, states), labels, str(path), "pc2", notes=note)


def of_npz(path: Path, topology: Path | None) -> Trajectory:
    """`positions` [frames, n, 3]; `triangles`, `segments`, `tetrahedra` and `times_s` where there are any."""
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except (OSError, ValueError) as error:
        raise UserError(f"{path}: not an NPZ file: {error}") from None
    x = arrays.get("positions")
    if x is None or x.ndim != 3 or x.shape[2] != 3 or not len(x) or x.dtype.kind != "f":
        found = "no `positions`" if x is None else f"`positions` of shape {x.shape} and type {x.dtype}"
        raise UserError(f"{path}: {found}; floats [frames, vertices, 3] in m are needed")
    cells = {}
    for name, n in (("triangles", 3), ("segments", 2), ("tetrahedra", 4)):
        cells[name] = arrays.get(name, no_cells(n))
        if cells[name].ndim != 2 or cells[name].shape[1] != n or cells[name].dtype.kind not in "iu":
            raise UserError(f"{path}: `{name}` of shape {cells[name].shape}; integers [n, {n}] are needed")
    found = Topology(x.shape[1], *(c.astype(np.int64) for c in cells.values()))
    if not any(map(len, cells.values())):
        found = topology_beside(path, topology, x.shape[1])
    times = arrays.get("times_s")
    if times is not None and times.shape != (len(x),):
        raise UserError(f"{path}: `times_s` of shape {times.shape}; one a frame ({len(x)}) is needed")
    labels = [f"frame {k}" for k in range(len(x))]
    return Trajectory(
        found, lambda: map(np.float64, x), labels, str(path), "npz", None if times is None else times.tolist()
    )


# --- runs of this program


def of_run(folder: Path) -> Trajectory:
    """The frames that a record names, with the run's bodies and obstacles."""
    record = read_record(folder / "run.json")
    paths, scene = frame_paths(record, folder), read_scene(record, folder)
    steps = list(paths)
    start = next(frames_of(record, folder, steps[:1]))
    body = start.of_vertices["body"]
    own = len(body) - sum("vertex" in o for o in scene["obstacles"])
    first = np.flatnonzero(np.diff(body[:own], prepend=-1))
    topology = Topology(
        len(start.vertices),
        np.asarray(start.triangles, np.int64),
        np.asarray(start.edges, np.int64),
        no_cells(4),
        names=tuple(scene["bodies"][k] for k in body[first]),
        first_vertex=tuple(first.tolist()),
    )
    obstacles = [
        {
            key: o[key]
            for key in ("name", "kind", "point_m", "axis", "radius_m", "inside", "vertex")
            if key in o
        }
        for o in scene["obstacles"]
    ]
    return Trajectory(
        topology,
        lambda: (frame.vertices.astype(float) for frame in frames_of(record, folder, steps)),
        [paths[step].name for step in steps],
        str(folder),
        "run of barrierbench",
        times_of(record, steps, folder),
        obstacles,
        scene["planar"],
    )


def read_trajectory(path: Path, topology: Path | None = None) -> Trajectory:
    """By what the path is. Errors: UserError that names the file, what was found and what is allowed."""
    if not path.exists():
        raise UserError(f"{path}: no such file or folder")
    if path.is_dir():
        return of_run(path) if (path / "run.json").is_file() else of_folder(path)
    suffix = path.suffix.lower()
    if suffix in (".pc2", ".npz"):
        return {".pc2": of_pc2, ".npz": of_npz}[suffix](path, topology)
    if suffix == ".pvd":
        return of_pvd(path)
    if suffix in MESHES:
        return of_files([path], str(path))
    raise UserError(
        f"{path}: extension {suffix!r}; allowed: a folder of frames ({', '.join(MESHES)}) or of a run, "
        f".pvd, .pc2, .npz, or one frame"
    )
