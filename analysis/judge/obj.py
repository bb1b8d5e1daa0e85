"""Wavefront OBJ: positions, polygons and lines. Text, so frames are mostly read for their `v` lines."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..errors import UserError
from .trajectory import Topology, fans


def _corners(path: Path, line: bytes, n_vertices: int) -> np.ndarray:
    """0-based corners of an `f` or `l` line; negative numbers count from the last vertex."""
    try:
        numbers = np.array([int(word.split(b"/")[0]) for word in line.split()[1:]], np.int64)
    except (ValueError, OverflowError):
        raise UserError(
            f"{path}: the line {line.decode('ascii', 'replace')!r} has a corner that is no number of a vertex"
        ) from None
    return np.where(numbers > 0, numbers - 1, n_vertices + numbers)


def read_obj(path: Path) -> tuple[np.ndarray, Topology]:
    """[n, 3] m and the topology. Errors: UserError with the file, and the line that is wrong."""
    lines = path.read_bytes().replace(b"\\\n", b" ").splitlines()
    rows = [line[2:] for line in lines if line[:2] == b"v "]
    try:
        numbers = np.array(b" ".join(rows).split(), float)
    except ValueError as error:
        raise UserError(f"{path}: a vertex that is no three numbers: {error}") from None
    if not rows or len(numbers) % len(rows) or len(numbers) // len(rows) < 3:
        raise UserError(
            f"{path}: {len(rows)} vertices with {len(numbers)} numbers; three or more each are needed"
        )
    points = numbers.reshape(len(rows), -1)[:, :3]
    n = len(points)
    faces = [_corners(path, line, n) for line in lines if line[:2] == b"f "]
    chains = [_corners(path, line, n) for line in lines if line[:2] == b"l "]
    short = next((f for f in faces if len(f) < 3), None)
    if short is not None:
        raise UserError(f"{path}: a face with the corners {(short + 1).tolist()}; three or more are needed")
    segments = np.array([(c[k], c[k + 1]) for c in chains for k in range(len(c) - 1)], int).reshape(-1, 2)
    triangles = fans(faces)
    return points, Topology(n, triangles, segments, np.zeros((0, 4), int), sum(len(f) > 3 for f in faces))
