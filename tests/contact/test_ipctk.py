"""Rows, potential, derivatives and collision-free step against the IPC Toolkit (Python package ipctk).

The toolkit works on squared distances without our factor: potential = d_hat^2 times ours (ipc2020, kappa = 1).
Skipped when ipctk, the program contact_probe (BB_CONTACT_PROBE, else any build folder) or the data folder
(BARRIERBENCH_DATA) is missing.
"""

import glob
import json
import os
import pathlib
import subprocess

import numpy as np
import pytest
from barrierbench_analysis.studies.toolkit import toolkit_meshes

ipctk = pytest.importorskip("ipctk", reason="the oracle ipctk is not installed")

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = pathlib.Path(os.environ.get("BARRIERBENCH_DATA", "/nowhere/BARRIERBENCH_DATA"))
PROBES = sorted(glob.glob(str(ROOT / "build" / "*" / "tests" / "contact" / "contact_probe")), key=os.path.getmtime)
PROBE = os.environ.get("BB_CONTACT_PROBE", PROBES[-1] if PROBES else "")

pytestmark = [
    pytest.mark.skipif(not os.access(PROBE, os.X_OK), reason="contact_probe is not built"),
    pytest.mark.skipif(not (DATA / "meshes").is_dir(), reason=f"no meshes in {DATA}"),
]


def read_ply(name):
    return toolkit_meshes.read_ply(DATA / "meshes" / f"{name}.ply")


def probe(tmp_path, rest, x0, x1, faces, d_hat, mollify=True):
    """Runs contact_probe; what it found as a dictionary of arrays."""
    source, target = tmp_path / "in.bin", tmp_path / "out.bin"
    toolkit_meshes.write_problem(source, rest, x0, x1, faces, d_hat, mollify)
    answer = json.loads(subprocess.run([PROBE, source, target], check=True, capture_output=True).stdout)
    n, m = answer["rows"], answer["mollified"]
    with open(target, "rb") as file:
        answer["stencil"] = np.fromfile(file, "<i4", 4 * n).reshape(-1, 4)
        answer["d"] = np.fromfile(file, "<f8", n)
        answer["mollified_stencil"] = np.fromfile(file, "<i4", 4 * m).reshape(-1, 4)
        answer["mollified_d"] = np.fromfile(file, "<f8", m)
        answer["gradient"] = np.fromfile(file, "<f8", 3 * len(rest))
        entry = [("row", "<i4"), ("column", "<i4"), ("value", "<f8")]
        answer["hessian"] = np.fromfile(file, entry, answer["entries"])
        for rule in ("planar_truncation", "per_vertex"):
            answer[rule] = np.fromfile(file, "<f8", len(rest))
        for weights in ("weighted", "corrected"):
            answer[f"{weights}_gradient"] = np.fromfile(file, "<f8", 3 * len(rest))
    return answer


def collision_mesh(rest, faces):
    return ipctk.CollisionMesh(rest, ipctk.edges(faces), faces)


def toolkit_rows(mesh, x, d_hat):
    """The toolkit's collisions, and {vertices of both sides: (distance, weight)} apart for mollified ones."""
    collisions = ipctk.NormalCollisions()
    collisions.collision_set_type = ipctk.NormalCollisions.CollisionSetType.IPC
    collisions.use_area_weighting = False
    collisions.build(mesh, x, d_hat)
    plain, mollified = {}, {}
    for k in range(len(collisions)):
        collision = collisions[k]
        ids = [i for i in collision.vertex_ids(mesh.edges, mesh.faces) if i >= 0]
        d = np.sqrt(collision.compute_distance(collision.dof(x, mesh.edges, mesh.faces)))
        is_mollified = collisions.is_edge_edge(k) and collision.mollifier(
            collision.dof(x, mesh.edges, mesh.faces)) < 1
        key = sides(ids, collisions.is_edge_edge(k))
        (mollified if is_mollified else plain)[key] = (d, collision.weight)
    return collisions, plain, mollified


def sides(ids, edges):
    """Identity of a contact: the set of the vertices of each side."""
    ids = [int(i) for i in ids]
    split = 2 if edges else 1
    return frozenset([frozenset(ids[:split]), frozenset(ids[split:])])


def our_rows(answer):
    plain = {}
    kinds = {2: False, 3: False, 4: None}
    stencils, first, counts = np.unique(answer["stencil"], axis=0, return_index=True, return_counts=True)
    for stencil, d, m in zip(stencils, answer["d"][first], counts):  # pairs of one feature are one collision there
        ids = stencil[stencil >= 0]
        if kinds[len(ids)] is None:  # point-triangle or edge-edge: the toolkit's keys decide
            plain[sides(ids, False)] = plain[sides(ids, True)] = (d, m)
        else:
            plain[sides(ids, False)] = (d, m)
    mollified = {sides(s, True): (d, 1.0) for s, d in zip(answer["mollified_stencil"], answer["mollified_d"])}
    return plain, mollified


