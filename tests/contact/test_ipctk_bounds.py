"""Bounds of each vertex, and pairs weighted by area, against the IPC Toolkit (Python package ipctk).

Its trust region has candidates within a radius; here those of the motion, so both are given all pairs. Skipped when ipctk
or the program contact_probe is missing.
"""

import os

import numpy as np
import pytest
from barrierbench_analysis.studies.toolkit import toolkit_meshes
from test_ipctk import PROBE, collision_mesh, ipctk, probe

pytestmark = pytest.mark.skipif(not os.access(PROBE, os.X_OK), reason="contact_probe is not built")


def two_wavy_sheets(seed=3):
    """x0, x1 and triangles: two sheets 0.3 apart that run into each other and aside, every vertex by its own way."""
    rng = np.random.default_rng(seed)
    x0, _, faces = toolkit_meshes.generated_sheets(5, 0.3)
    x0 = x0[: len(x0) * 2 // 3]
    faces = faces[(faces < len(x0)).all(axis=1)]
    return x0, x0 + rng.uniform(-0.25, 0.25, x0.shape), faces


def toolkit_parts(x0, x1, faces, filtered):
    """What the toolkit's trust region leaves of the motion of each vertex: all pairs, gamma 0.9, no second cap."""
    mesh = collision_mesh(x0, faces)
    region = ipctk.ogc.TrustRegion(1.0)
    region.trust_region_inflation_radius = 10.0
    region.update(mesh, x0, ipctk.NormalCollisions(), 0.0, ipctk.BruteForce())
    assert len(region.candidates) > 1000 and region.relaxed_radius_scaling == 0.9
    dx = np.asfortranarray(x1 - x0)
    getattr(region, filtered)(mesh, x0, dx)
    return np.linalg.norm(dx, axis=1) / np.linalg.norm(x1 - x0, axis=1)


@pytest.mark.parametrize("rule, filtered", [("planar_truncation", "planar_filter_step"), ("per_vertex", "filter_step")])
def test_bounds_of_each_vertex(tmp_path, rule, filtered):
    """d_hat is as long as the scene, so that every pair is a candidate here as it is there."""
    x0, x1, faces = two_wavy_sheets()
    theirs = toolkit_parts(x0, x1, faces, filtered)
    ours = probe(tmp_path, x0, x0, x1, faces, 5.0)[rule]
    assert ours.shape == theirs.shape and (theirs < 1).mean() > 0.3
    np.testing.assert_allclose(ours, theirs, rtol=1e-9)


SETS = ipctk.NormalCollisions.CollisionSetType


def two_tori(n=14, m=9, gap=0.09, seed=7):
    """Closed surfaces, one round the other, a little rough."""
    rng = np.random.default_rng(seed)
    u, v = (a.ravel() for a in np.meshgrid(2 * np.pi * np.arange(n) / n, 2 * np.pi * np.arange(m) / m, indexing="ij"))
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
    at = lambda i, j: (i % n) * m + j % m  # noqa: E731
    cells = np.stack([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)], 1).reshape(-1, 3)
    layers = []
    for turn, r in ((0.0, 0.4), (0.17, 0.4 + gap)):
        radius = 1 + r * np.cos(v + turn)
        layers.append(np.stack([radius * np.cos(u + turn), radius * np.sin(u + turn), r * np.sin(v + turn)], 1))
    x = np.concatenate(layers)
    return x + 0.2 * gap * rng.uniform(-1, 1, x.shape), np.concatenate([cells, cells + n * m]).astype(np.int32)


def sheets(n, d_hat):
    x, _, faces = toolkit_meshes.generated_sheets(n, d_hat)
    return x, faces


# (set, surface, d_hat): open sheets for the set IPC alone, since the toolkit takes vertices at a border with an edge inside
# for inner ones, and adds their corrections
@pytest.mark.parametrize("weights, surface, d_hat", [("weighted", lambda: sheets(9, 0.2), 0.2), ("weighted", two_tori, 0.16),
                                                     ("corrected", two_tori, 0.16), ("corrected", lambda: two_tori(9, 7, 0.15, 1), 0.25)])  # fmt: skip
def test_potential_weighted_by_area(tmp_path, weights, surface, d_hat):
    """In the toolkit's collision set IPC weights of pairs with one closest feature add up, as rows do here; in its convergent one all but one are taken back."""
    x, faces = surface()
    answer = probe(tmp_path, x, x, x, faces, d_hat)
    mesh = collision_mesh(x, faces)
    mesh.init_adjacencies()
    collisions = ipctk.NormalCollisions()
    collisions.use_area_weighting = True
    collisions.collision_set_type = SETS.IPC if weights == "weighted" else SETS.IMPROVED_MAX_APPROX
    collisions.build(mesh, x, d_hat)
    if weights == "corrected":
        assert min(collisions[k].weight for k in range(len(collisions))) < 0
        assert answer["corrected"] < 0.7 * answer["weighted"]
    potential = ipctk.BarrierPotential(d_hat, 1.0)
    assert answer["rows"] > 100 and answer["mollified"] > 0 and answer["weighted"] < 0.1 * answer["potential"]
    assert answer[weights] == pytest.approx(potential(collisions, mesh, x) / d_hat**2, rel=1e-11, abs=0)
    gradient = potential.gradient(collisions, mesh, x) / d_hat**2
    assert np.linalg.norm(gradient) > 0
    assert np.linalg.norm(answer[f"{weights}_gradient"] - gradient) <= 1e-10 * np.linalg.norm(gradient)
