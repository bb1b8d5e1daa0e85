"""The verb dev modules: the graph of the modules as CMake knows it, checked against the #include lines."""

from __future__ import annotations

import subprocess

from barrierbench_analysis.io.errors import tells
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.program.building import folder, regenerate


@tells("dev modules")
def main(argv: list[str]) -> int:
    regenerate("release")
    modules = folder("release") / "modules.txt"
    words = [
        "cmake",
        f"-DMODULES={modules}",
        f"-DSOURCE_DIR={ROOT}",
        "-DPRINT=ON",
        "-P",
        str(ROOT / "cmake/ModuleCheck.cmake"),
    ]
    return subprocess.run(words, check=False).returncode
