"""The policy elasticity_inclusive against the IPC Toolkit's semi_implicit_stiffness: one number a stencil.

Both are w^T (M/d^2 + H) w/(w^T w), the mass part times 1 m^2/s^2 (Ando 2024). The toolkit takes all vertices of a stencil and
whatever matrix it is given; here free vertices alone count, with the projected Hessian, so all are free and H is positive
semi-definite. Skipped when ipctk is missing.
"""

import json
import os
import subprocess

import numpy as np
import pytest

ipctk = pytest.importorskip("ipctk", reason="the oracle ipctk is not installed")
PROGRAM = os.environ.get("BARRIERBENCH_PROGRAM", "")
pytestmark = pytest.mark.skipif(not os.access(PROGRAM, os.X_OK), reason="BARRIERBENCH_PROGRAM is not set")

POINTS = {"vertex": 1, "edge": 2, "face": 3}
STENCILS = {
    "VertexVertexCandidate": ("vertex", "vertex"),
    "EdgeVertexCandidate": ("edge", "vertex"),
    "FaceVertexCandidate": ("face", "vertex"),
    "EdgeEdgeCandidate": ("edge", "edge"),
}


def stencil_of(kind, rng):
    """A stencil of the toolkit and its vertices, m, with the closest points inside its features."""
    x = {"VertexVertexCandidate": [[0, 0, 0], [0.1, 0.2, 0.3]],
         "EdgeVertexCandidate": [[0.4, 0.2, 0.3], [-1, 0, 0], [1, 0, 0]],
         "FaceVertexCandidate": [[0.2, 0.3, 0.1], [-1, -1, 0], [2, -1, 0], [0, 2, 0]],
         "EdgeEdgeCandidate": [[-1, 0, 0], [1, 0, 0], [0.1, -1, 0.2], [-0.1, 1, 0.2]]}[kind]  # fmt: skip
    return getattr(ipctk, kind)(0, 1), np.array(x) + 0.02 * rng.uniform(-1, 1, np.shape(x))


def positive_matrix(rng, n):
    root = rng.uniform(-3, 3, (n, n))
    return root @ root.T


def ours(weights, r, offset, masses, hessian):
    query = {"kind": "stiffness", "policy": "elasticity_inclusive", "mass_term": "paper", "weights": weights.tolist(),
             "normal": (r / np.linalg.norm(r)).tolist(), "gap": float(np.linalg.norm(r) - offset), "masses": masses.tolist(),
             "hessian": hessian.tolist()}  # fmt: skip
    done = subprocess.run([PROGRAM, "eval"], input=json.dumps(query) + "\n", capture_output=True, text=True, check=True)
    return json.loads(done.stdout)["kappa"]


@pytest.mark.parametrize("kind", STENCILS)
@pytest.mark.parametrize("offset", [0.0, 0.03])
def test_kappa_of_a_stencil(kind, offset):
    rng = np.random.default_rng(len(kind))
    stencil, x = stencil_of(kind, rng)
    weights = np.asarray(stencil.compute_coefficients(x.ravel()))
    assert (weights != 0).all() and len(weights) == len(x)
    masses, hessian = rng.uniform(0.1, 2, len(x)), positive_matrix(rng, 3 * len(x))
    theirs = ipctk.semi_implicit_stiffness(stencil, x.ravel(), masses, np.asfortranarray(hessian), offset)
    without_mass = ipctk.semi_implicit_stiffness(stencil, x.ravel(), 0 * masses, np.asfortranarray(hessian), offset)
    assert theirs > without_mass > 0  # both parts are there
    assert ours(weights, weights @ x, offset, masses, hessian) == pytest.approx(theirs, rel=1e-12)
