"""Trajectories of any program by what their path is: a folder of frames, PVD, PC2, MDD, NPZ, USD, Alembic,
VTKHDF, one frame, or a run of barrierbench.
"""

from collections import defaultdict
from dataclasses import replace
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.axes import OURS, chosen, sentence
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.frames import frame_paths, frames_of, read_scene, times_of
from barrierbench_analysis.io.record_file import read_record
from barrierbench_analysis.program.file_lists import LISTS
from barrierbench_analysis.program.film_files.formats import FILMS
from barrierbench_analysis.program.mesh_arrays import SUFFIXES

from .arrays import of_npz
from .displacement import displaced
from .films import of_film
from .packed import of_mdd, of_pc2
from .pvd import of_list, of_pvd
from .sequence import no_frames, numbered, of_files, of_obstacles
from .trajectory import Topology, Trajectory, has_cells, increasing, no_cells, read_mesh, topology_of_mesh

RUN = "run of barrierbench"  # the format of one
CACHES = {".pc2": of_pc2, ".mdd": of_mdd}  # one file for all frames, without cells

# --- folders


def of_folder(folder: Path) -> Trajectory:
    """All files of the one format of frames that is there, by a collection (.pvd) where one is; or one PC2
    and the mesh of its name. The obstacles beside them, as `bench data frames` writes them, are no frame.
    """
    known = (*SUFFIXES, *LISTS, *CACHES, *FILMS, ".pvd")
    every = [p for p in sorted(folder.iterdir()) if p.suffix.lower() in known]
    files = [p for p in every if not p.name.startswith(".")]
    frames = [p for p in files if not of_obstacles(p) or p.suffix.lower() not in (*SUFFIXES, *FILMS)] or files
    found = _of_frames(folder, frames)
    notes = [
        note for note in no_frames([p.name for p in files if p not in frames]) if note not in found.notes
    ]
    if hidden := len(every) - len(files):
        notes.append(f"{hidden} files whose names begin with a dot are no frames")
    return replace(found, notes=(*found.notes, *notes))


def _of_frames(folder: Path, files: list[Path]) -> Trajectory:
    found: dict[str, list[Path]] = defaultdict(list)
    for path in files:
        found[path.suffix.lower()].append(path)
    if any(found[suffix] for suffix in FILMS):
        return _of_only_film(folder, files)
    if any(found[suffix] for suffix in CACHES):
        return _of_cache_folder(folder, [path for paths in found.values() for path in paths])
    there = [suffix for suffix in (*SUFFIXES, *LISTS) if found[suffix]]
    if found[".pvd"] and set(there) <= {".vtu", ".vtp", *LISTS}:
        return _of_collection(folder, found[".pvd"])
    lists = [suffix for suffix in LISTS if found[suffix]]
    if len(lists) == 1 and set(there) <= {*lists, ".vtu", ".vtp"}:  # and the files that they name
        return of_list(numbered(found[lists[0]]), str(folder))
    if len(there) != 1:
        have = ", ".join(there) or "none of them"
        raise UserError(
            f"{folder}: found {have}; frames of one of {', '.join((*SUFFIXES, *LISTS))} are needed"
        )
    return of_files(numbered(found[there[0]]), str(folder))


def _of_only_film(folder: Path, files: list[Path]) -> Trajectory:
    """Errors: UserError for a film beside anything else that could be frames."""
    film = next(path for path in files if path.suffix.lower() in FILMS)
    if len(files) > 1:
        names = ", ".join(path.name for path in files)
        raise UserError(f"{folder}: found {names}; one film is needed, or say which: ./bench judge {film}")
    return of_film(film)


def _of_collection(folder: Path, collections: list[Path]) -> Trajectory:
    if len(collections) > 1:
        names = ", ".join(path.name for path in collections)
        raise UserError(f"{folder}: found {names}; one collection is needed: ./bench judge {collections[0]}")
    return of_pvd(collections[0])


