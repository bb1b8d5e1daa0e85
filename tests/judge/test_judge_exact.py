"""The judge's states against exact integers and against the IPC Toolkit, pair by pair: two triangles a frame, six pairs of an edge and a triangle.

JUDGE_PAIRS=1000000 asks for more pairs than the suite has time for.
"""

import json
import os
from itertools import product

import numpy as np
import pytest

from barrierbench_analysis.studies.judge.about import About
from barrierbench_analysis.studies.judge.ask import audited
from barrierbench_analysis.program.trajectories.trajectory import Topology, Trajectory, no_cells
from barrierbench_analysis.studies.judge.verdict import verdict_of

PAIRS = int(os.environ.get("JUDGE_PAIRS", 30000))
GRID = 2.0**-50  # all coordinates are multiples of it below 4 m, so that an integer times it is exact
TRIANGLES = np.array([[0, 1, 2], [3, 4, 5]])
NOTHING_GIVEN = About(np.zeros(0, int), None)
SIDES = [(0, 1), (1, 2), (2, 0)]


def random_frames(rng, n):
    """[n, 6, 3] m of four kinds, in turn: anywhere; on a lattice of 5 points a side, so that most pairs touch or are
    flat; the same within a few units of GRID; with the second triangle's corners on the first's plane, within rounding.
    """
    x = rng.uniform(-1, 1, (n, 6, 3))
    lattice = rng.integers(-2, 3, (n, 6, 3)) / 2
    nudged = lattice + rng.integers(-3, 4, (n, 6, 3)) * GRID
    w = rng.uniform(-0.5, 1.5, (n, 2))
    on = x[:, 0] + w[:, :1] * (x[:, 1] - x[:, 0]) + w[:, 1:] * (x[:, 2] - x[:, 0])
    flat = x.copy()
    flat[:, 3] = on
    flat[:, 4] = np.where(rng.random((n, 1)) < 0.5, x[:, 4], 2 * on - x[:, 5])
    out = np.select([(np.arange(n) % 4 == k)[:, None, None] for k in range(4)], [x, lattice, nudged, flat])
    return np.round(out / GRID) * GRID


def orient(a, b, c, d):
    """Signs of det(b - a, c - a, d - a), of columns of integers without bounds."""
    u, v, w = b - a, c - a, d - a
    det = u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0])
    return (det > 0).astype(int) - (det < 0).astype(int)


def flat_pair_meets(p, q, triangle):
    """Whether a segment meets a triangle, all integers of one frame: separating axes that suffice where all lie in one
    plane, and where the triangle or the segment is shorter than its name: a segment, a point.
    """
    points = [np.array(t, dtype=object) for t in (p, q, *triangle)]
    cross = lambda u, v: np.array([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]], dtype=object)  # noqa: E731
    sides = [points[1] - points[0], *(points[2 + b] - points[2 + a] for a, b in SIDES)]
    normals = [cross(sides[1], sides[2]), *(cross(sides[0], s) for s in sides[1:])]
    apart = [points[0] - c for c in points[2:]]
    across = [cross(cross(s, w), s) for s, w in product(sides, apart)]
    axes = [*sides, *normals, *(cross(n, s) for n, s in product(normals, sides)), *apart, *across]
    for axis in axes:
        along = [sum(axis * t) for t in points]
        if max(along[:2]) < min(along[2:]) or max(along[2:]) < min(along[:2]):
            return False
    return True


def truth(frames):
    """[n] pairs that cross from one open side to the other within the open triangle, [n] that meet in any other way."""
    whole = np.round(frames / GRID).astype(np.int64).astype(object)
    x = [whole[:, k].T for k in range(6)]
    proper, other = np.zeros(len(frames), int), np.zeros(len(frames), int)
    for triangle, edges in (((0, 1, 2), (3, 4, 5)), ((3, 4, 5), (0, 1, 2))):
        corner = [x[k] for k in triangle]
        for i, j in SIDES:
            p, q = x[edges[i]], x[edges[j]]
            sp, sq = orient(*corner, p), orient(*corner, q)
            around = np.array([orient(p, q, corner[a], corner[b]) for a, b in SIDES])
            inside = (np.abs(around.sum(axis=0)) == 3) & (sp * sq < 0)
            off = (sp * sq > 0) | ((around.max(axis=0) > 0) & (around.min(axis=0) < 0))
            proper += inside
            for k in np.flatnonzero(~inside & ~off):
                other[k] += flat_pair_meets(p[:, k], q[:, k], [c[:, k] for c in corner])
    return proper, other


