"""The id that cells of a mesh file have in a scene of PolyFEM which selects no volume.

PolyFEM (MshReader.cpp at 661588e8d9) takes the first physical group of the volume of a cell, which only
$Entities of MSH 4.1 name; all other cells have the id 0. The layout of $Entities is that of the Gmsh manual.
"""

from itertools import islice
from pathlib import Path

from barrierbench_analysis.io.input_file import opened

BOX = 6  # numbers of the box around a volume, between its own number and its groups


def stored_id(path: Path) -> int | None:
    """None where it is not known: volumes of several groups, or a binary file that has $Entities."""
    if path.suffix.lower() != ".msh":
        return 0
    with opened(path) as file:
        version, kind = "", "0"
        for line in file:
            word = line.strip()
            if word == b"$MeshFormat":
                version, kind, *_ = [*next(file, b"").decode("ascii", "replace").split(), "", ""]
            if word == b"$Nodes" or version.startswith("2"):
                return 0
            if word == b"$Entities":
                return _of_entities(file) if kind == "0" else None
    return 0


def _of_entities(file) -> int | None:
    """The first group of all volumes; 0 of volumes without one."""
    try:
        *below, volumes = map(int, next(file, b"").split())
        rows = [line.split()[1 + BOX :] for line in islice(file, sum(below), sum(below) + volumes)]
        groups = {int(row[1]) if int(row[0]) else 0 for row in rows}
    except (ValueError, IndexError):
        return None
    return groups.pop() if len(groups) == 1 else None
