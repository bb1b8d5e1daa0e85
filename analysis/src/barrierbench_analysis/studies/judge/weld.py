"""Vertices that stand for one place: joined by --weld, and a note where a body is closed but for them."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from barrierbench_analysis.program.trajectories.trajectory import Topology, Trajectory, surface_of

CELLS = ("triangles", "segments", "tetrahedra")
MOST = 1e100  # coordinates beyond it overflow as squares
NEAR = 1e-6  # of the size of the first frame: vertices of seams are closer


@dataclass(frozen=True)
class Weld:
    """Which vertices stay, and which of them each vertex of the files is."""

    kept: np.ndarray  # [m] numbers in the files
    number: np.ndarray  # [n] from 0 to m - 1


def places(x: np.ndarray, tolerance: float) -> Weld:
    """Vertices within the tolerance of each other, directly or over others, are one: the first of them."""
    n = len(x)
    finite = (np.abs(x) < MOST).all(axis=1)
    tree = cKDTree(x[finite])
    pairs = np.flatnonzero(finite)[tree.query_pairs(tolerance, output_type="ndarray")]
    graph = coo_matrix((np.ones(len(pairs), bool), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    _, group = connected_components(graph, directed=False)
    _, first, inverse = np.unique(group, return_index=True, return_inverse=True)
    kept = np.sort(first)
    return Weld(kept, np.searchsorted(kept, first[inverse.ravel()]))


def _cells(topology: Topology, weld: Weld) -> Topology:
    """Without the cells that have a corner twice now."""
    cells = {}
    for name in CELLS:
        joined = weld.number[getattr(topology, name)]
        twice = (np.diff(np.sort(joined, axis=1), axis=1) == 0).any(axis=1)
        cells[name] = joined[~twice]
    return replace(topology, n_vertices=len(weld.kept), **cells)


def welded(trajectory: Trajectory, tolerance: float | None) -> tuple[Trajectory, Weld | None]:
    """By the first frame. The numbers of vertices are those after it."""
    if tolerance is None:
        return trajectory, None
    weld = places(next(iter(trajectory.frames())), tolerance)
    topology = _cells(trajectory.topology, weld)
    apart = Apart(weld, tolerance)
    lost = sum(len(getattr(trajectory.topology, n)) - len(getattr(topology, n)) for n in CELLS)
    note = f"--weld {tolerance:g}: {len(weld.number) - len(weld.kept)} vertices were joined to others"
    if lost:
        note += f", and {lost} cells, which have no size then, left out"
    return (
        replace(
            trajectory,
            topology=topology,
            half_thickness_m=None if (half := trajectory.half_thickness_m) is None else half[weld.kept],
            frames=lambda: (apart.of(x) for x in trajectory.frames()),
            notes=(*trajectory.notes, note),
            heard=Both(trajectory.heard, apart),
        ),
        weld,
    )


class Apart:
    """How far vertices that were joined come apart later; a note where that is more than the tolerance."""

    def __init__(self, weld: Weld, tolerance: float) -> None:
        self.weld, self.tolerance, self.most = weld, tolerance, 0.0

    def of(self, x: np.ndarray) -> np.ndarray:
        kept = x[self.weld.kept]
        with np.errstate(all="ignore"):
            apart = np.linalg.norm(x - kept[self.weld.number], axis=1)
        self.most = max(self.most, float(np.nanmax(apart, initial=0.0)))
        return kept

    def __iter__(self) -> Iterator[str]:
        if self.most > 2 * self.tolerance:
            yield f"--weld {self.tolerance:g}: vertices that were joined come up to {self.most:.3g} m apart"


class Both:
    """Notes of two sources, each as far as it is when they are read."""

    def __init__(self, one: Iterable[str], other: Iterable[str]) -> None:
        self.parts = (one, other)

    def __iter__(self) -> Iterator[str]:
        for part in self.parts:
            yield from part


def _open_sides(triangles: np.ndarray) -> np.ndarray:
    """[k, 2] sides that are not of two triangles."""
    sides = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, count = np.unique(sides, axis=0, return_counts=True)
    return edges[count != 2]


def seam_note(topology: Topology, x: np.ndarray) -> tuple[str, ...]:
    """A note where a body is closed but for vertices in one place, so that nothing counts as within it."""
    triangles = surface_of(topology)
    open_sides = _open_sides(triangles)
    if not len(open_sides) or not (np.abs(x) < MOST).all():
        return ()
    size = float(np.linalg.norm(np.ptp(x, axis=0)))
    border = np.unique(open_sides)
    weld = places(x[border], NEAR * size)
    number = np.arange(len(x))
    number[border] = border[weld.kept][weld.number]
    joined = number[triangles]
    graph = coo_matrix(
        (np.ones(2 * len(joined), bool), (joined[:, [0, 0]].ravel(), joined[:, [1, 2]].ravel())),
        shape=(len(x), len(x)),
    )
    _, part = connected_components(graph, directed=False)
    still_open = np.unique(part[_open_sides(joined)])
    closes = np.setdiff1d(np.unique(part[number[open_sides]]), still_open)
    moved = [v for v in border if number[v] != v and part[number[v]] in closes]
    if not moved:
        return ()
    apart = float(np.linalg.norm(x[moved] - x[number[moved]], axis=1).max())
    tolerance = "0" if apart == 0 else f"{apart * 1.01:.2g}"
    return (
        f"{len(closes)} bodies are closed but for {len(moved)} vertices that stand where another one does"
        f" (seams): nothing counts as within them; --weld {tolerance} joins these vertices",
    )
