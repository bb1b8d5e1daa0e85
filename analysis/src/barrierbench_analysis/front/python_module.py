"""The verb python: builds the Python module barrierbench in the release build and runs its tests."""

import os
import subprocess
import sys

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.program.building import build, folder, say, setup

MODULE = ("barrierbench_python", "barrierbench_python_stub")
PACKAGE = "python3-dev"  # of Debian: the headers of Python
TOOLS = ROOT / "build/python-tools"  # nanobind, which only builds
REQUIREMENTS = ROOT / "python/requirements.txt"


def module_folder() -> str:
    """What PYTHONPATH has to name."""
    return str(folder("release") / "python")


def _install_tools() -> None:
    """Once for each version of the list. Errors: UserError."""
    stamp = TOOLS / "installed.txt"
    if stamp.is_file() and input_file.read_text(stamp) == input_file.read_text(REQUIREMENTS):
        return
    words = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--upgrade"]
    words += ["--target", str(TOOLS), "--requirement", str(REQUIREMENTS)]
    if subprocess.run(words, stdout=sys.stderr, check=False).returncode != 0:
        raise UserError(f"cannot install {REQUIREMENTS.relative_to(ROOT)}: is there a network?")
    stamp.write_text(input_file.read_text(REQUIREMENTS))


def options() -> dict[str, str]:
    """What a build with the module is configured with. Installs what only builds. Errors: UserError."""
    _install_tools()
    return {
        "BB_PYTHON": "ON",
        "Python_EXECUTABLE": sys.executable,
        "nanobind_ROOT": str(TOOLS / "nanobind/cmake"),
    }


def build_module() -> None:
    """The module, its stubs and the program, in build/release. Errors: UserError."""
    setup(PACKAGE)
    build("release", *MODULE, "barrierbench", options=options())


@reported("dev python")
def main(argv: list[str]) -> int:
    build_module()
    say(f"built: PYTHONPATH={os.path.relpath(module_folder())}")
    if argv == ["--no-tests"]:
        return 0
    words = [sys.executable, *"-m pytest -q -rs -p no:cacheprovider -c".split(), str(ROOT / "pytest.ini")]
    return subprocess.run([*words, *argv, str(ROOT / "tests/python_module")], check=False).returncode
