"""The map as a table: a row for every run that the spec asks for, whether it is there or not."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from barrierbench_analysis.studies.kit.study.page import rows_of
from barrierbench_analysis.studies.kit.study.spec import Study, read_study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.tables.outcomes import OK

from .measured import MEASURED
from .spec import Run, reachable, run_of, runs

NOT_RUN = "not run"
CANNOT = "cannot reach"  # theta lies beyond the peak of the force: no contact rests there
NO_CONTACT = "no contact"
COLUMNS = (*Run._fields, "outcome", "unknowns", "seconds", "newton", *MEASURED)


def row_of(run: Run, outcome: str, **values) -> dict:
    """One row of the table; None where a value is not known."""
    if outcome == OK and values["gap"] is None:
        outcome = NO_CONTACT
    return dict.fromkeys(COLUMNS) | run._asdict() | {"outcome": outcome} | values


@dataclass(frozen=True)
class Map:
    about: dict  # of the spec
    rows: list[dict]  # in its order

    @property
    def shapes(self) -> list[str]:
        return [shape["label"] for shape in self.about["shapes"]]

    @property
    def scenes(self) -> list[str]:
        return [scene["label"] for scene in self.about["scenes"]]

    @property
    def main(self) -> list[str]:
        return self.about["main"]

    @property
    def limits(self) -> list[str]:
        return self.about["limits"]

    @property
    def gaps(self) -> list[float]:
        return self.about["gaps"]

    @property
    def made(self) -> list[dict]:
        """Rows that are of a run."""
        return [row for row in self.rows if row["outcome"] not in (NOT_RUN, CANNOT)]

    @property
    def unknowns(self) -> tuple[int, int]:
        """Of the smallest and of the largest run."""
        sizes = [row["unknowns"] for row in self.made]
        return min(sizes), max(sizes)

    def counts(self) -> dict[str, int]:
        """How the cells of the map ended."""
        ends = [row["outcome"] for row in self.rows]
        found = {word: ends.count(word) for word in (OK, CANNOT, NO_CONTACT, NOT_RUN)}
        return {"cells": len(ends)} | found | {"failed": len(ends) - sum(found.values())}

    def extent(self) -> str:
        """Of every scene: its resolutions with the runs that are there, of those that can be."""
        by: dict[str, dict[str, list[bool]]] = {}
        for row in self.rows:
            if row["outcome"] != CANNOT:
                there = by.setdefault(row["scene"], {}).setdefault(row["resolution"], [])
                there.append(row["outcome"] != NOT_RUN)
        return "; ".join(
            f"{scene} " + ", ".join(f"{size}: {sum(there)} of {len(there)}" for size, there in sizes.items())
            for scene, sizes in by.items()
        )


def map_of(study: Study, rows: Iterable[Row]) -> Map:
    there, found = reachable(study.about), {run_of(row.place): row for row in rows}

    def one(run: Run) -> dict:
        if (run.shape, run.theta) not in there:
            return row_of(run, CANNOT)
        row = found.get(run)
        if row is None:
            return row_of(run, NOT_RUN)
        return row_of(run, row.outcome, unknowns=row.unknowns, seconds=row.seconds, **row.values)

    return Map(study.about, [one(run) for run in runs(study.about)])


def kept_map(file: Path | None = None) -> Map:
    """The map of results/studies/gap_map.jsonl, or of the rows of another file. Errors: UserError."""
    study = read_study("gap_map")
    return map_of(study, rows_of(study, file))
