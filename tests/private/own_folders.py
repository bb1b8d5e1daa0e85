"""A test sees the clone and its own folders: what it reads or writes elsewhere, and what it leaves there, fails it.

However pytest is started, tests run with a private home, temporary folder and cache, and with few variables of this machine's
environment (analysis/src/barrierbench_analysis/front/private.py). Programs that are no Python are watched by what they leave; what they read, .ci/run keeps from them.
"""

import atexit
import os
import shutil
import tempfile
from pathlib import Path

import pytest

from barrierbench_analysis.front.private import compiler_cache, left_over, variables
from tests.private import outside

PLACE = "BARRIERBENCH_TESTS_PLACE"  # the variable with the folder of this run of pytest, which its workers share


def begin() -> None:
    """In this process, a run of pytest or a worker of one, before anything reads the environment."""
    if PLACE not in os.environ:
        os.environ[PLACE] = os.path.realpath(tempfile.mkdtemp(prefix="barrierbench-tests-"))
        atexit.register(shutil.rmtree, os.environ[PLACE], ignore_errors=True)
    shared = Path(os.environ[PLACE])
    place = shared / os.environ.get("PYTEST_XDIST_WORKER", "alone")
    own = variables(place, os.environ)
    cache = {"XDG_CACHE_HOME": str(shared / "cache"), "MPLCONFIGDIR": str(shared / "cache/matplotlib"), "CUDA_CACHE_PATH": str(shared / "cache/nv")}  # what is made once for all
    tools = [folder for folder in os.environ["PATH"].split(os.pathsep) if os.path.isabs(folder)]  # where a search for a program looks
    folders = os.pathsep.join([str(shared), compiler_cache(os.environ), *tools, *filter(None, [os.environ.get("BARRIERBENCH_DATA")])])
    watched = {outside.TOLD: str(place / "outside.txt"), outside.FOLDERS: folders, "PYTHONPATH": str(Path(__file__).parent)}
    os.environ.clear()
    os.environ.update(own | cache | watched)
    tempfile.tempdir = None
    outside.start()


def reported() -> list[str]:
    """What was read and written outside since the last call."""
    file = Path(os.environ[outside.TOLD])
    lines = file.read_text(errors="replace").splitlines() if file.exists() else []
    file.unlink(missing_ok=True)
    return list(dict.fromkeys(lines))


@pytest.fixture(autouse=True)
def own_folders_only():
    yield
    lines = reported() + [f"leaves {path}" for path in left_over(Path(os.environ[outside.TOLD]).parent, "pytest-of-*")]
    assert not lines, "outside the clone and the test's own folders:\n" + "\n".join(lines)
