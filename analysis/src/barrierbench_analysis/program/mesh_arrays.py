"""Mesh files as the program reads them: its verb `meshes`, one process for all files."""

import atexit
import contextlib
import json
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError

from .start import built_program, piped

SUFFIXES = (".obj", ".ply", ".stl", ".vtu", ".vtp", ".vtk", ".msh")  # core/model/mesh/read_mesh.cpp


@dataclass(frozen=True)
class MeshArrays:
    """Lengths in units of the file; corners are 0-based numbers of vertices."""

    points: np.ndarray  # [n, 3]
    triangles: np.ndarray  # [m, 3] the polygons, cut
    segments: np.ndarray  # [k, 2]
    tetrahedra: np.ndarray  # [l, 4]
    corners: np.ndarray | None = None  # of all polygons in a row, of a frame
    sizes: np.ndarray | None = None  # [polygons]
    fields: dict[str, int] = field(default_factory=dict)  # of the points: name, components
    values: dict[str, np.ndarray] = field(default_factory=dict)  # [n, components] of those requested
    notes: tuple[str, ...] = ()  # what the file has and no mesh
    uvs: np.ndarray | None = None  # [u, 2] texture coordinates, where they are requested
    corner_uvs: np.ndarray | None = None  # [corners] into uvs, -1: none


class Reader:
    """One process of the program that answers as long as requests come."""

    def __init__(self) -> None:
        self.child = piped("meshes")
        atexit.register(self.close)

    def close(self) -> None:
        for stream in (self.child.stdin, self.child.stdout, self.child.stderr):
            with contextlib.suppress(OSError):  # a program that has ended leaves a broken pipe
                stream.close()
        self.child.wait()

    def ask(self, request: dict) -> tuple[dict, dict[str, np.ndarray]]:
        """The answer and its arrays. Errors: UserError with what the program says."""
        try:
            self.child.stdin.write((json.dumps(request) + "\n").encode())
            self.child.stdin.flush()
            line = self.child.stdout.readline()
            answer = json.loads(line)
        except (OSError, ValueError):
            self._lost()
        if "error" in answer:
            raise UserError(answer["error"])
        return answer, {one["name"]: self._array(one) for one in answer["arrays"]}

    def _array(self, one: dict) -> np.ndarray:
        kind = np.dtype(one["type"])
        wanted = kind.itemsize * int(np.prod(one["shape"]))
        data = self.child.stdout.read(wanted)
        if len(data) != wanted:
            self._lost()
        return np.frombuffer(data, kind).reshape(one["shape"])

    def _lost(self) -> None:
        reader.cache_clear()
        try:
            self.child.kill()
        finally:
            message = self.child.stderr.read().decode(errors="replace").strip()
        raise UserError(
            f"{built_program()}: the verb meshes does not answer: {message[:300] or 'it ended'}"
            "; allowed: a program that ./bench build made"
        )


@lru_cache(1)
def reader(program: Path) -> Reader:
    """The process of this program, begun at the first question."""
    return Reader()


def _requested(path: Path, **more: object) -> tuple[dict, dict[str, np.ndarray]]:
    return reader(built_program()).ask({"path": str(path.absolute()), "name": str(path), **more})


def _wide(cells: np.ndarray) -> np.ndarray:
    return cells.astype(np.int64)


def read_frame_file(path: Path, fields: tuple[str, ...] = (), uvs: bool = False) -> MeshArrays:
    """Any positions, flat and repeated faces too. fields: of which the values are wanted. uvs: texture
    coordinates too, which OBJ files have; of other files there are none. Errors: UserError with the file and
    the place.
    """
    answer, arrays = _requested(path, fields=list(fields), uvs=uvs)
    corners = arrays["corners"]
    if uvs and not len(arrays["corner_uvs"]):
        arrays["corner_uvs"] = np.full(len(corners), -1)
    return MeshArrays(
        arrays["points"],
        *(_wide(arrays[name]) for name in ("triangles", "segments", "tetrahedra")),
        corners,
        arrays["sizes"],
        answer["fields"],
        {name: arrays[f"field {name}"] for name in fields},
        tuple(answer["notes"]),
        arrays.get("uvs"),
        arrays.get("corner_uvs"),
    )


def read_body_file(path: Path, skin: bool = False) -> MeshArrays:
    """By the rules of a body's mesh. skin: triangles that are faces of one tetrahedron stay. Errors:
    UserError as read_frame_file.
    """
    answer, arrays = _requested(path, **{"as": "body"}, skin=skin)
    return MeshArrays(
        arrays["points"],
        *(_wide(arrays[name]) for name in ("triangles", "segments", "tetrahedra")),
        notes=tuple(answer["notes"]),
    )
