"""Runs what a gap map lacks, smallest scenes first, for as long as it may."""

from __future__ import annotations

import sys
import time
from concurrent.futures import ThreadPoolExecutor
from itertools import groupby
from pathlib import Path

from barrierbench_analysis.studies.kit.runs import records_in, run

from .kept import Place
from .skips import follows, overloaded
from .spec import Cell, Spec, cells, make_sweep


def folder_of(runs: Path, place: Place, digests: dict[Place, str]) -> Path:
    """Of the records of a scene and resolution."""
    return runs / f"{'-'.join(place)}-{digests[place]}"


def chunks(spec: Spec, wanted: list[Cell]) -> list[list[Cell]]:
    """Cells that one call of the program runs: those of one scene, resolution, limit and theta, which share
    their calibration run. The fewest unknowns come first.
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


def undecided(spec: Spec, wanted: list[Cell], folder: Path, kept: dict[tuple, str]) -> list[Cell]:
    """The cells that no run decides, of those that `kept` has the outcome of and of those in the folder."""
    of_note = {f"gap_map_{spec.name}: {cell.label}": cell.key for cell in cells(spec)}
    found = {note: record["status"]["outcome"] for note, (record, _) in records_in([folder]).items()}
    known = overloaded(kept | {of_note[note]: end for note, end in found.items() if note in of_note})
    return [cell for cell in wanted if follows(cell.key, known) is None]


def run_missing(
    spec: Spec,
    wanted: list[Cell],
    runs: Path,
    digests: dict[Place, str],
    jobs: int,
    minutes: float | None,
    kept: dict[tuple, str] | None,
) -> None:
    """So many sweeps at a time; what is there is skipped by its run id, and a cell that a run decides (kept:
    outcomes of earlier calls; None: every cell is run). After `minutes` no further sweep is begun.
    """
    begun = time.monotonic()

    def one(asked: list[Cell]) -> None:
        start, first = time.monotonic(), asked[0]
        if minutes is not None and start - begun > 60 * minutes:
            return
        folder = folder_of(runs, (first.scene, first.resolution), digests)
        left = asked if kept is None else undecided(spec, asked, folder, kept)
        if left:
            run(make_sweep(spec, left), folder)
        print(
            f"gap-map: {first.scene} {first.resolution}, limit {first.limit}, theta {first.theta:g},"
            f" {len(left)} runs, {len(asked) - len(left)} decided by others,"
            f" {time.monotonic() - start:.0f} s",
            file=sys.stderr,
        )

    with ThreadPoolExecutor(jobs) as pool:
        list(pool.map(one, chunks(spec, wanted)))
