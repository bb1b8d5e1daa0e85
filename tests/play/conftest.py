"""Two small runs that the tests of the player share: a cloth and a rod that fall onto a sphere, by two formulations."""

import importlib.util
import shutil
from pathlib import Path

import pytest

from play_runs import run_of

@pytest.fixture(scope="session")
def log_run(program, tmp_path_factory) -> Path:
    return run_of(program, tmp_path_factory.mktemp("play") / "log")


@pytest.fixture(scope="session")
def cubic_run(program, tmp_path_factory) -> Path:
    return run_of(program, tmp_path_factory.mktemp("play") / "cubic", '/formulation/name="cubic"')


@pytest.fixture(scope="session")
def forces_run(program, tmp_path_factory) -> Path:
    settings = ("/output/contact_forces=true", "/output/friction_forces=true", "/friction/mu=0.3")
    return run_of(program, tmp_path_factory.mktemp("play") / "forces", *settings)


@pytest.fixture(scope="session")
def library():
    """The player's library; what needs it is skipped without."""
    if importlib.util.find_spec("k3d") is None:
        pytest.skip("k3d is not installed (./bench setup)")


@pytest.fixture
def copied(log_run, tmp_path) -> Path:
    """A copy of a run to damage."""
    return Path(shutil.copytree(log_run, tmp_path / "copy"))
