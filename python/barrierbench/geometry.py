"""Pairs of primitives: true closest points, distances with derivatives, ACCD. Metres; any leading dimensions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .given import finite_reals, real, reals

POINTS = {"point_point": 2, "point_edge": 3, "point_triangle": 4, "edge_edge": 4}


class Distance(NamedTuple):
    """Closest points of pairs with N points each; `...` are the leading dimensions of what was given."""

    d: NDArray[np.float64]  # [...] m
    gradient: NDArray[np.float64]  # [..., N, 3] of d in the points, 1; 0 where d = 0
    weights: NDArray[np.float64]  # [..., N] r = sum of weights times points; the second primitive's are <= 0
    r: NDArray[np.float64]  # [..., 3] m, from the second primitive to the first
    region: NDArray[np.str_]  # [...] the features that carry the closest points, such as p_t, ea_eb


class Advance(NamedTuple):
    """What ACCD proves of motions."""

    toi: NDArray[np.float64]  # [...] in [0, 1]: [0, toi) is free of contact; 1 without a hit
    hit: NDArray[np.bool_]  # [...]
    overlap_at_start: NDArray[np.bool_]  # [...] the gap is not above 0 at time 0; toi is 0
    probes: NDArray[np.int32]  # [...] evaluations of the closest points


def _pairs(pair: str, points: ArrayLike, where: str) -> tuple[NDArray[np.float64], tuple[int, ...]]:
    n = POINTS.get(pair, -1)
    x = np.ascontiguousarray(finite_reals(points, where))
    if x.ndim < 2 or x.shape[-1] != 3 or (n > 0 and x.shape[-2] != n):
        raise _core.ConfigError(f"{where}: found shape {x.shape}; allowed: [..., {max(n, 2)}, 3]")
    return x.reshape(-1, *x.shape[-2:]), x.shape[:-2]


def distance(pair: str, points: ArrayLike) -> Distance:
    """Distances of pairs. pair: point_point, point_edge, point_triangle or edge_edge.

    points: [..., N, 3] m, first primitive then second: p q | p e0 e1 | p t0 t1 t2 | ea0 ea1 eb0 eb1. Right for
    degenerate primitives too. Errors: ConfigError for another shape, points that are not finite.

    >>> found = distance("point_edge", [[0.5, 1, 0], [0, 0, 0], [1, 0, 0]])
    >>> float(found.d), str(found.region), found.gradient[0].tolist()
    (1.0, 'p_e', [0.0, 1.0, 0.0])
    """
    x, leading = _pairs(pair, points, "points")
    d, weights, r, region, gradient = _core.closest(pair, x)
    n = x.shape[1]
    return Distance(
        d.reshape(leading),
        gradient.reshape(*leading, n, 3),
        weights.reshape(*leading, n),
        r.reshape(*leading, 3),
        np.array(region, str).reshape(leading),
    )


def distance_hessian(pair: str, points: ArrayLike) -> NDArray[np.float64]:
    """[..., 3 N, 3 N] 1/m, the second derivative of the distance in its region, coordinates point by point.

    Errors: ConfigError for a pair that touches, which has none.
    """
    x, leading = _pairs(pair, points, "points")
    size = 3 * x.shape[1]
    return _core.distance_hessian(pair, x).reshape(*leading, size, size)


def _stacked(*points: ArrayLike) -> NDArray[np.float64]:
    return np.stack(np.broadcast_arrays(*(reals(p, "points") for p in points)), axis=-2)


def point_point(p: ArrayLike, q: ArrayLike) -> Distance:
    """Distance of points [..., 3], broadcast against each other."""
    return distance("point_point", _stacked(p, q))


def point_edge(p: ArrayLike, e0: ArrayLike, e1: ArrayLike) -> Distance:
    """Distance of a point from a segment; each [..., 3], broadcast against each other."""
    return distance("point_edge", _stacked(p, e0, e1))


def point_triangle(p: ArrayLike, t0: ArrayLike, t1: ArrayLike, t2: ArrayLike) -> Distance:
    """Distance of a point from a triangle; each [..., 3], broadcast against each other.

    >>> float(point_triangle([0.2, 0.2, 0.3], [0, 0, 0], [1, 0, 0], [0, 1, 0]).d)
    0.3
    """
    return distance("point_triangle", _stacked(p, t0, t1, t2))


def edge_edge(ea0: ArrayLike, ea1: ArrayLike, eb0: ArrayLike, eb1: ArrayLike) -> Distance:
    """Distance of two segments; each [..., 3], broadcast against each other."""
    return distance("edge_edge", _stacked(ea0, ea1, eb0, eb1))


def accd(pair: str, points_t0: ArrayLike, points_t1: ArrayLike, offset: float = 0.0, park: float = 0.0) -> Advance:
    """How far pairs may move along straight paths before they touch; every advance is proven.

    points_t0, points_t1: [..., N, 3] m at the start and at the end, in the order of `distance`. offset: thickness,
    m; the gap is d - offset. park: where an approaching pair is stopped, m; 0: at rounding alone.

    >>> found = accd("point_point", [[0, 0, 0], [1, 0, 0]], [[2, 0, 0], [1, 0, 0]])
    >>> bool(found.hit), round(float(found.toi), 9)
    (True, 0.5)
    """
    x0, leading = _pairs(pair, points_t0, "points_t0")
    x1, _ = _pairs(pair, points_t1, "points_t1")
    toi, hit, overlap, probes = _core.accd(pair, x0, x1, real(offset, "offset"), real(park, "park"))
    return Advance(
        toi.reshape(leading),
        hit.astype(bool).reshape(leading),
        overlap.astype(bool).reshape(leading),
        probes.reshape(leading),
    )
