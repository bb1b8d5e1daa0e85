"""What figures are drawn of, and what a spec asks for."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from barrierbench_analysis.tables.records import Records
from barrierbench_analysis.tables.run import Run

SOURCES = ("sweep", "study", "shapes", "matrices", "baselines")


@dataclass(frozen=True)
class Wanted:
    """The records of a figure. source: one of SOURCES; what: a file, or names; alone: runs are timed."""

    source: str
    what: Path | tuple[str, ...]
    alone: bool = False


@dataclass(frozen=True)
class Place:
    """Where records lie, and whether missing ones may be made, so many at a time."""

    runs: Path
    may_run: bool
    jobs: int = 1


@dataclass(frozen=True)
class SweepRecords:
    """All records of a sweep, its runs in the order of the sweep file."""

    name: str
    records: Records
    folder: Path

    def run(self, row: pd.Series) -> Run:
        """With frames and config, of a row of records.runs."""
        return Run(self.folder / row["run"])


@dataclass(frozen=True)
class Spectrum:
    """All eigenvalues of a matrix of the corpus, rising, with what its side-car says."""

    name: str
    about: dict
    values: np.ndarray