def compare(tmp_path, rest, x, faces, d_hat):
    """Asserts that everything agrees; returns the numbers of rows and of mollified rows."""
    answer = probe(tmp_path, rest, x, x, faces, d_hat)
    mesh = collision_mesh(rest, faces)
    collisions, plain, mollified = toolkit_rows(mesh, x, d_hat)
    ours, ours_mollified = our_rows(answer)
    assert len(np.unique(answer["stencil"], axis=0)) == len(plain) and answer["mollified"] == len(mollified)
    for mine, theirs in ((ours, plain), (ours_mollified, mollified)):
        for key, (d, weight) in theirs.items():
            assert key in mine
            assert mine[key][0] == pytest.approx(d, abs=1e-12, rel=0)
            assert mine[key][1] == weight

    potential = ipctk.BarrierPotential(d_hat, 1.0)
    scale = 1 / d_hat**2
    assert answer["potential"] == pytest.approx(scale * potential(collisions, mesh, x), rel=1e-12, abs=0)
    gradient = scale * potential.gradient(collisions, mesh, x)
    assert np.linalg.norm(gradient) > 0
    assert np.linalg.norm(answer["gradient"] - gradient) <= 1e-10 * np.linalg.norm(gradient)

    import scipy.sparse

    hessian = scale * potential.hessian(collisions, mesh, x, ipctk.PSDProjectionMethod.CLAMP)
    entries = answer["hessian"]
    mine = scipy.sparse.coo_matrix((entries["value"], (entries["row"], entries["column"])), hessian.shape)
    norm = scipy.sparse.linalg.norm
    assert norm(hessian) > 0
    assert norm(mine.tocsc() - hessian) <= 1e-9 * norm(hessian)
    return answer["rows"], answer["mollified"]


def test_two_cubes_have_mollified_pairs(tmp_path):
    x, faces = read_ply("two-cubes-close")
    rows, mollified = compare(tmp_path, x, x, faces, 1e-1)
    assert rows > 50 and mollified > 50


def test_turned_cube_has_none(tmp_path):
    x, faces = read_ply("two-cubes-close")
    rest, x = x.copy(), x.copy()
    upper = x[:, 1] > x[:, 1].mean()
    turn = np.array([[np.cos(0.3), 0, np.sin(0.3)], [0, 1, 0], [-np.sin(0.3), 0, np.cos(0.3)]])
    centre = x[upper].mean(axis=0)
    x[upper] = (x[upper] - centre) @ turn.T + centre
    rows, mollified = compare(tmp_path, rest, x, faces, 1e-2)
    assert rows > 20 and mollified == 0


def test_bunny(tmp_path):
    x, faces = read_ply("bunny")
    rows, mollified = compare(tmp_path, x, x, faces, 1.5e-2 * np.ptp(x, axis=0).max())
    assert rows > 1000 and mollified > 10


def test_cloth_on_ball(tmp_path):
    x, faces = read_ply("cloth_ball92")
    rows, mollified = compare(tmp_path, x, x, faces, 1e-3)
    assert rows > 1000 and mollified == 0


def step_bounds(tmp_path, x0, x1, faces, d_hat):
    """Our collision-free part of the step x0 -> x1 and that of the toolkit's ACCD.

    Asserts that ours is below the exact time: Tight Inclusion, conservative and independent, proves the part before
    it free of contact. It does not prove one percent more, so the bound is also close to that time.
    """
    answer = probe(tmp_path, x0, x0, x1, faces, d_hat)
    mesh = collision_mesh(x0, faces)
    theirs = ipctk.compute_collision_free_stepsize(mesh, x0, x1, narrow_phase_ccd=ipctk.AdditiveCCD())
    exact = ipctk.TightInclusionCCD(tolerance=1e-9, conservative_rescaling=1 - 1e-12)
    assert answer["capped"] == 0 and answer["zero"] == 0 and answer["queries"] > 0
    for factor, free in ((1, True), (1.01, False)):
        end = x0 + factor * answer["alpha"] * (x1 - x0)
        proven = ipctk.compute_collision_free_stepsize(mesh, x0, end, narrow_phase_ccd=exact)
        assert (proven == 1) == free, (factor, answer["alpha"], proven)
    return answer["alpha"], theirs


@pytest.mark.parametrize("scale", [1, 1e-5])
def test_collision_free_step_of_a_real_time_step(tmp_path, scale):
    x0, faces = read_ply("cloth_ball92")
    x1, _ = read_ply("cloth_ball93")
    ours, theirs = step_bounds(tmp_path, x0, x0 + scale * (x1 - x0), faces, 1e-3)
    assert 0 < theirs < 1
    assert 0.8 * theirs <= ours < 1


@pytest.mark.parametrize("shift", [1e-3, 0.37])
def test_collision_free_step_of_two_cubes(tmp_path, shift):
    """One cube through the other, and aside by `shift` of its height."""
    x0, faces = read_ply("two-cubes-close")
    upper = x0[:, 1] > x0[:, 1].mean()
    height = np.ptp(x0[:, 1])
    x1 = x0 + upper[:, None] * height * np.array([shift, -1, 0.7 * shift])
    ours, theirs = step_bounds(tmp_path, x0, x1, faces, 1e-2)
    assert 0 < theirs < 1
    assert 0.8 * theirs <= ours < 1
