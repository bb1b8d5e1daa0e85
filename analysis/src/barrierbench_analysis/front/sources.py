"""The C++ sources of the tree."""

from __future__ import annotations

from barrierbench_analysis.io.places import ROOT

FOLDERS = ("core", "barriers", "experiments", "python", "examples", "tests")
SUFFIXES = (".cpp", ".hpp", ".c", ".h", ".cu", ".cuh")


def sources() -> list[str]:
    """Relative to the root, sorted."""
    found = (path for folder in FOLDERS for path in (ROOT / folder).rglob("*") if path.suffix in SUFFIXES)
    return sorted(str(path.relative_to(ROOT)) for path in found)
