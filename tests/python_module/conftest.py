"""The module that ./bench dev python has built; without it these tests are skipped."""

import importlib
import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
MODULE = Path(os.environ.get("BARRIERBENCH_MODULE", ROOT / "build/release/python"))
sys.path.insert(0, str(MODULE))


@pytest.fixture(scope="session")
def bb():
    """The package barrierbench."""
    if not list(MODULE.glob("barrierbench/_core*.so")):
        pytest.skip("the Python module is not built: ./bench dev python")
    return importlib.import_module("barrierbench")


@pytest.fixture
def drape() -> dict:
    """A cloth that falls onto a sphere: contact from the first steps, one observed pass."""
    return {
        "scene": {"name": "drape", "layers": 1, "n": 8},
        "formulation": {"name": "cubic", "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 1000}},
        "strain_limit": {"enabled": False},
        "matching": {"rule": "as_given"},
        "time": {"steps": 8},
        "passes": {"time": False, "audit": True},
        "threads": 1,
    }


@pytest.fixture
def scripted(bb):
    """A registered step solver that runs the `script` that a test hands it."""
    from python_newton import Scripted

    solver = Scripted()
    bb.register_step_solver(solver)
    return solver


@pytest.fixture(autouse=True)
def scratch(bb, tmp_path_factory, monkeypatch):
    """Meshes without a folder of a run lie there until the process ends."""
    monkeypatch.setattr("barrierbench.meshes._scratch", lambda: tmp_path_factory.mktemp("meshes"))
