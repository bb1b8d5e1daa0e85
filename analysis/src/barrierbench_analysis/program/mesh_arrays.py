"""Meshes as the program reads them: its verb `meshes`, one process for all files. Lists of files and films go
through it too."""

import atexit
import contextlib
import json
import tempfile
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.axes import OURS, chosen, sentence
from barrierbench_analysis.io.errors import UserError

from .file_lists import LISTS, files_of_list
from .film_files.film import POLYGON, SEGMENT, TETRAHEDRON, Shape, Step, joined, vtu_bytes
from .film_files.formats import FILMS, opened_film
from .start import built_program, piped

SUFFIXES = (".obj", ".ply", ".stl", ".vtu", ".vtp", ".vtk", ".msh")  # core/model/mesh/read_mesh.cpp
MESHES = (*SUFFIXES, *LISTS, *FILMS)  # of what is read as one mesh


@dataclass(frozen=True)
class MeshArrays:
    """Corners are 0-based numbers of vertices."""

    points: np.ndarray  # [n, 3] m with z up; of a Step in the unit and axes of its film
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


Answer = tuple[dict, dict[str, np.ndarray]]


def _requested(path: Path, **more: object) -> Answer:
    return reader(built_program()).ask({"path": str(path.absolute()), "name": str(path), **more})


def _of_shape(shape: Shape, name: str, **more: object) -> Answer:
    """What the program reads of cells that another reader has read, so that its rules hold for them. name: of
    messages."""
    with tempfile.NamedTemporaryFile(suffix=".vtu") as file:
        file.write(vtu_bytes(shape))
        file.flush()
        try:
            answer, arrays = _requested(Path(file.name), **{"name": f"{name}.vtu", **more})
        except UserError as error:
            raise UserError(str(error).replace(f"{name}.vtu", name), error.code) from None
    answer["notes"] = [note.replace(f"{name}.vtu", name) for note in answer["notes"]]
    return answer, arrays


def shape_of(mesh: MeshArrays) -> Shape:
    """The polygons of a frame as they are, its segments and tetrahedra."""
    cells = [(mesh.corners, mesh.sizes, POLYGON)]
    cells += [
        (of.ravel(), np.full(len(of), of.shape[1]), kind)
        for of, kind in ((mesh.segments, SEGMENT), (mesh.tetrahedra, TETRAHEDRON))
    ]
    types = [np.full(len(sizes), kind, np.uint8) for _, sizes, kind in cells]
    corners, sizes = (np.concatenate([one[k] for one in cells]).astype(np.int64) for k in (0, 1))
    return Shape(mesh.points, corners, sizes, np.concatenate(types))


def _of_list(path: Path, **more: object) -> Answer:
    """The files of a list, one after the other."""
    files, hidden = files_of_list(path, solid=True)
    meshes = [read_frame_file(file) for file in files]
    answer, arrays = _of_shape(joined([shape_of(mesh) for mesh in meshes]), str(path), **more)
    answer["notes"] = [note for mesh in meshes for note in mesh.notes] + answer["notes"]
    if hidden:
        same = ", ".join(sorted(set(hidden)))
        answer["notes"].append(f"{path}: blocks that show the same bodies once more are not read: {same}")
    return answer, arrays


def _answer(path: Path, unit_m: float | None = None, up: str | None = None, **more: object) -> Answer:
    """Of a file, of the files of a list, or of the first frame of a film; points in m with z up."""
    suffix, axes, notes = path.suffix.lower(), OURS, []
    if suffix not in MESHES:
        raise UserError(f'{path}: found extension "{suffix}"; allowed: one of {", ".join(MESHES)}')
    if suffix in FILMS:
        film = opened_film(path)
        answer, arrays = _of_shape(film.frame(0), str(path), **more)
        axes, notes = film.axes, [f"{path}: {note}" for note in film.notes]
        if len(film.labels) > 1:
            notes.append(f"{path}: the first of {len(film.labels)} frames is read ({film.labels[0]})")
    else:
        answer, arrays = (_of_list if suffix in LISTS else _requested)(path, **more)
    axes = chosen(axes, unit_m, up)
    arrays["points"] = axes.metres(arrays["points"])
    if note := sentence(axes):
        notes.append(f"{path}: {note}")
    answer["notes"] = [*answer["notes"], *notes]
    return answer, arrays


def _wide(cells: np.ndarray) -> np.ndarray:
    return cells.astype(np.int64)


def _frame(answer: dict, arrays: dict[str, np.ndarray], fields: tuple[str, ...]) -> MeshArrays:
    return MeshArrays(
        arrays["points"],
        *(_wide(arrays[name]) for name in ("triangles", "segments", "tetrahedra")),
        arrays["corners"],
        arrays["sizes"],
        answer["fields"],
        {name: arrays[f"field {name}"] for name in fields},
        tuple(answer["notes"]),
        arrays.get("uvs"),
        arrays.get("corner_uvs"),
    )


def _of_step(step: Step, fields: tuple[str, ...]) -> MeshArrays:
    """A body in a frame of a film. The cells of a body are read once, and again where they change."""
    shape = step.film.at(step.body, step.frame)
    known, mesh = step.film.known.get(step.body, (None, None))
    if known is None or not shape.has_cells_of(known) or len(shape.points) != len(known.points):
        mesh = _frame(*_of_shape(shape, str(step)), ())
        step.film.known.setdefault(step.body, (shape, mesh))
    widths = {name: values.shape[1] for name, values in shape.fields.items()}
    values = {name: shape.fields[name] for name in fields}
    notes = () if step.frame else mesh.notes
    return replace(mesh, points=shape.points, fields=widths, values=values, notes=notes)


def read_frame_file(path: Path | Step, fields: tuple[str, ...] = (), uvs: bool = False) -> MeshArrays:
    """Any positions, flat and repeated faces too. fields: of which the values are wanted. uvs: texture
    coordinates too, which OBJ files have; of other files there are none. Errors: UserError with the file and
    the place.
    """
    if isinstance(path, Step):
        return _of_step(path, fields)
    answer, arrays = _answer(path, fields=list(fields), uvs=uvs)
    if uvs and not len(arrays["corner_uvs"]):
        arrays["corner_uvs"] = np.full(len(arrays["corners"]), -1)
    return _frame(answer, arrays, fields)


def read_body_file(
    path: Path, skin: bool = False, unit_m: float | None = None, up: str | None = None
) -> MeshArrays:
    """By the rules of a body's mesh. skin: triangles that are faces of one tetrahedron stay. unit_m, up: unit
    and upward axis of the coordinates, in the place of those of the file. Errors: UserError as
    read_frame_file.
    """
    answer, arrays = _answer(path, unit_m, up, **{"as": "body"}, skin=skin)
    return MeshArrays(
        arrays["points"],
        *(_wide(arrays[name]) for name in ("triangles", "segments", "tetrahedra")),
        notes=tuple(answer["notes"]),
    )
