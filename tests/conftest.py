"""What the Python tests share: the built program and the build folder."""

import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
sys.path.insert(0, str(ROOT / "analysis" / "src"))
sys.path.insert(0, str(ROOT / "tests" / "analysis"))

from tests.private import own_folders  # noqa: E402 (of this tree)
from tests.private.own_folders import own_folders_only  # noqa: E402, F401 (for every test)

own_folders.begin()


def _name_the_blas_kernel() -> None:
    """The kernel for which the program would start itself again (core/linear/blas_kernel.cpp), where the processor has it: so each of the
    thousands of starts in these tests is one. What the program does without is the subject of tests/experiments/test_blas_kernel.py.
    """
    cpuinfo = Path("/proc/cpuinfo")
    flags = cpuinfo.read_text().split() if cpuinfo.exists() else []
    if "avx2" in flags and "fma" in flags:
        os.environ.setdefault("OPENBLAS_CORETYPE", "Haswell")
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


_name_the_blas_kernel()


@pytest.fixture(scope="session")
def program() -> str:
    """Path of the program; the test is skipped when it was not built."""
    path = Path(os.environ.get("BARRIERBENCH_PROGRAM", ROOT / "build/release/experiments/barrierbench"))
    if not path.exists():
        pytest.skip(f"{path} is not built")
    return str(path.resolve())


@pytest.fixture(scope="session")
def build_folder(program) -> Path:
    """The build folder that the program belongs to."""
    return Path(program).parents[1]


@pytest.fixture
def unpainted(monkeypatch):
    """Figures are made whole, but their pictures are empty files: painting is nearly all the time of a test of what stands beside them."""
    from matplotlib.figure import Figure

    monkeypatch.setattr(Figure, "savefig", lambda self, out, **_: None if hasattr(out, "write") else Path(out).touch())
