"""Frames of a run: the positions of all bodies at the start and at the ends of steps, with what is known
there.

A frame is the binary PLY file that `bench run --set /output/frames_every=N` leaves in `frames/`.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from . import input_file
from .errors import UserError
from .json_file import read_object
from .record_file import bound_file, bound_files, named_files

TYPES = {"double": "<f8", "float": "<f4", "int": "<i4", "uchar": "u1"}


@dataclass
class Frame:
    """One state. Lengths in m, `load_N` in N, `gap_rel` in units of d_hat, `stretch` relative to rest."""

    vertices: np.ndarray  # [n, 3]
    triangles: np.ndarray  # [m, 3] indices of vertices
    edges: np.ndarray  # [k, 2] rods
    # body; after a step gap_rel and load_N, and where they were requested contact_x_N, ..., friction_z_N
    of_vertices: dict[str, np.ndarray] = field(default_factory=dict)
    of_triangles: dict[str, np.ndarray] = field(default_factory=dict)  # body, stretch


def with_vectors(of_vertices: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The same fields, with three of the names NAME_x_N, NAME_y_N, NAME_z_N as one of the name NAME_N [n, 3]:
    the force of contact, or of friction, on every vertex.
    """
    out: dict[str, np.ndarray] = {}
    for name, values in of_vertices.items():
        match = re.fullmatch(r"(\w+)_([xyz])_N", name)
        parts = [f"{match[1]}_{axis}_N" for axis in "xyz"] if match else []
        if not match or not all(part in of_vertices for part in parts):
            out[name] = values
        elif match[2] == "x":
            out[f"{match[1]}_N"] = np.stack([of_vertices[part] for part in parts], axis=1)
    return out


def _elements(header: list[str], path: Path) -> list[tuple[str, int, np.dtype]]:
    """Name, count and row type of every element."""
    elements: list[tuple[str, int, list]] = []
    for line in header:
        words = line.split()
        if words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:2] == ["property", "list"]:
            elements[-1][2].extend([("corners", TYPES[words[2]]), (words[4], TYPES[words[3]], 3)])
        elif words[:1] == ["property"]:
            elements[-1][2].append((words[2], TYPES[words[1]]))
    if "format binary_little_endian 1.0" not in header:
        raise UserError(f"{path}: not a binary little-endian PLY file")
    return [(name, count, np.dtype(fields)) for name, count, fields in elements]


def read_frame(path: str | Path) -> Frame:
    """One PLY file as the program writes it (all faces are triangles). Raises UserError."""
    path = Path(path)
    data = input_file.read_bytes(path)
    head, mark, body = data.partition(b"end_header\n")
    if not data.startswith(b"ply\n") or not mark:
        raise UserError(f"{path}: not a PLY file")
    try:
        elements = _elements(head.decode("ascii", "replace").splitlines(), path)
    except (KeyError, IndexError, TypeError) as error:
        raise UserError(f"{path}: a header that no frame has: {error!r}") from None
    if {"vertex", "face"} - {name for name, _, _ in elements}:
        raise UserError(f"{path}: no vertices or no faces; allowed: the elements vertex and face")
    tables, at = {}, 0
    for name, count, row in elements:
        if at + count * row.itemsize > len(body):
            raise UserError(f"{path}: ends before its last {name}")
        tables[name] = np.frombuffer(body, row, count, at)
        at += count * row.itemsize
    v, f, e = tables["vertex"], tables["face"], tables.get("edge")
    if len(f) and (f["corners"] != 3).any():
        raise UserError(f"{path}: a face that is no triangle")
    return Frame(
        vertices=np.stack([v["x"], v["y"], v["z"]], axis=1),
        triangles=np.array(f["vertex_indices"]).reshape(-1, 3),
        edges=np.stack([e["vertex1"], e["vertex2"]], axis=1) if e is not None else np.zeros((0, 2), int),
        of_vertices={n: v[n] for n in v.dtype.names if n not in "xyz"},
        of_triangles={n: f[n] for n in f.dtype.names if n not in ("corners", "vertex_indices")},
    )


