"""How large a scene is, as the program builds it."""

from __future__ import annotations

import json
import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.start import started

from .entry import Entry, write_config

_COUNTS = re.compile(r"^  (\d+) vertices .*\n  surface: (\d+) triangles, (\d+) edges$", re.MULTILINE)


@dataclass(frozen=True)
class Counts:
    """Of a whole scene: vertices, triangles and edges of all surfaces, tetrahedra, and springs, which are the
    segments of rods beside surfaces; without a triangle these are the edges.
    """

    vertices: int
    faces: int
    edges: int
    tetrahedra: int = 0
    springs: int = 0

    def of(self, kind: str) -> int:
        """vertices, faces, tetrahedra or segments."""
        if kind == "segments":
            return self.springs if self.faces else self.edges
        return getattr(self, kind)

    def unlike(self, stated: dict) -> str:
        """Which of the counts that a scene states are others; empty where none is."""
        return ", ".join(
            f"{key} {self.of(key)}, stated {stated[key]}"
            for key in ("vertices", "faces", "segments")
            if key in stated and stated[key] != self.of(key)
        )


def counts_of(entry: Entry, size: str) -> Counts:
    """What `explain` says of the config. Errors: UserError with what the program says: a scene that does
    not fit into memory among them.
    """
    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch) / f"{entry.name}.json"
        write_config(entry, file, size)
        done = started("explain", str(file))
    if done.returncode != 0 or not (found := _COUNTS.search(done.stdout)):
        said = (done.stderr.strip() or done.stdout.strip()).replace(str(file), "").splitlines()
        raise UserError(f"{entry.path} ({size}): {json.dumps(said[0] if said else 'nothing was said')}")
    elements = found.group(0).splitlines()[0]
    more = [re.search(rf"(\d+) {kind}", elements) for kind in ("tetrahedra", "springs")]
    return Counts(*map(int, found.groups()), *(int(one[1]) if one else 0 for one in more))
