"""Trajectories of one file for all frames: PC2 and NPZ."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from ..errors import UserError
from .times import increasing
from .trajectory import Topology, Trajectory, no_cells

PC2_HEADER = struct.Struct("<12siiffi")


def of_pc2(path: Path) -> Trajectory:
    """Float32 positions, as Blender's cache has them, without cells."""
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
    bare = Topology(points, no_cells(3), no_cells(2), no_cells(4))
    note = ("positions are float32 in the file: the states that were judged are the rounded ones",)
    labels = [f"sample {k}" for k in range(samples)]
    return Trajectory(bare, lambda: map(np.float64, states), labels, str(path), "pc2", notes=note)


def _arrays(path: Path) -> dict[str, np.ndarray]:
    try:
        with path.open("rb") as raw, np.load(raw, allow_pickle=False) as file:
            return {name: file[name] for name in file.files}
    except Exception as error:  # noqa: BLE001 (cut off, empty or of another kind, it fails in any way)
        why = str(error) or "nothing was said"
        raise UserError(f"{path}: not an NPZ file: {type(error).__name__}: {why}") from None


def _cells(path: Path, arrays: dict[str, np.ndarray], n_vertices: int) -> Topology:
    cells = {}
    for name, n in (("triangles", 3), ("segments", 2), ("tetrahedra", 4)):
        found = arrays.get(name, no_cells(n))
        if found.ndim != 2 or found.shape[1] != n or found.dtype.kind not in "iu":
            raise UserError(f"{path}: `{name}` of shape {found.shape}; integers [n, {n}] are needed")
        cells[name] = found.astype(np.int64)
    return Topology(n_vertices, **cells)


def _times(path: Path, times: np.ndarray | None, n_frames: int) -> list[float] | None:
    if times is None:
        return None
    if times.shape != (n_frames,) or times.dtype.kind not in "iuf":
        raise UserError(
            f"{path}: `times_s` of shape {times.shape} and type {times.dtype}; "
            f"a number a frame ({n_frames}) is needed"
        )
    return increasing(times.tolist(), lambda k: f"{path}: `times_s`[{k}]")


def of_npz(path: Path) -> Trajectory:
    """`positions` [frames, n, 3]; `triangles`, `segments`, `tetrahedra` and `times_s` where there are any."""
    arrays = _arrays(path)
    x = arrays.get("positions")
    if x is None or x.ndim != 3 or x.shape[2] != 3 or not x.size or x.dtype.kind != "f":
        found = "no `positions`" if x is None else f"`positions` of shape {x.shape} and type {x.dtype}"
        raise UserError(f"{path}: {found}; floats [frames, vertices, 3] in m are needed")
    topology, times = _cells(path, arrays, x.shape[1]), _times(path, arrays.get("times_s"), len(x))
    labels = [f"frame {k}" for k in range(len(x))]
    return Trajectory(topology, lambda: map(np.float64, x), labels, str(path), "npz", times)
