"""What the rest of a study is expected to take: seconds of one core, by those of its kept rows."""

import math
from dataclasses import replace
from pathlib import Path

from barrierbench_analysis.tables.statistics import slope
from barrierbench_analysis.tables.words import counted

from . import store
from .collect import current, left_out, wanted
from .spec import SEED, Cell, Study

# The power of the unknowns by which seconds grow where kept rows do not tell: a cloth of 192 to 2,352
# unknowns has it.
GROWTH = 1.7
SPAN = 3.0  # largest over smallest number of unknowns from which on rows tell the power


def growth(rows: list[store.Row], unmeasured: float = GROWTH) -> float:
    """Power p of seconds ~ unknowns^p, at least 1; the given one where less than a factor SPAN in size was
    measured."""
    rows = [row for row in rows if row.unknowns]  # of those that left a record
    sizes = {row.unknowns for row in rows}
    if not sizes or max(sizes) < SPAN * min(sizes):
        return unmeasured
    return max(1.0, slope((math.log(row.unknowns), math.log(max(row.seconds, 1e-3))) for row in rows))


def expected(cell: Cell, rows: list[store.Row], power: float) -> float | None:
    """Seconds: the mean of the rows that differ in the fewest labels; where the cell knows its unknowns, of
    those of the nearest size, grown by the power. None without rows, and where a label of the cell stands in
    no row and its unknowns are not known.
    """
    size = cell.unknowns
    if size:
        far = {n: round(abs(math.log(n / size)), 6) for n in {row.unknowns for row in rows} if n}
        near = min(far.values(), default=0.0)
        rows = [row for row in rows if row.unknowns and far[row.unknowns] == near]
    elif any(
        all(row.place[name] != word for row in rows) for name, word in cell.place.items() if name != SEED
    ):
        return None
    if not rows:
        return None
    other = [sum(row.place[name] != word for name, word in cell.place.items()) for row in rows]
    fewest = min(other)
    chosen = [row for row, n in zip(rows, other, strict=True) if n == fewest]
    grown = [row.seconds * ((size / row.unknowns) ** power if size else 1.0) for row in chosen]
    return sum(grown) / len(grown)


def in_lines(
    name: str, file: Path, cells: int, there: int, seconds: list[float | None], decided: int = 0
) -> list[str]:
    """What a plan says: cells, those with a row in a file, those that need none, and what the rest takes.
    seconds: expected of each cell to run, None where no kept row is like it.
    """
    lines = [f"{name}: {counted(cells, 'cell')}, {there} with a row in {file.name}, {len(seconds)} to run"]
    if decided:
        need = "needs" if decided == 1 else "need"
        lines.append(f"{counted(decided, 'more cell')} {need} no run, since others decide the outcome")
    if known := [one for one in seconds if one is not None]:
        total = f"{sum(known):.0f} s" if sum(known) < 3600 else f"{sum(known) / 3600:.1f} h"
        lines.append(f"about {total} of one core for {counted(len(known), 'run')} of these")
    if unknown := len(seconds) - len(known):
        lines.append(f"{counted(unknown, 'run')} without a kept row whose labels are alike: not estimated")
    return lines


def plan(
    study: Study, rows: dict[str, store.Row], chosen: list[Cell], every: bool = False, again: bool = False
) -> list[str]:
    """Lines: cells, those with a row, those that need none, what the rest takes as far as rows tell, and what
    the rule adds (function `planned`). chosen: the cells of the call. every, again: as wanted().
    """
    to_run = {cell.key for cell in wanted(study, rows, every, again)}
    kept = [
        replace(row, place=cell.place)
        for cell in study.cells
        if (row := rows.get(cell.key)) and row.seconds is not None
    ]
    power = growth(kept)
    seconds = [expected(cell, kept, power) for cell in chosen if cell.key in to_run]
    decided = 0 if every else len(left_out(study, rows))
    there = len(current(study, rows))
    more = getattr(study.module, "planned", lambda *_: [])(study, rows)
    return [*in_lines(study.name, store.file_of(study), len(study.cells), there, seconds, decided), *more]