def frame_paths(record: dict, run: str | Path) -> dict[int, Path]:
    """Step -> file of the frames that the record in the folder `run` names, in order; -1 is the start, 0 the
    end of the first step. What else lies in frames/ is of no run that is known. Raises UserError without any.
    """
    found = {}
    for name in named_files(record, "frame"):
        if match := re.fullmatch(r"frames/(start|step_(\d+))\.ply", name):
            found[-1 if match[1] == "start" else int(match[2])] = Path(run) / name
    if not found:
        raise UserError(
            f"{run}: the record names no frames; run the config with --set /output/frames_every=1"
        )
    return dict(sorted(found.items()))


def frames_of(record: dict, run: str | Path, steps: Iterable[int]) -> Iterator[Frame]:
    """Those of frame_paths() that these steps end with, read one after the other. Raises UserError,
    RecordError: a file is not the one that the record names.
    """
    paths = frame_paths(record, run)
    relatives = (paths[step].relative_to(run).as_posix() for step in steps)
    return map(read_frame, bound_files(record, Path(run), relatives))


def frame_of(record: dict, run: str | Path, step: int) -> Frame:
    """One frame, otherwise as frames_of."""
    return next(frames_of(record, run, [step]))


def read_scene(record: dict, run: str | Path) -> dict:
    """frames/scene.json: `bodies` (names), `obstacles` (kind, point_m, axis, radius_m, inside; of one that
    moves `vertex`, which stands for its point in the frames), `planar`. Raises UserError, RecordError.
    """
    path = bound_file(record, Path(run), "frames/scene.json")
    return read_object(path)


def points_of_bodies(scene: dict, vertices: np.ndarray) -> np.ndarray:
    """[..., n, 3] m: `vertices` [..., m, 3] without those that stand for obstacles, which come last."""
    return vertices[..., : vertices.shape[-2] - sum("vertex" in o for o in scene["obstacles"]), :]


def without_bodies(frame: Frame, scene: dict, names: Iterable[str]) -> Frame:
    """Without the triangles and edges of the bodies of these names; vertices keep their numbers. Errors:
    UserError for a name that no body has.
    """
    known = list(scene["bodies"])
    if unknown := [name for name in names if name not in known]:
        raise UserError(f"body {unknown[0]!r}: one of {', '.join(known)}")
    hidden = [known.index(name) for name in names]
    if not hidden:
        return frame
    bodies = np.asarray(frame.of_vertices["body"])
    triangles = ~np.isin(bodies[frame.triangles[:, 0]], hidden)
    edges = ~np.isin(bodies[frame.edges[:, 0]], hidden)
    return replace(
        frame,
        triangles=frame.triangles[triangles],
        edges=frame.edges[edges],
        of_triangles={name: values[triangles] for name, values in frame.of_triangles.items()},
    )


def scene_at(scene: dict, frame: Frame) -> dict:
    """A scene of read_scene() with its obstacles where they are in a frame."""
    there = [
        {**o, "point_m": frame.vertices[o["vertex"]].tolist()} if "vertex" in o else o
        for o in scene["obstacles"]
    ]
    return {**scene, "obstacles": there}


def times_of(record: dict, steps: list[int], run: Path) -> list[float]:
    """Simulated time (s) at the end of each step; 0 at the start. Errors: UserError for a step that the
    record does not have.
    """
    ends = {step["step"]: float(step["t_s"]) for step in record["steps"]} | {-1: 0.0}
    missing = [step for step in steps if step not in ends]
    if missing:
        raise UserError(
            f"{run}/run.json#/steps: no step {missing[0]}, but a frame of it; allowed: a step for each frame"
        )
    return [ends[step] for step in steps]


def check_same_bodies(frame: Frame, first: Frame, path: Path) -> None:
    """Errors: UserError: other elements than in the first frame, or a position that is not finite."""
    for name in ("triangles", "edges"):
        if not np.array_equal(getattr(frame, name), getattr(first, name)):
            raise UserError(
                f"{path}: its {name} are not those of the first frame; allowed: the same in every frame"
            )
    if frame.vertices.shape != first.vertices.shape:
        raise UserError(
            f"{path}: found {len(frame.vertices)} vertices; allowed: {len(first.vertices)}, as in the first"
            " frame"
        )
    if not np.isfinite(frame.vertices).all():
        bad = int(np.argmax(~np.isfinite(frame.vertices).all(axis=1)))
        raise UserError(f"{path}: the position of vertex {bad} is not finite; allowed: finite numbers")
