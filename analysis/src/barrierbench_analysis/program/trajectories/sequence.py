"""Trajectories of one or more meshes a frame: files, or bodies of a film.

The topology is that of the first frame; one of another topology is refused by name.
"""

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.film_files.film import Step
from barrierbench_analysis.program.mesh_arrays import MeshArrays

from .trajectory import Topology, Trajectory, read_mesh, same_topology, topology_of_mesh

Place = Callable[[MeshArrays], np.ndarray]  # of a part: where its vertices are

# How meshes of analytic obstacles beside frames are called (frames_out): one, or one a frame where they move.
OBSTACLES = re.compile(r"obstacles(_\d+)?")


def of_obstacles(path: Path) -> bool:
    return OBSTACLES.fullmatch(path.stem) is not None


def no_frames(names: list[str]) -> tuple[str, ...]:
    """Notes on meshes of obstacles, which are coarser than what they stand for."""
    return tuple(f"{name} is no frame: obstacles are given by --about" for name in sorted(set(names)))


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
            raise UserError(f"{path}: found no frame number in its name; one of {len(paths)} frames")
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


def joined(parts: list[Topology]) -> Topology:
    """One after the other: vertices are counted on from part to part."""
    before = np.cumsum([0, *(part.n_vertices for part in parts)])

    def cells(name: str) -> np.ndarray:
        return np.concatenate([getattr(part, name) + n for part, n in zip(parts, before)])

    polygons = sum(part.polygons for part in parts)
    return Topology(int(before[-1]), cells("triangles"), cells("segments"), cells("tetrahedra"), polygons)


def of_files(paths: list[Path], source: str) -> Trajectory:
    """A file a frame."""
    return of_parts([[path] for path in paths], source, paths[0].suffix.lower()[1:])


class Notes:
    """What files have and no mesh, reported once for all files of one kind."""

    def __init__(self) -> None:
        self.first: dict[str, str] = {}
        self.files: dict[str, set[Path | Step]] = {}

    def hear(self, path: Path | Step, mesh: MeshArrays) -> None:
        for note in mesh.notes:
            kind = note.split(": ")[0]
            self.first.setdefault(kind, note)
            self.files.setdefault(kind, set()).add(path)

    def __iter__(self) -> Iterator[str]:
        for kind, note in self.first.items():
            more = len(self.files[kind]) - 1
            yield f"{note}, and so in {more} more files" if more else note


def read_parts(
    frames: list[list[Path | Step]], first: list[MeshArrays], fields: list[tuple[str, ...]], notes: Notes
) -> Iterator[list[MeshArrays]]:
    """The parts of every frame. Errors: UserError for the first that has another topology."""
    for paths in frames:
        parts = []
        for path, known, wanted in zip(paths, first, fields):
            part = read_mesh(path, wanted)
            same_topology(path, known, part)
            notes.hear(path, part)
            parts.append(part)
        yield parts


def of_parts(
    frames: list[list[Path | Step]], source: str, kind: str, times_s: list[float] | None = None
) -> Trajectory:
    """A list of meshes a frame, as many in each."""
    first, notes = [read_mesh(path) for path in frames[0]], Notes()
    none = [()] * len(first)

    def read() -> Iterator[np.ndarray]:
        for parts in read_parts(frames, first, none, notes):
            yield np.concatenate([part.points for part in parts])

    topology = joined([topology_of_mesh(part) for part in first])
    labels = [_label(paths) for paths in frames]
    return Trajectory(topology, read, labels, source, kind, times_s, heard=notes, files=frames)


def _label(paths: list[Path | Step]) -> str:
    more = f" and {len(paths) - 1} more" if len(paths) > 1 else ""
    return f"{paths[0].name}{more}"
