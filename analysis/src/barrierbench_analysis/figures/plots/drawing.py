"""What every kind of figure is given beside its records, and how it says that there is nothing to draw."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.tables import series


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


def outcomes(runs: pd.DataFrame) -> str:
    """How many runs, and how many of them failed, for a caption."""
    failed = runs[runs["outcome"] != "ok"]
    words = ", ".join(f"{n} {word}" for word, n in failed["outcome"].value_counts().sort_index().items())
    return f"{len(runs)} runs" + (f", of which {len(failed)} failed ({words})" if words else ", all ok")


def common(runs: pd.DataFrame, columns: dict[str, str]) -> str:
    """`name value` of what all runs share, `name low to high` of numbers that differ; for a caption. columns:
    column -> what it is called.
    """
    words = []
    for column, name in columns.items():
        values = runs[column].dropna().unique() if column in runs else []
        if len(values) == 1:
            words.append(f"{name} {values[0]:g}" if isinstance(values[0], float) else f"{name} {values[0]}")
        elif len(values) > 1 and all(isinstance(v, (int, float)) for v in values):
            words.append(f"{name} {min(values):g} to {max(values):g}")
        elif len(values) > 1:
            words.append(f"{name} {', '.join(map(str, values))}")
    return ", ".join(words)


OF_RUNS = {
    "scene": "scene",
    "scene_free_dofs": "unknowns",
    "d_hat_m": "d_hat (m)",
    "dt_s": "dt (s)",
    "matching_rule": "stiffness by",
    "matching_theta": "theta",
    "linear_solver": "solver",
}
