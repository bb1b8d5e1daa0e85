"""Tetrahedra within a closed surface, made by TetGen: ./bench data mesh SURFACE OUT.ply --tetrahedra. The
surface stays as it is, every vertex and triangle of it; vertices are added within.

The package `tetgen` (MIT) has TetGen within it (AGPL-3.0, or a licence of WIAS). It is no part of this
project and is installed by whoever wants it: analysis/requirements-tetrahedra.txt.
"""

import contextlib
import math
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError

INSTALL = ".venv/bin/pip install --requirement analysis/requirements-tetrahedra.txt"


def merged(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices at one place as one (an STL file has three a triangle), in the order of their first one."""
    _, first, inverse = np.unique(points, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    number = np.empty_like(order)
    number[order] = np.arange(len(order))
    return points[first[order]], number[inverse.ravel()][triangles]


def require_closed(path: Path, triangles: np.ndarray) -> None:
    """Errors: UserError for a triangle with a corner twice, and for the first edge that has not exactly two
    triangles: one, where the surface is open, or more, where it is no manifold.
    """
    sides = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    if len(flat := np.flatnonzero(sides[:, 0] == sides[:, 1])):
        raise UserError(f"{path}: triangle {flat[0] // 3} has one corner twice")
    edges, count = np.unique(sides, axis=0, return_counts=True)
    for what, wrong in (("open", count == 1), ("no manifold", count > 2)):
        if wrong.any():
            a, b = edges[wrong][0]
            raise UserError(
                f"{path}: the surface is {what}: edge {a} {b} is of {count[wrong][0]} triangle"
                f"{'s' if count[wrong][0] > 1 else ''}, {int(wrong.sum())} edges are so;"
                " allowed: 2 of every edge"
            )


@contextlib.contextmanager
def _folder_of_its_own() -> Iterator[None]:
    """The working folder meanwhile: TetGen leaves files there of a surface that crosses itself."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as scratch:
        os.chdir(scratch)
        try:
            yield
        finally:
            os.chdir(before)


def filled(
    path: Path, points: np.ndarray, triangles: np.ndarray, edge: float | None
) -> tuple[np.ndarray, np.ndarray]:
    """Vertices, those of the surface first, and tetrahedra [n, 4] within it. edge: about the length (m) of
    edges within; None: as large as well shaped tetrahedra can be. A surface within another is filled too.
    Errors: UserError: a surface that is open, no manifold, or crosses itself; no package.
    """
    points, triangles = merged(points, triangles)
    require_closed(path, triangles)
    try:
        import tetgen
    except ImportError:
        raise UserError(
            f"--tetrahedra: the package tetgen (MIT; TetGen within it AGPL-3.0) is not installed: {INSTALL}"
        ) from None
    limit = {"fixedvolume": True, "maxvolume": edge**3 / (6 * math.sqrt(2))} if edge else {}
    with _folder_of_its_own():
        try:
            made = tetgen.TetGen(points, triangles.astype(np.int32)).tetrahedralize(nobisect=True, **limit)
        except RuntimeError as error:
            why = f"TetGen makes no tetrahedra of it, does it cross itself? {error}"
            raise UserError(f"{path}: {why}") from None
    return made[0], made[1].astype(np.int64)
