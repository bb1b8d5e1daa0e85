"""The verb rooms: the graph of the rooms as CMake knows it, checked against the #include lines."""

from __future__ import annotations

import subprocess

from ..errors import tells
from ..places import ROOT
from .building import folder, regenerate


@tells("rooms")
def main(argv: list[str]) -> int:
    regenerate("release")
    rooms = folder("release") / "rooms.txt"
    words = [
        "cmake",
        f"-DROOMS={rooms}",
        f"-DSOURCE_DIR={ROOT}",
        "-DPRINT=ON",
        "-P",
        str(ROOT / "cmake/RoomCheck.cmake"),
    ]
    return subprocess.run(words, check=False).returncode