def answers(frames):
    """What the judge says of each frame, and the total."""
    topology = Topology(6, TRIANGLES, no_cells(2), no_cells(4), names=("one", "other"), first_vertex=(0, 3))
    labels = [str(k) for k in range(len(frames))]
    subject = {
        "schema": "barrierbench.subject/1", "n_vertices": 6, "reach_m": 0.0, "planar": False,
        "bodies": [{"name": "one", "first_vertex": 0}, {"name": "other", "first_vertex": 3}],
        "triangles": TRIANGLES.tolist(), "segments": [], "given": [], "obstacles": [],
    }  # fmt: skip
    rows, total, _ = audited(Trajectory(topology, lambda: iter(frames), labels, "random", "npz"), NOTHING_GIVEN, subject, lambda *_: None)
    return rows, total


def test_states_agree_with_exact_integers(program):
    frames = random_frames(np.random.default_rng(7), PAIRS // 6)
    rows, total = answers(frames)
    crossings = np.array([row["crossings"] for row in rows])
    touches = np.array([row["touches"] for row in rows])
    proper, other = truth(frames)
    kinds = np.arange(len(frames)) % 4
    for k, word in enumerate(("anywhere", "lattice", "nudged", "flat")):
        mine = kinds == k
        print(json.dumps({"kind": word, "pairs": int(6 * mine.sum()), "proper": int(proper[mine].sum()), "otherwise": int(other[mine].sum()),
                          "crossings": int(crossings[mine].sum()), "touches": int(touches[mine].sum())}))  # fmt: skip
    assert proper[kinds == 0].sum() > 0 and other[kinds == 1].sum() > 0 and proper[kinds == 2].sum() > 0 and total["judged"] > 0
    assert (crossings >= proper).all()  # no crossing is missed
    assert (crossings + touches <= proper + other).all()  # nothing is invented
    assert ((crossings + touches > 0) == (proper + other > 0)).all()  # nothing that meets is passed over
    assert verdict_of(total, rows, states_only=True) == "penetrates"


def test_states_agree_with_the_toolkit_where_it_is_right(program):
    ipctk = pytest.importorskip("ipctk", reason="ipctk (analysis/requirements-oracle.txt) is not installed")
    frames = random_frames(np.random.default_rng(8), min(PAIRS, 120000) // 6)
    rows, _ = answers(frames)
    mesh = ipctk.CollisionMesh(frames[0], ipctk.edges(TRIANGLES), TRIANGLES)
    theirs = np.array([ipctk.has_intersections(mesh, x) for x in frames])
    proper, other = truth(frames)
    ours = np.array([row["crossings"] + row["touches"] > 0 for row in rows])
    kinds = np.arange(len(frames)) % 4
    areas = [np.linalg.norm(np.cross(frames[:, b] - frames[:, a], frames[:, c] - frames[:, a]), axis=1) for a, b, c in TRIANGLES]
    sliver, nudged = np.minimum(*areas) < 1e-12, kinds == 2
    misses, invents = ~theirs & (proper + other > 0), theirs & (proper + other == 0)
    counts = {
        "frames": len(frames),
        "agree": int((ours == theirs).sum()),
        "they_miss_a_proper_crossing": int((misses & (proper > 0)).sum()),
        "they_pass_over_a_touch": int((misses & (proper == 0)).sum()),
        "they_invent_at_a_sliver": int((invents & sliver).sum()),
        "they_invent_within_1e-14_m": int((invents & ~sliver).sum()),
    }
    print(json.dumps(counts))
    assert (ours == (proper + other > 0)).all()
    assert (ours == theirs)[kinds == 0].all() and theirs[kinds == 0].any()
    assert (sliver | nudged)[invents].all()  # what they invent has one of these reasons
    assert (misses & (proper > 0)).sum() <= len(frames) // 5000  # of 5,000 frames they miss no crossing, of 20,000 three


def test_parts_that_the_scene_moves_hide_no_passage_of_free_ones():
    total = dict(passages=0, obstacle_violations=0, not_finite=0, crossings=0, changed_sides=0, given_faults=1, judged=9, unproven=0, self_test_passed=True)
    frames = [{"obstacle_violations": 0, "given_faults": 0}]
    assert verdict_of(total, frames, states_only=False) == "given_parts_cross"
    assert verdict_of(total | {"passages": 5}, frames, states_only=False) == "passes_between_frames"
    assert verdict_of(total | {"passages": 5}, frames, states_only=True) == "clean", "given parts cross between frames alone"
    frames[0]["given_faults"] = 1
    assert verdict_of(total | {"passages": 5}, frames, states_only=True) == "given_parts_cross"
