"""Which CUDA a build takes (cmake/Cuda.cmake): BB_CUDA, and compilers of several versions; none is an error of a CPU build."""
import os
import stat
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def configure(folder, bb_cuda, **environment):
    """Exit code and output of one configuration; a second one of the same folder looks again."""
    command = ["cmake", "--preset", "release", "-B", str(folder), f"-DBB_CUDA={bb_cuda}", "-DBB_TESTS=OFF", "-DBB_BENCHMARKS=OFF"]
    done = subprocess.run(command, cwd=ROOT, env={**os.environ, **environment}, capture_output=True, text=True, timeout=300)
    return done.returncode, " ".join((done.stdout + done.stderr).split())


@pytest.fixture
def nvcc_11(tmp_path):
    """A compiler of CUDA that only says its version, 11.8."""
    path = tmp_path / "bin" / "nvcc"
    path.parent.mkdir()
    path.write_text("#!/bin/sh\necho 'Cuda compilation tools, release 11.8, V11.8.89'\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


def test_an_old_nvcc_is_no_error_of_a_cpu_build_and_is_said(tmp_path, nvcc_11):
    code, message = configure(tmp_path / "build", "AUTO", CUDACXX=nvcc_11)
    assert code == 0, message
    assert f"CUDA: none ({nvcc_11} is of CUDA '11.8' and 12.0 is the oldest" in message
    defined = (tmp_path / "build" / "build.ninja").read_text()
    assert "BB_CUDA_WHY" in defined and "11.8" in defined


def test_an_old_nvcc_is_an_error_where_device_code_is_demanded(tmp_path, nvcc_11):
    code, message = configure(tmp_path / "build", "ON", CUDACXX=nvcc_11)
    assert code != 0
    assert "BB_CUDA is ON" in message and "'11.8'" in message


def test_a_wrong_value_is_refused_with_what_is_allowed(tmp_path):
    code, message = configure(tmp_path / "build", "MAYBE")
    assert code != 0
    assert "BB_CUDA is 'MAYBE'; allowed: AUTO, CARD, ON, OFF" in message


def test_without_a_card_card_builds_no_kernel(tmp_path):
    (tmp_path / "bin").mkdir()
    smi = tmp_path / "bin" / "nvidia-smi"
    smi.write_text("#!/bin/sh\nexit 9\n")
    smi.chmod(0o755)
    code, message = configure(tmp_path / "build", "CARD", PATH=f"{smi.parent}:{os.environ['PATH']}")
    assert code == 0, message
    assert "CUDA: none" in message
    assert "BB_CUDA_BUILT:INTERNAL=OFF" in (tmp_path / "build" / "CMakeCache.txt").read_text()
