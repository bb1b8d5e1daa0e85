"""What the rest of a study is expected to take: seconds of one core, by those of its kept rows."""

from __future__ import annotations

import math
from dataclasses import replace

from barrierbench_analysis.tables.statistics import slope
from barrierbench_analysis.tables.words import counted

from . import store
from .collect import missing
from .spec import SEED, Cell, Study

# The power of the unknowns by which seconds grow where kept rows do not tell: a cloth of 192 to 2,352
# unknowns has it.
GROWTH = 1.7
SPAN = 3.0  # largest over smallest number of unknowns from which on rows tell the power


def growth(rows: list[store.Row]) -> float:
    """Power p of seconds ~ unknowns^p, at least 1; GROWTH where less than a factor SPAN in size was
    measured."""
    rows = [row for row in rows if row.unknowns]  # of those that left a record
    sizes = {row.unknowns for row in rows}
    if not sizes or max(sizes) < SPAN * min(sizes):
        return GROWTH
    return max(1.0, slope((math.log(row.unknowns), math.log(max(row.seconds, 1e-3))) for row in rows))


def expected(cell: Cell, rows: list[store.Row], power: float) -> float | None:
    """Seconds: the mean of the rows that differ in the fewest labels; where the cell knows its unknowns, of
    those of the nearest size, grown by the power. None without rows, and where a label of the cell stands in
    no row and its unknowns are not known.
    """
    if cell.unknowns:
        rows = [row for row in rows if row.unknowns]
    elif any(
        all(row.place[name] != word for row in rows) for name, word in cell.place.items() if name != SEED
    ):
        return None
    if not rows:
        return None
    size = cell.unknowns or 1

    def distance(row: store.Row) -> tuple[float, int]:
        far = abs(math.log(row.unknowns / size)) if cell.unknowns else 0.0
        return round(far, 6), sum(row.place[name] != word for name, word in cell.place.items())

    near = min(map(distance, rows))
    chosen = [row for row in rows if distance(row) == near]
    grown = [row.seconds * ((size / row.unknowns) ** power if cell.unknowns else 1.0) for row in chosen]
    return sum(grown) / len(grown)


def plan(study: Study, rows: dict[str, store.Row], chosen: list[Cell]) -> list[str]:
    """Lines: cells, those with a row, those that need none, and what the rest takes as far as rows tell.
    chosen: the cells that a call would run, all that are missing or some of them.
    """
    lacking = {cell.key for cell in missing(study, rows)}
    left = [cell for cell in chosen if cell.key in lacking]
    there = sum(cell.key in rows and cell.key not in lacking for cell in study.cells)
    lines = [
        f"{study.name}: {counted(len(study.cells), 'cell')}, {there} with a row in"
        f" {store.file_of(study).name}, {len(left)} to run"
    ]
    if decided := len(study.cells) - there - len(lacking):
        need = "needs" if decided == 1 else "need"
        lines.append(f"{counted(decided, 'more cell')} {need} no run, since others decide the outcome")
    kept = [replace(rows[cell.key], place=cell.place) for cell in study.cells if cell.key in rows]
    power = growth(kept)
    known = [seconds for cell in left if (seconds := expected(cell, kept, power)) is not None]
    if known:
        total = f"{sum(known):.0f} s" if sum(known) < 3600 else f"{sum(known) / 3600:.1f} h"
        lines.append(f"about {total} of one core for {counted(len(known), 'run')} of these")
    if unknown := len(left) - len(known):
        lines.append(f"{counted(unknown, 'run')} without a kept row whose labels are alike: not estimated")
    return lines
