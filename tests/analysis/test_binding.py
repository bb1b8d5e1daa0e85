"""A finer mesh follows the surface that it is bound to: against numbers by hand and rigid motions."""

import numpy as np
import pytest

from barrierbench_analysis.figures.surfaces.binding import bound_mesh, closest_triangles, joined, refined, whole
from barrierbench_analysis.figures.surfaces.obstacle_mesh import obstacle_mesh
from barrierbench_analysis.figures.surfaces.obstacle_rays import signed_gap, triangle_distances
from barrierbench_analysis.figures.surfaces.rasterizer import corner_normals, smoothed_corners

RANDOM = np.random.default_rng(11)


def rotated(angle=1.1, axis=(1.0, 2.0, -0.5)):
    """A rotation matrix by Rodrigues' formula."""
    k = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def ball():
    """Points and triangles of a coarse sphere of radius 0.3 round (1, 2, 3)."""
    return obstacle_mesh({"kind": "sphere", "point_m": [1, 2, 3], "radius_m": 0.3}, np.zeros(3), 1.0)


def box():
    """[8, 3] and [12, 3]: the unit cube with normals outwards."""
    x = np.array([[i, j, k] for i in (0.0, 1) for j in (0.0, 1) for k in (0.0, 1)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return x, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


@pytest.mark.parametrize("smooth", [False, True])
def test_a_bound_mesh_of_a_body_that_turns_turns_with_it(smooth):
    x, triangles = ball()
    way = RANDOM.normal(size=(300, 3))
    fine = np.array([1, 2, 3]) + way / np.linalg.norm(way, axis=1)[:, None] * RANDOM.uniform(0.29, 0.31, (300, 1))
    bound, fit = bound_mesh(fine, np.array([[0, 1, 2]]), x, triangles, np.arange(len(triangles)), smooth)
    assert 0.005 < fit.distance_m.max() < 0.011 and np.abs(bound.offset_m).max() > 0.005
    np.testing.assert_allclose(bound.points(x, triangles), fine, rtol=0, atol=1e-12)
    assert fit.error_m < 1e-12
    turn, shift = rotated(), np.array([0.3, -4, 2])
    np.testing.assert_allclose(bound.points(x @ turn.T + shift, triangles), fine @ turn.T + shift, rtol=0, atol=1e-12)


def test_a_point_with_an_offset_follows_a_stretched_triangle():
    """A triangle with corners 0, (3, 0, 0), (0, 3, 0); the point (1, 1, 0.5) is over its middle. Stretched to
    (6, 0, 0) and (0, 0, 3) the middle is (2, 0, 1), and the normal (6, 0, 0) x (0, 0, 3) is along -y.
    """
    x = np.array([[0.0, 0, 0], [3, 0, 0], [0, 3, 0]])
    fine = np.array([[1.0, 1, 0.5], [0, 0, -0.25], [3.5, 0, 0.5]])  # the last one is beside the triangle
    bound, fit = bound_mesh(fine, np.array([[0, 1, 2]]), x, np.array([[0, 1, 2]]), np.array([0]), False)
    np.testing.assert_allclose(bound.weights, [[1 / 3] * 3, [1, 0, 0], [-1 / 6, 7 / 6, 0]], atol=1e-15)
    np.testing.assert_allclose(bound.offset_m, [0.5, -0.25, 0.5], atol=1e-15)
    np.testing.assert_allclose(fit.distance_m, [0.5, 0.25, np.sqrt(0.5)], atol=1e-15)
    after = bound.points(np.array([[0.0, 0, 0], [6, 0, 0], [0, 0, 3]]), np.array([[0, 1, 2]]))
    np.testing.assert_allclose(after, [[2, -0.5, 1], [0, 0.25, 0], [7, -0.5, 0]], atol=1e-14)
    np.testing.assert_allclose(bound.values([0.0, 3, 6]), [3, 0, 3], atol=1e-14)  # never beyond the corners'


def test_smooth_offsets_are_along_the_normals_between_the_vertices():
    """A roof of two triangles with slopes of 1/4 on both sides of the ridge x = 0, where the mean normal is upwards."""
    x = np.array([[0.0, 0, 1], [0, 2, 1], [-2, 1, 0], [2, 1, 0]])
    triangles = np.array([[0, 1, 2], [1, 0, 3]])
    after = x.copy()
    after[2:, 2] = -2  # steeper; still even about the ridge
    flat = x * [1, 1, 0.5]  # 2 atan(1/4) = 28 degrees between the normals; from 40 on an edge is sharp
    for smooth, moved in ((True, [0, 1, 1.2]), (False, None)):
        bound, fit = bound_mesh(np.array([[0, 1, 0.7]]), np.array([[0, 0, 0]]), flat, triangles, np.arange(2), smooth)
        assert fit.error_m < 1e-15
        found = bound.points(after, triangles)[0]
        if smooth:
            np.testing.assert_allclose(found, moved, atol=1e-12)
        else:
            assert abs(found[0]) > 0.1  # along the normal of one side


def test_the_closest_triangle_is_that_of_a_search_through_all():
    corners = RANDOM.uniform(-1, 1, (60, 3, 3))
    corners[30:] = corners[30:, :1] + 0.05 * (corners[30:] - corners[30:, :1])
    points = RANDOM.uniform(-2, 2, (200, 3))
    index, distance = closest_triangles(points, corners)
    every = np.array([triangle_distances(*(corners - p).transpose(1, 0, 2)) for p in points])
    np.testing.assert_array_equal(index, every.argmin(axis=1))
    np.testing.assert_array_equal(distance, every.min(axis=1))
    assert len(set(index)) > 20


def test_refined_triangles_lie_in_those_of_the_frame_and_follow_them():
    x, triangles = box()
    bound = refined(x, triangles, np.arange(12), 2, False)
    assert len(bound.triangles) == 12 * 16 and list(bound.source[:17]) == [0] * 16 + [1]
    assert len(bound.corners) == 2 + 12 * 16 // 2  # Euler: a closed surface, no point twice
    np.testing.assert_array_equal(bound.points(x, triangles)[:8], x)
    for state in (x, x @ np.array([[2.0, 0, 0], [1, 1, 0], [0, 0, 3]])):
        y = bound.points(state, triangles)
        areas = np.cross(*(y[bound.triangles[:, 1:]] - y[bound.triangles[:, :1]]).transpose(1, 0, 2))
        a, b, c = state[triangles[bound.source]].transpose(1, 0, 2)
        np.testing.assert_allclose(areas, np.cross(b - a, c - a) / 16, atol=1e-14)


def test_a_curved_refinement_keeps_vertices_and_sharp_edges_and_rounds_a_ball():
    x, triangles = box()
    bound = refined(x, triangles, np.arange(12), 2, True)
    np.testing.assert_allclose(bound.points(x, triangles), refined(x, triangles, np.arange(12), 2, False).points(x, triangles), atol=1e-15)
    gold = (1 + np.sqrt(5)) / 2
    ico = np.array([p for s in (1, -1) for t in (gold, -gold) for p in ((0, s, t), (s, t, 0), (t, 0, s))], float)
    ico /= np.linalg.norm(ico[0])
    side = np.min([np.linalg.norm(ico[0] - p) for p in ico[1:]])
    near = np.linalg.norm(ico[:, None] - ico[None], axis=2) < side * 1.01
    faces = [(i, j, k) for i in range(12) for j in range(i) for k in range(j) if near[i, j] and near[j, k] and near[i, k]]
    faces = np.array([f if np.linalg.det(ico[list(f)]) > 0 else f[::-1] for f in faces])
    assert len(faces) == 20
    radius, half = {}, np.linalg.norm(ico[0] + ico[np.argmax(near[0] & (np.arange(12) > 0))]) / 2  # of a side's middle
    for curved in (False, True):
        bound = refined(ico, faces, np.arange(20), 3, curved)
        if curved:  # an icosahedron's edges have 41.8 degrees: sharp; as one smooth surface:
            one, other = (k.ravel() for k in np.nonzero(faces.reshape(-1)[:, None] == faces.reshape(-1)[None]))
            bound = type(bound)(**{**vars(bound), "pairs": (one, other)})
        radius[curved] = np.linalg.norm(bound.points(ico, faces), axis=1)
        np.testing.assert_allclose(radius[curved][:12], 1, atol=1e-15)
    assert radius[False].min() < 0.8 and 0.85 < half < 0.86 and radius[True].min() > 0.999
    # the middle of a side is 1 - half^2 below the tangent planes at both ends
    assert radius[True].max() == pytest.approx(half + 0.75 * (1 - half**2) * half, abs=1e-12)


def test_corner_normals_are_of_the_smooth_surface_round_a_corner():
    x, triangles = box()
    normals = corner_normals(x, triangles)
    own = np.cross(*(x[triangles[:, 1:]] - x[triangles[:, :1]]).transpose(1, 0, 2))
    np.testing.assert_allclose(normals, np.repeat(own[:, None], 3, axis=1), atol=1e-15)  # no corner is rounded
    points, triangles = ball()
    radial = (points[triangles] - [1, 2, 3]) / 0.3
    assert np.einsum("mkc,mkc->mk", corner_normals(points, triangles), radial).min() > 0.9999
    sheared = points * [1, 1, 3]
    kept = corner_normals(sheared, triangles, smoothed_corners(points, triangles))
    np.testing.assert_allclose(kept, corner_normals(sheared, triangles), atol=1e-12)  # nothing is sharp in either


def test_several_bindings_as_one():
    x, triangles = box()
    two = joined([whole(8), refined(x, triangles, np.arange(12), 1, True)])
    assert two.triangles.min() == 8 and two.curved and len(two.corners) == 8 + 26
    np.testing.assert_array_equal(two.points(x, triangles)[:8], x)


@pytest.mark.parametrize("obstacle, outside", [
    ({"kind": "sphere", "point_m": [1, 2, 3], "radius_m": 0.5}, -1),
    ({"kind": "sphere", "point_m": [1, 2, 3], "radius_m": 0.5, "inside": True}, -1),
    ({"kind": "cylinder", "point_m": [1, 2, 3], "axis": [0, 0.6, 0.8], "radius_m": 0.5}, -1),
    ({"kind": "cylinder", "point_m": [1, 2, 3], "axis": [0, 0.6, 0.8], "radius_m": 0.5, "inside": True}, -1),
    ({"kind": "plane", "point_m": [1, 2, 3], "axis": [0, 0.6, 0.8]}, 0),
])
def test_facets_of_an_obstacle_are_on_its_forbidden_side_by_a_thousandth(obstacle, outside):
    points, triangles = obstacle_mesh(obstacle, np.array([1.2, 2, 3]), 0.7)
    middles = points[triangles].mean(axis=1)
    gaps = signed_gap(obstacle, middles)
    assert (np.abs(gaps) < 1.5e-3 * 0.5).all() and (gaps <= 1e-12).all() and (outside == 0 or gaps.max() < 0)
    a, b, c = points[triangles].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    assert (signed_gap(obstacle, middles + 1e-3 * normals / np.linalg.norm(normals, axis=1)[:, None]) > gaps).all()
