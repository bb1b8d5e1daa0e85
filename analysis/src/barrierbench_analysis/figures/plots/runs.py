"""The figures of a folder of runs (condition, iterations, gaps) as kinds of the comparison."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.tables.records import Records

from . import condition as of_condition
from . import gaps as of_gaps
from . import iterations as of_iterations
from .drawing import OF_RUNS, Drawing, common, outcomes
from .subjects import SweepRecords


def _figure(
    module, subject: SweepRecords, drawing: Drawing, statistic: str, has: Callable[[Records], bool], what: str
) -> list[Path]:
    records = subject.records
    if not has(records):
        raise drawing.nothing(f"no run has {what} ({outcomes(records.runs)})")
    group = records.runs["group"].iloc[0]
    paths = module.figure(records, group, drawing.stem.parent, drawing.stem.name)
    facts = Facts(outcomes(records.runs), statistic, "none", common(records.runs, OF_RUNS))
    return drawing.state(paths, facts)


def condition(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    return _figure(
        of_condition,
        subject,
        drawing,
        "none: every estimate is drawn",
        lambda records: not records.cond.empty and records.cond["cond"].notna().any(),
        "a condition estimate",
    )


def iterations(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    return _figure(
        of_iterations,
        subject,
        drawing,
        "empirical distributions over the steps, and over the diagnosed matrices, of a run",
        lambda records: not records.steps.empty,
        "a step",
    )


def gaps(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    return _figure(
        of_gaps,
        subject,
        drawing,
        "smallest gap of a step end",
        lambda records: not records.steps.empty and records.steps["gap_min_rel"].notna().any(),
        "a gap",
    )
