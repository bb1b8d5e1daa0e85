"""Whether this machine holds the runs of a study, by the memory that those of its kept rows had at most. A
spec has the check where one of its metrics is `peak_bytes` (the field summary.peak_rss_bytes of a record).
That of a process which made several runs at a time counts for each of them: an estimate may be too large.
"""

from dataclasses import replace

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.free_memory import free_bytes

from . import cost, store
from .spec import Cell, Study

METRIC = "peak_bytes"
# The least power of the unknowns by which it grows: that of a Cholesky factor of a solid whose unknowns
# nested dissection has ordered (of a shell it is 1, but for a logarithm). Small runs are mostly the program
# itself, so that rows of them would tell a lower one.
GROWTH = 4 / 3
GIB = 1 << 30


def expected(study: Study, rows: dict[str, store.Row], cells: list[Cell]) -> dict[str, float]:
    """key -> bytes of a run, of the cells that know their unknowns; the estimate is that of seconds
    (cost.expected). Empty where no row has the metric.
    """
    kept = [
        replace(row, place=cell.place, seconds=row.values[METRIC])
        for cell in study.cells
        if (row := rows.get(cell.key)) and row.values.get(METRIC)
    ]
    power = max(GROWTH, cost.growth(kept, GROWTH))
    found = {cell.key: cost.expected(cell, kept, power) for cell in cells if cell.unknowns}
    return {key: one for key, one in found.items() if one is not None}


def require(study: Study, rows: dict[str, store.Row], cells: list[Cell], jobs: int) -> None:
    """Errors: UserError, before anything is run, for a cell of which so many at a time need more memory than
    is free.
    """
    needed, free = expected(study, rows, cells), free_bytes()
    for cell in cells if free is not None else []:
        if jobs * needed.get(cell.key, 0) > free:
            raise UserError(
                f"{study.file}: found {cell.label!r}, which needs about {needed[cell.key] / GIB:.1f} GiB by"
                f" the kept rows, {jobs} at a time; allowed: {free / GIB:.1f} GiB, which are free: fewer"
                " --jobs, or --only without it"
            )


def line(study: Study, rows: dict[str, store.Row], cells: list[Cell]) -> list[str]:
    """What a plan says of it."""
    needed = expected(study, rows, cells)
    if not needed:
        return []
    return [
        f"up to {max(needed.values()) / GIB:.1f} GiB of memory for a run; {free_bytes() / GIB:.1f} are free"
    ]
