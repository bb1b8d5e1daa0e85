"""How large scenes are, as the program builds them."""

import json
import os
import re
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TypeVar

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.progress import counted
from barrierbench_analysis.program.start import started

from .entry import Entry, write_config

T, Built = TypeVar("T"), TypeVar("Built")
KINDS = ("vertices", "faces", "tetrahedra", "segments")
LARGE = 500_000  # vertices, from which on a scene is built only where it is named
_COUNTS = re.compile(r"^(  (\d+) vertices .*)\n  surface: (\d+) triangles, (\d+) edges$", re.MULTILINE)


def counts_of(entry: Entry, size: str) -> dict[str, int]:
    """Of a whole scene by `explain`: vertices, triangles of all surfaces, tetrahedra, and segments, which are
    springs beside surfaces, and all edges where there is no triangle. Errors: UserError with what the program
    prints: a scene that does not fit into memory among them.
    """
    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch) / f"{entry.name}.json"
        write_config(entry, file, size)
        done = started("explain", str(file))
    if done.returncode != 0 or not (found := _COUNTS.search(done.stdout)):
        lines = (done.stderr.strip() or done.stdout.strip()).replace(str(file), "").splitlines()
        raise UserError(f"{entry.path} ({size}): {json.dumps((lines or ['the program printed nothing'])[0])}")
    elements, (vertices, faces, edges) = found[1], map(int, found.groups()[1:])
    more = [re.search(rf"(\d+) {kind}", elements) for kind in ("tetrahedra", "springs")]
    tetrahedra, springs = (int(one[1]) if one else 0 for one in more)
    return dict(zip(KINDS, (vertices, faces, tetrahedra, springs if faces else edges)))


def is_large(entry: Entry, size: str) -> bool:
    return entry.data[size].get("vertices", 0) > LARGE


def unlike(counts: dict[str, int], stated: dict) -> str:
    """Which of the counts that a scene states are others; empty where none is."""
    other = [kind for kind in KINDS if kind in stated and stated[kind] != counts[kind]]
    return ", ".join(f"{kind} {counts[kind]}, stated {stated[kind]}" for kind in other)


def each_built(build: Callable[[T], Built], items: list[T], what: str) -> Iterator[Built]:
    """What `build` makes of each, in order, as many at a time as there are processors: each waits for a
    program of its own.
    """
    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        yield from counted(pool.map(build, items), len(items), f"{what}: built")
