"""Soft shadows over a floor, and rods as round tubes: against closed forms."""

import numpy as np
import pytest

from barrierbench_analysis.figures.surfaces.rod_tubes import SIDES, chains, rounded, tube, tubes
from barrierbench_analysis.figures.pictures.soft_shadow import LIGHT_SIZE, shadow_map

UP = np.array([0.0, 0, 1])


def map_of(height, to_light=UP, tilt=0.0):
    """Of a square [-0.5, 0.5]^2 at a height; tilt: its slope along x."""
    x = np.array([[s, t, height + tilt * s] for s in (-0.5, 0.5) for t in (-0.5, 0.5)])
    return shadow_map(x, np.array([[0, 1, 3], [0, 3, 2]]), lambda camera, pixels: [], to_light, np.zeros(3), 1.0)


def lit_at(shadows, distances):
    """Shares of the light on the floor, so far outside the edge x = 0.5 of the shadow."""
    x = np.stack([0.5 + np.array(distances, float), 0.013 + np.zeros(len(distances)), np.zeros(len(distances))], axis=1)
    return shadows.lit(x, np.broadcast_to(UP, x.shape))


@pytest.mark.parametrize("height", [0.1, 0.2])
def test_the_edge_of_a_shadow_is_as_wide_as_the_height_says(height):
    half = LIGHT_SIZE * height
    shadows = map_of(height)
    assert list(lit_at(shadows, [-0.5, -0.2, -1.2 * half, 1.2 * half, 0.2, 0.7])) == [0, 0, 0, 1, 1, 1]
    within = np.array([np.mean(lit_at(shadows, [d] * 5)) for d in np.linspace(-0.9, 0.9, 7) * half])  # 5: one of each turn
    assert (np.diff(within) > 0).all() and within[3] == pytest.approx(0.5, abs=0.06)
    t = np.linspace(-0.9, 0.9, 7)  # share of a disc on one side of a line
    np.testing.assert_allclose(within, 0.5 + (t * np.sqrt(1 - t * t) + np.arcsin(t)) / np.pi, atol=0.08)


def test_a_surface_does_not_shade_itself_and_one_below_it_is_dark():
    slope = 1.2
    to_light = np.array([0.3, -0.4, 1]) / np.linalg.norm([0.3, -0.4, 1])
    shadows = map_of(0.3, to_light, slope)
    s, t = (g.ravel() for g in np.meshgrid(np.linspace(-0.45, 0.45, 20), np.linspace(-0.45, 0.45, 20)))
    x = np.stack([s, t, 0.3 + slope * s], axis=1)
    normal = np.array([-slope, 0, 1]) / np.hypot(slope, 1)
    assert (shadows.lit(x, np.broadcast_to(normal, x.shape)) == 1).all()
    below = np.array([[0.0, 0, 0]]) - 0.1 * to_light + [0, 0, 0.3]
    assert shadows.lit(below, UP[None]) == 0


def test_rows_of_rods_have_every_edge_once():
    edges = np.array([[2, 1], [0, 1], [2, 3], [10, 11], [11, 12], [12, 10], [20, 21], [20, 22], [20, 23]])
    found = chains(edges)
    assert [0, 1, 2, 3] in found and [10, 11, 12, 10] in found and len(found) == 5
    pairs = sorted(tuple(sorted(p)) for row in found for p in zip(row, row[1:]))
    assert pairs == sorted(tuple(sorted(e)) for e in edges.tolist())
    assert chains(np.zeros((0, 2), int)) == []


def test_a_straight_tube_has_the_volume_of_its_polygon():
    x = np.array([0.1, 0.2, 0.3]) + np.linspace(0, 1, 5)[:, None] * np.array([2.0, 1, -2])
    points, triangles = tube(x, 0.05)
    a, b, c = points[triangles].transpose(1, 0, 2)
    volume = (np.cross(a, b) * c).sum() / 6  # outward normals, or it is negative
    assert volume == pytest.approx(SIDES / 2 * np.sin(2 * np.pi / SIDES) * 0.05**2 * 3, rel=1e-12)
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(sides, axis=0, return_counts=True)[1] == 2).all()  # closed


def test_rounded_rows_pass_through_their_points():
    x = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 1, 1]])
    fine = rounded(x, 4)
    np.testing.assert_allclose(fine[::4], x, atol=1e-15)
    assert len(fine) == 13 and fine[2] == pytest.approx([0.5625, -0.0625, 0])  # Catmull-Rom by hand: (-a + 9 b + 9 c - d) / 16 of (-1,0,0) 0 (1,0,0) (1,1,0)
    line = np.linspace(0, 1, 5)[:, None] * np.ones(3)
    np.testing.assert_allclose(rounded(line, 2), np.linspace(0, 1, 9)[:, None] * np.ones(3), atol=1e-15)
    ring = np.array([[1.0, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [1, 0, 0]])
    np.testing.assert_allclose(np.linalg.norm(rounded(ring, 2)[1::2], axis=1), np.sqrt(0.5) * 1.25, atol=1e-12)
    assert rounded(x, 1) is x


def test_tubes_name_a_vertex_of_their_rod():
    x = np.array([[0.0, 0, 0], [1, 0, 0], [5, 0, 0], [6, 0, 0]])
    points, triangles, of = tubes(x, np.array([[0, 1], [2, 3]]), np.array([0.1, 0.1, 0.2, 0.2]))
    assert set(of) == {0, 2} and triangles.max() == len(points) - 1
    thick = points[triangles[of == 2]].reshape(-1, 3)
    assert np.hypot(thick[:, 1], thick[:, 2]).max() == pytest.approx(0.2) and thick[:, 0].min() == 5
