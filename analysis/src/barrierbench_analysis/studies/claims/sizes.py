"""How large the runs are from which a verdict is computed. The kept rows have no unknowns of a single run:
their sweep keeps the least and the largest number of free unknowns of all its runs, counted or not.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from .table import Table
from .verdict import Judged

SMALL = 5000  # unknowns: a verdict whose largest run has fewer is one of small scenes


@dataclass(frozen=True)
class Sizes:
    """Free unknowns of the smallest and of the largest run."""

    least: int
    largest: int

    @property
    def small(self) -> bool:
        return self.largest < SMALL

    @property
    def mark(self) -> str:
        """What stands beside a verdict; empty where its scenes are not small."""
        return f"of small scenes (up to {self.largest:,} unknowns)" if self.small else ""

    @property
    def words(self) -> str:
        return ("of small scenes, " if self.small else "") + f"{self.least:,} to {self.largest:,} unknowns"


def span(words: str) -> tuple[int, int]:
    """`108 to 600`, as the sweeps keep it."""
    low, _, high = words.partition(" to ")
    return int(low), int(high or low)


def of_sweeps(names: Iterable[str], table: Table) -> Sizes | None:
    """Of all runs of these sweeps; None where there are none, or where one of them keeps no unknowns."""
    kept = [table.sweeps[name].about.get("unknowns") if name in table.sweeps else "" for name in names]
    if not kept or not all(kept):
        return None
    least, largest = zip(*map(span, kept))
    return Sizes(min(least), max(largest))


def of_parts(parts: Iterable[Judged], table: Table) -> Sizes | None:
    """Of the runs that decide: those of the sweeps of all parts that are not beside and no closed forms."""
    return of_sweeps({j.sweep for j in parts if j.sweep and not j.beside}, table)
