"""What figures of the comparison are drawn of and with, and how one says that there is nothing to draw."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.tables import series
from barrierbench_analysis.tables.records import Records

if TYPE_CHECKING:
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
        from barrierbench_analysis.tables.run import Run  # it takes scipy

        return Run(self.folder / row["run"])

    def each_run(self) -> list[tuple[pd.Series, Run]]:
        return [(row, self.run(row)) for _, row in self.records.runs.iterrows()]


@dataclass(frozen=True)
class Spectrum:
    """All eigenvalues of a matrix of the corpus, rising, with what its side-car says."""

    name: str
    about: dict
    values: np.ndarray


@dataclass(frozen=True)
class Drawing:
    """stem: of the files that are written; width_in: of a journal's column or columns."""

    name: str
    title: str
    stem: Path
    width_in: float
    options: dict

    def nothing(self, why: str) -> UserError:
        """An axis without data is never drawn."""
        return UserError(f"figure {self.name}: nothing to draw: {why}")

    def panels(self, columns: int, height: float, **how):
        """A figure of this width with so many panels beside each other, and the panels."""
        size = (self.width_in, height)
        fig, axes = plt.subplots(1, columns, figsize=size, layout="constrained", squeeze=False, **how)
        return fig, list(axes[0])

    def save(
        self, fig, numbers: pd.DataFrame, shown: str, facts: Facts, runs: pd.DataFrame | None = None
    ) -> list[Path]:
        """Errors: UserError without numbers, or with more formulations than a figure holds."""
        if numbers.empty:
            raise self.nothing("no number is there")
        if "formulation" in numbers and numbers["formulation"].nunique() > series.MOST:
            found = ", ".join(numbers["formulation"].dropna().unique())
            raise UserError(
                f"figure {self.name}: found {found}; at most {series.MOST} formulations are needed"
            )
        return style.save(fig, self.stem, numbers, f"{self.title}. {shown} {facts.sentence()}", runs)

    def finish(self, fig, axes, *words, runs=None, legend_runs=None) -> list[Path]:
        """Letters, the legend of the first panel, and the files. words: as save takes them."""
        if len(axes) > 1:
            style.letter_panels(axes)
        style.legend_below(fig, axes[0], legend_runs)
        return self.save(fig, *words, runs)

    def state(self, paths: list[Path], facts: Facts) -> list[Path]:
        """Adds title and facts to the captions of figures that others have saved; all their files."""
        for path in paths:
            if path.suffix == ".txt":
                words = textwrap.fill(facts.sentence(), 100)
                write_whole(path, f"{self.title}.\n\n{input_file.read_text(path)}\n{words}\n")
        return paths


def formulations(runs: pd.DataFrame) -> list[str]:
    """Of a table with this column, what the project compares first."""
    return series.ranked(dict.fromkeys(runs["formulation"]))


def each(found: pd.DataFrame, sort: str = "") -> Iterator[tuple[int, str, pd.DataFrame, style.Look]]:
    """Number, name, rows (in the order of a column) and look of every formulation of a table."""
    for k, name in enumerate(formulations(found)):
        mine = found[found["formulation"] == name]
        yield k, name, mine.sort_values(sort) if sort else mine, style.look(name)


def about(row: pd.Series) -> dict:
    """What a row of numbers says of its run."""
    return {name: row[name] for name in ("formulation", "run", "outcome")}


def failed_words(runs: pd.DataFrame) -> str:
    """How many runs failed in which way; empty where none did."""
    counts = runs.loc[runs["outcome"] != "ok", "outcome"].value_counts().sort_index()
    return ", ".join(f"{n} {word}" for word, n in counts.items())


def outcomes(runs: pd.DataFrame) -> str:
    """How many runs, and how many of them failed, for a caption."""
    words, failed = failed_words(runs), int((runs["outcome"] != "ok").sum())
    return f"{len(runs)} runs" + (f", of which {failed} failed ({words})" if words else ", all ok")


NAMES = {  # of columns, in captions
    "scene": "scene",
    "scene_free_dofs": "unknowns",
    "steps": "steps",
    "d_hat_m": "d_hat (m)",
    "dt_s": "dt (s)",
    "matching_rule": "stiffness by",
    "matching_theta": "theta",
    "matching_load_N": "load (N)",
    "linear_solver": "solver",
}
OF_RUNS = "scene scene_free_dofs d_hat_m dt_s matching_rule matching_theta linear_solver"


def common(runs: pd.DataFrame, columns: str = OF_RUNS) -> str:
    """`name value` of what all runs share, `name low to high` of numbers that differ; for a caption. columns:
    of NAMES.
    """
    words = []
    for column in columns.split():
        values, name = runs[column].dropna().unique() if column in runs else [], NAMES[column]
        if len(values) == 1:
            words.append(f"{name} {values[0]:g}" if isinstance(values[0], float) else f"{name} {values[0]}")
        elif len(values) > 1 and all(isinstance(v, (int, float)) for v in values):
            words.append(f"{name} {min(values):g} to {max(values):g}")
        elif len(values) > 1:
            words.append(f"{name} {', '.join(map(str, values))}")
    return ", ".join(words)
