"""Distances by name and ACCD against closed forms: which point is which, what offset and park do, what overlaps."""

import numpy as np
import pytest

A = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]  # an edge along x
TRIANGLE = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0]]


def test_functions_of_a_pair_take_their_points_in_order(bb):
    """Each where another order of the points has another distance."""
    point = bb.point_point([1, 2, 2], [0, 0, 0])
    assert point.d == 3 and np.allclose(point.r, [1, 2, 2]) and str(point.region) == "p_p"
    edge = bb.point_edge([0.5, 3, 0], *A)
    assert edge.d == 3 and np.allclose(edge.weights, [1, -0.75, -0.25]) and str(edge.region) == "p_e"
    triangle = bb.point_triangle([0.3, 0.6, 2], *TRIANGLE)
    assert triangle.d == pytest.approx(2) and np.allclose(triangle.weights, [1, -0.7, -0.1, -0.2])
    edges = bb.edge_edge(*A, [0.5, -1, 4], [0.5, 3, 4])
    assert edges.d == 4 and np.allclose(edges.weights, [0.75, 0.25, -0.75, -0.25]) and str(edges.region) == "ea_eb"


def test_points_broadcast(bb):
    heights = np.array([1.0, 2.0, 5.0])
    above = np.stack([0 * heights + 0.5, 0 * heights + 0.5, heights], axis=-1)
    found = bb.point_triangle(above, *TRIANGLE)
    assert found.d.tolist() == heights.tolist() and found.weights.shape == (3, 4) and found.r.shape == (3, 3)
    assert np.allclose(found.gradient[:, 0], [0, 0, 1])
    assert bb.edge_edge(np.zeros((4, 1, 3)), A[1], [[0, 0, 3], [0, 0, 7]], [1, 1, 9]).d.shape == (4, 2)


@pytest.mark.parametrize("offset, park, toi", [(0, 0, 0.5), (0.2, 0, 0.4), (0, 0.1, 0.45), (0.2, 0.1, 0.35)])
def test_accd_stops_at_offset_and_park(bb, offset, park, toi):
    """Two points of which one goes 2 m towards the other, which is 1 m away."""
    found = bb.accd("point_point", [[0, 0, 0], [1, 0, 0]], [[2, 0, 0], [1, 0, 0]], offset=offset, park=park)
    assert found.hit and not found.overlap_at_start and found.probes >= 1
    assert toi - 1e-9 < found.toi <= toi


def test_what_overlaps_at_the_start_is_told_from_what_is_hit(bb):
    start = np.array([[[0, 0, 0], [1.0, 0, 0]], [[0, 0, 0], [0.25, 0, 0]], [[0, 0, 0], [9.0, 0, 0]]])
    end = start.copy()
    end[:, 0, 0] = 2
    found = bb.accd("point_point", start, end, offset=0.25)
    assert found.hit.tolist() == [True, True, False] and found.overlap_at_start.tolist() == [False, True, False]
    assert found.toi[1] == 0 and found.toi[2] == 1
