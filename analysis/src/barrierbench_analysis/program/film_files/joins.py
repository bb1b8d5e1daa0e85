"""Points of a film that are one vertex. Curves have a point for each curve through a vertex, and objects
share none. So our writers number the vertices of all objects (VERTEX), and points with one number in one
place are joined when a film is read.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from barrierbench_analysis.io.errors import UserError

VERTEX = "barrierbench_vertex"  # a primvar of USD, a geometry parameter of Alembic: a whole number a point
Numbers = Sequence[np.ndarray | None]  # of each body; None: it has no numbers


def _apart(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Which points are farther from each other than single precision rounds."""
    with np.errstate(all="ignore"):
        size = np.abs(x).max(initial=0.0, where=np.isfinite(x))
        return (np.abs(x - y) > 4 * np.finfo(np.float32).eps * size).any(axis=1)


@dataclass(frozen=True)
class Join:
    """Points of all bodies, one after the other, as vertices."""

    kept: np.ndarray  # [vertices] ascending: the point that each is
    vertex: np.ndarray  # [points]

    def points(self, x: np.ndarray, place: str) -> np.ndarray:
        """Those of the vertices. Errors: UserError where points of one vertex are apart."""
        kept = x[self.kept]
        apart = np.flatnonzero(_apart(x, kept[self.vertex]))
        if len(apart):
            one, other = self.kept[self.vertex[apart[0]]], apart[0]
            raise UserError(
                f"{place}: found points {one} and {other} apart, one vertex by {VERTEX} and in the first"
                " frame; allowed: one place in all frames"
            )
        return kept

    def first_vertices(self, counts: Sequence[int]) -> list[int | None]:
        """The first vertex of each body; None of one whose vertices are all of bodies before it. counts: of
        points of each body.
        """
        ends = np.cumsum(counts)
        before = np.searchsorted(self.kept, [0, *ends])
        return [int(a) if b > a else None for a, b in zip(before, before[1:])]


def join_of(numbers: Numbers, parts: Sequence[np.ndarray]) -> Join | None:
    """By the numbers and the points of the bodies in the first frame; None where no two points are one."""
    counts = [len(x) for x in parts]
    total, begin = sum(counts), np.cumsum([0, *counts])
    every = -1 - np.arange(total)  # each point of a body without numbers has one of its own
    for own, count, first in zip(numbers, counts, begin):
        if own is not None and len(own) == count:
            every[first : first + count] = own
    _, first, number = np.unique(every, return_index=True, return_inverse=True)
    if len(first) == total:
        return None
    x, points = np.concatenate(parts), np.arange(total)
    same = np.where(_apart(x, x[first[number]]), points, first[number])
    kept = np.flatnonzero(same == points)
    return Join(kept, np.searchsorted(kept, same)) if len(kept) < total else None
