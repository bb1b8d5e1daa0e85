"""The root of the repository holds what is listed here, and nothing that somebody left."""

import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = {".ci", ".github", "analysis", "barriers", "claims", "cmake", "configs", "containers", "core", "docs", "engines", "examples", "experiments", "python", "results", "tests"}
FILES = {".clang-format", ".clang-tidy", ".gitignore", "bench", "CHANGELOG.md", "CITATION.cff", "CMakeLists.txt", "CMakePresets.json", "CONTRIBUTING.md", "LICENSE", "README.md",
         "mkdocs.yml", "pyproject.toml", "pytest.ini"}


def test_the_root_holds_known_names_alone():
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False)
    if listed.returncode:
        pytest.skip("this tree is no clone: git knows none of its files")
    found = {line.partition("/")[0] for line in listed.stdout.splitlines() if (ROOT / line).exists()}
    assert found == FOLDERS | FILES