def _of_cache_folder(folder: Path, files: list[Path]) -> Trajectory:
    """As `bench data frames --format pc2` writes it. Errors: UserError for anything else that could be
    frames."""
    cache = next(path for path in files if path.suffix.lower() in CACHES)
    meshes = [path for path in files if path.suffix.lower() in SUFFIXES and path.stem == cache.stem]
    if len(files) > 2 or len(files) - 1 != len(meshes):
        mesh = meshes[0] if meshes else "MESH"
        names = ", ".join(path.name for path in files)
        raise UserError(
            f"{folder}: found {names}; one {cache.suffix} and one mesh of its name are needed, or say which:"
            f" ./bench judge {cache} --topology {mesh}"
        )
    found = CACHES[cache.suffix.lower()](cache)
    return replace(found, topology=topology_of(meshes[0], found)) if meshes else found


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
    cells = *(np.asarray(of, np.int64) for of in (start.triangles, start.edges)), no_cells(4)
    names = tuple(scene["bodies"][k] for k in body[first])
    topology = Topology(len(start.vertices), *cells, names=names, first_vertex=tuple(first.tolist()))
    kept = "name kind point_m axis radius_m inside vertex".split()
    obstacles = [{key: o[key] for key in kept if key in o} for o in scene["obstacles"]]
    place = f"{folder}/run.json#/steps of "
    return Trajectory(
        topology,
        lambda: (frame.vertices.astype(float) for frame in frames_of(record, folder, steps)),
        [paths[step].name for step in steps],
        str(folder),
        RUN,
        increasing(times_of(record, steps, folder), lambda k: f"{place}{paths[steps[k]].name}"),
        obstacles,
        scene["planar"],
        half_thickness_m=_half_thickness(record, topology),
    )


def _half_thickness(record: dict, topology: Topology) -> np.ndarray | None:
    """[n_vertices] m, the offsets of the bodies; None where all are 0. Obstacles that move have none."""
    bodies = record["config"]["scene"].get("bodies", [])
    offsets = {body["name"]: body.get("offset_m", 0.0) for body in bodies}
    if not any(offsets.values()):
        return None
    of_body = np.array([offsets.get(name, 0.0) for name in topology.names])
    return of_body[topology.body_of_vertices()]


# --- any


def topology_of(mesh: Path, trajectory: Trajectory) -> Topology:
    """For frames without cells. Errors: UserError where they have some, or other vertices."""
    have, n = trajectory.topology, trajectory.topology.n_vertices
    if has_cells(have) or have.names:
        raise UserError(
            f"--topology {mesh}: the frames of {trajectory.source} have cells of their own; allowed: for "
            "frames without any (.pc2, .mdd, .npz, points of USD and Alembic)"
        )
    found = topology_of_mesh(read_mesh(mesh))
    if found.n_vertices != n:
        raise UserError(f"{mesh}: {found.n_vertices} vertices; the frames of {trajectory.source} have {n}")
    return found


def _of_path(path: Path) -> Trajectory:
    if not path.exists():
        raise UserError(f"{path}: no such file or folder")
    if path.is_dir():
        return of_run(path) if (path / "run.json").is_file() else of_folder(path)
    suffix = path.suffix.lower()
    if reader := {**CACHES, ".npz": of_npz, ".pvd": of_pvd}.get(suffix):
        return reader(path)
    if suffix in FILMS:
        return of_film(path)
    if suffix in SUFFIXES:
        return of_files([path], str(path))
    if suffix in LISTS:
        return of_list([path], str(path))
    frames = ", ".join((*SUFFIXES, *LISTS))
    raise UserError(
        f"{path}: extension {suffix!r}; allowed: a folder of frames ({frames}) or of a run, .pvd,"
        f" {', '.join((*CACHES, *FILMS))}, .npz, or one frame{HINTS.get(suffix, '')}"
    )


# What other programs write, and how it becomes something that is read.
OF_BLENDER = ". Blender exports it as USD, Alembic, PC2 or MDD, or as OBJ frames"
OF_HOUDINI = ". Houdini writes OBJ or PLY frames (ROP Geometry Output)"
OF_PARAVIEW = ". ParaView writes it as VTU frames (Save Data, all time steps)"
HINTS = {
    ".blend": OF_BLENDER,
    **dict.fromkeys((".bgeo", ".geo", ".sc"), OF_HOUDINI),
    **dict.fromkeys((".xdmf", ".xmf", ".h5", ".bp", ".e", ".exo"), OF_PARAVIEW),
}


def _upright(found: Trajectory, unit_m: float | None, up: str | None) -> Trajectory:
    """In m and with z up, and a note where that changes coordinates."""
    axes = chosen(found.axes, unit_m, up)
    if found.format == RUN and axes != OURS:
        raise UserError(
            f"--scale, --up: found {axes.unit_m:g} m per unit and {axes.up} up for the run {found.source};"
            " allowed: 1 m per unit and z up, which a run has"
        )
    if (note := sentence(axes)) is None:
        return found
    return replace(found, frames=lambda: map(axes.metres, found.frames()), notes=(*found.notes, note))


def read_trajectory(
    path: Path,
    topology: Path | None = None,
    displacement: str | None = None,
    unit_m: float | None = None,
    up: str | None = None,
) -> Trajectory:
    """By what the path is, in m and with z up. displacement: the field that moves points at rest. unit_m, up:
    unit and upward axis of the coordinates, in the place of those of the file. Errors: UserError that names
    the file, what was found and what is allowed.
    """
    found = _upright(displaced(_of_path(path), displacement), unit_m, up)
    return found if topology is None else replace(found, topology=topology_of(topology, found))
