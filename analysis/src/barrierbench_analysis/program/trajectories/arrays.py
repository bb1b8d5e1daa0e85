"""Trajectories of a NumPy file (.npz): positions, cells and times under the names that programs give them."""

import difflib
from pathlib import Path
from typing import BinaryIO

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.input_file import TRAJECTORY, opened

from .trajectory import Topology, Trajectory, increasing, no_cells

# What is read, and the other names that it goes by (BEDLAM, SMPL, Newton, libigl, meshes of FEM programs).
NAMES = {
    "positions": ("vertices_seq", "vertices", "verts", "points", "particle_q", "trajectory", "x", "X", "V"),
    "triangles": ("faces", "tris", "F", "tri_indices"),
    "segments": ("rods", "lines", "edges", "E"),
    "tetrahedra": ("tets", "tetra", "T", "tet_indices"),
    "times_s": ("times", "time", "t"),
}
CORNERS = {"triangles": 3, "segments": 2, "tetrahedra": 4}
LIKE = 0.85  # of difflib: a name so close to one of ours is a misspelt one


def _key_of(path: Path, files: list[str], key: str) -> str | None:
    """The array of this meaning. Errors: UserError where there are two."""
    found = [name for name in (key, *NAMES[key]) if name in files]
    if len(found) > 1 and key != "positions":
        raise UserError(f"{path}: `{found[0]}` and `{found[1]}` are both names of `{key}`; one is needed")
    return found[0] if found else None


def _misspelt(name: str) -> tuple[str, str] | None:
    """What this one looks like: a name that is read, and what it is read as."""
    known = {other: key for key, others in NAMES.items() for other in (key, *others)}
    if name in known or len(name) < 4:
        return None
    close = difflib.get_close_matches(name.lower(), known, 1, LIKE)
    return (close[0], known[close[0]]) if close else None


class Npz:
    """Arrays are read on request: one that is pickled and not requested is never opened."""

    def __init__(self, path: Path, file: np.lib.npyio.NpzFile) -> None:
        self.path, self.file = path, file
        self.key = {key: _key_of(path, file.files, key) for key in NAMES}

    def get(self, key: str) -> np.ndarray | None:
        name = self.key[key]
        if name is None:
            return None
        try:
            return self.file[name]
        except Exception as error:  # noqa: BLE001 (cut off or pickled, it fails in any way)
            raise UserError(
                f"{self.path}: `{name}` cannot be read: {str(error) or type(error).__name__}"
            ) from None

    def others(self) -> list[str]:
        return [name for name in self.file.files if name not in self.key.values()]

    def notes(self) -> tuple[str, ...]:
        """Errors: UserError for an array whose name looks like a misspelt one."""
        others = self.others()
        for name in others:
            like = _misspelt(name)
            if like and self.key[like[1]] is None:
                raise UserError(f"{self.path}: the array `{name}` is not known; did you mean `{like[0]}`?")
        notes = [f"`{name}` is read as `{key}`" for key, name in self.key.items() if name not in (None, key)]
        if others:
            notes.append(f"arrays that are not read: {', '.join(sorted(others))}")
        return tuple(notes)

    def cells(self, key: str) -> np.ndarray:
        """[n, corners]; edges that are sides of triangles are no rods."""
        n, found = CORNERS[key], self.get(key)
        if found is None:
            return no_cells(n)
        if found.ndim != 2 or found.shape[1] != n or found.dtype.kind not in "iu":
            raise UserError(
                f"{self.path}: `{self.key[key]}` of shape {found.shape} and type {found.dtype};"
                f" integers [n, {n}] are needed"
            )
        return found.astype(np.int64)

    def positions(self) -> np.ndarray:
        x = self.get("positions")
        if x is None or x.ndim != 3 or x.shape[2] != 3 or not x.size or x.dtype.kind not in "fiu":
            name = self.key["positions"]
            found = "no `positions`" if x is None else f"`{name}` of shape {x.shape} and type {x.dtype}"
            have = f" (found: {', '.join(sorted(self.file.files)) or 'no array'})" if x is None else ""
            raise UserError(f"{self.path}: {found}{have}; floats [frames, vertices, 3] in m are needed")
        return x

    def times(self, n_frames: int) -> list[float] | None:
        times, name = self.get("times_s"), self.key["times_s"]
        if times is None:
            return None
        if times.shape != (n_frames,) or times.dtype.kind not in "iuf":
            raise UserError(
                f"{self.path}: `{name}` of shape {times.shape} and type {times.dtype}; "
                f"a number a frame ({n_frames}) is needed"
            )
        return increasing(times.tolist(), lambda k: f"{self.path}: `{name}`[{k}]")


def _without_sides(segments: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Without the segments that are sides of these cells."""
    sides = {
        tuple(pair)
        for i in range(cells.shape[1])
        for j in range(i)
        for pair in np.sort(cells[:, [i, j]], axis=1).tolist()
    }
    return segments[[tuple(pair) not in sides for pair in np.sort(segments, axis=1).tolist()]].reshape(-1, 2)


def _npz(path: Path, raw: BinaryIO) -> np.lib.npyio.NpzFile:
    try:
        file = np.load(raw, allow_pickle=False)
        if not isinstance(file, np.lib.npyio.NpzFile):
            raise ValueError("one array without a name")
    except Exception as error:  # noqa: BLE001 (cut off, empty or of another kind, it fails in any way)
        why = str(error) or "no reason was given"
        raise UserError(f"{path}: not an NPZ file: {type(error).__name__}: {why}") from None
    return file


def of_npz(path: Path) -> Trajectory:
    """`positions` [frames, n, 3]; `triangles`, `segments`, `tetrahedra` and `times_s` where there are any."""
    with opened(path, TRAJECTORY) as raw:
        found = Npz(path, _npz(path, raw))
        x = found.positions()
        cells = {key: found.cells(key) for key in CORNERS}
        if found.key["segments"] in ("edges", "E"):
            for others in ("triangles", "tetrahedra"):
                cells["segments"] = _without_sides(cells["segments"], cells[others])
        notes, times = found.notes(), found.times(len(x))
    labels = [f"frame {k}" for k in range(len(x))]
    topology = Topology(x.shape[1], **cells)
    return Trajectory(topology, lambda: map(np.float64, x), labels, str(path), "npz", times, notes=notes)
