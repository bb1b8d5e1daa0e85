"""Runs what a gap map lacks, smallest scenes first, for as long as it may."""

from __future__ import annotations

import sys
import time
from concurrent.futures import ThreadPoolExecutor
from itertools import groupby
from pathlib import Path

from ..matching.runs import run
from .kept import Place
from .spec import Cell, Spec, make_sweep


def folder_of(runs: Path, place: Place, digests: dict[Place, str]) -> Path:
    """Of the records of a scene and resolution."""
    return runs / f"{'-'.join(place)}-{digests[place]}"


def chunks(spec: Spec, wanted: list[Cell]) -> list[list[Cell]]:
    """Cells that one call of the program runs: those of one scene, resolution, limit and theta, which share
    their pilot. The fewest unknowns come first.
    """
    size = {(s.label, r): n for s in spec.scenes for r, n in s.unknowns.items()}
    parts = [
        list(part)
        for _, part in groupby(
            sorted(wanted, key=lambda c: (c.scene, c.resolution, c.limit, -c.theta)),
            key=lambda c: (c.scene, c.resolution, c.limit, c.theta),
        )
    ]
    return sorted(parts, key=lambda part: size[part[0].scene, part[0].resolution])


def run_missing(
    spec: Spec, wanted: list[Cell], runs: Path, digests: dict[Place, str], jobs: int, minutes: float | None
) -> None:
    """So many sweeps at a time; what is there is skipped by its run id. After `minutes` no further sweep is
    begun.
    """
    begun = time.monotonic()

    def one(cells: list[Cell]) -> None:
        start, first = time.monotonic(), cells[0]
        if minutes is not None and start - begun > 60 * minutes:
            return
        run(make_sweep(spec, cells), folder_of(runs, (first.scene, first.resolution), digests))
        print(
            f"gap-map: {first.scene} {first.resolution}, limit {first.limit}, theta {first.theta:g},"
            f" {len(cells)} runs, {time.monotonic() - start:.0f} s",
            file=sys.stderr,
        )

    with ThreadPoolExecutor(jobs) as pool:
        list(pool.map(one, chunks(spec, wanted)))
