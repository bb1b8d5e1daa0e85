"""Runs and counts of the suite against what was expected of them, and the tables of the page."""

from collections import Counter
from dataclasses import dataclass, field

from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.tables.numbers import significant
from barrierbench_analysis.tables.outcomes import NOT_VALID, OK

from .entry import Expected, Test
from .geometry import Count, judge
from .relations import Relation, relations

# Contacts are counted at step ends; a run that stopped earlier may have had them before its first one.
TO_THE_END = (OK, NOT_VALID, "unproven")


@dataclass(frozen=True)
class Run:
    """A row beside what was expected of it. defect: a known one of the program that explains it."""

    row: Row
    expected: Expected
    as_expected: bool
    detail: str
    defect: str

    @property
    def mark(self) -> str:
        """Around its outcome: bold, not expected; italic, a known defect."""
        return "" if self.as_expected else "*" if self.defect else "**"


@dataclass(frozen=True)
class Counted:
    """A count of geometry beside what it may be at most."""

    count: Count
    precision: str
    allowed: dict
    as_expected: bool


@dataclass
class Result:
    """One test."""

    test: Test
    runs: list[Run] = field(default_factory=list)
    counts: list[Counted] = field(default_factory=list)
    relations: list[Relation] = field(default_factory=list)

    @property
    def unexpected(self) -> list[Run]:
        return [run for run in self.runs if not run.as_expected and not run.defect]

    @property
    def as_expected(self) -> bool:
        """Not so where nothing was judged. What a known defect explains is neither as expected nor not."""
        return (
            (bool(self.runs) or any(one.count.judged for one in self.counts))
            and not self.unexpected
            and all(one.as_expected for one in self.counts)
            and all(relation.holds for relation in self.relations)
        )

    @property
    def faults(self) -> list[str]:
        """Lines: what is not as expected."""
        runs = [
            f"{run.row.place['formulation']}, {run.row.place['case']}: {run.row.outcome}, expected"
            f" {' or '.join(run.expected.outcomes)}: {run.detail[:150]}"
            for run in self.unexpected
        ]
        relations = [
            f"{one.sentence}: {'; '.join(one.broken) or 'nothing was judged'}"
            for one in self.relations
            if not one.holds
        ]
        counts = [
            f"{one.precision}, {one.count.case}: {one.count.numbers}, {one.count.judged} judged"
            for one in self.counts
            if not one.as_expected
        ]
        return [f"{self.test.id} {line}" for line in (*runs, *relations, *counts)]


def run_of(row: Row, test: Test) -> Run:
    """Against what was expected; a contact test that met no contact judged nothing."""
    formulation, case = row.place["formulation"], row.place["case"]
    expected = test.expected(formulation, case)
    holds, detail = expected.holds(row.outcome), row.values["detail"] or ""
    if holds and row.outcome in TO_THE_END and test.data.get("contacts", True) and not row.values["contacts"]:
        holds, detail = False, "no contact was ever active: nothing was tested"
    return Run(row, expected, holds, detail, "" if holds else test.defect(formulation, case, row.outcome))


def result_of(test: Test, rows: list[Row]) -> Result:
    """Of the rows of one test."""
    if "geometry" not in test.data:
        return Result(test, [run_of(row, test) for row in rows], [], relations(test, rows))
    counts = [(Count(**one), row.place["formulation"]) for row in rows for one in row.values["counts"]]
    return Result(test, [], [Counted(count, name, *judge(count, name, test)) for count, name in counts])


def _outcomes(runs: list[Run]) -> str:
    """Words with their numbers of runs, those that are not as expected last."""
    found = Counter((run.mark, run.row.outcome) for run in runs)
    return (
        ", ".join(
            f"{mark}{word}{f' {n}' if n > 1 else ''}{mark}"
            for (mark, word), n in sorted(found.items(), key=lambda one: len(one[0][0]))
        )
        or "-"
    )


def _numbers(runs: list[Run]) -> str:
    """Smallest gap over d_hat, in ulps, Newton iterations, seconds; of all cases."""

    def known(name: str) -> list[float]:
        return [run.row.values[name] for run in runs if run.row.values[name] is not None]

    gap, ulps = (min(known(name), default=None) for name in ("gap_min_rel", "gap_min_ulps"))
    seconds = significant(sum(known("seconds")), 2)
    return f"{significant(gap, 2)}, {significant(ulps, 1)}, {sum(known('newton'))}, {seconds}"


def tables(results: list[Result]) -> dict:
    """Outcomes and numbers of the formulations that most tests run, the comparable ones, and a table of each
    test that has its own.
    """
    common = [one for one in results if one.test.groups]
    labels = list(dict.fromkeys(f.label for one in common for f in one.test.formulations))

    def of(result: Result, label: str) -> list[Run]:
        return [run for run in result.runs if run.row.place["formulation"] == label]

    def table(cell, title) -> str:
        body = [[title(one.test), *(cell(of(one, label)) for label in labels)] for one in common]
        return "\n".join(markdown(["test", *labels], body))

    def own(result: Result) -> str:
        body = []
        for label in (f.label for f in result.test.formulations):
            runs = of(result, label)
            linear = significant(sum(run.row.values["linear"] or 0 for run in runs), 6)
            body.append([label, _outcomes(runs), _numbers(runs), linear])
        head = ["formulation", "outcome", "gap, ulps, Newton, seconds", "PCG iterations"]
        return "\n".join(markdown(head, body))

    return {
        "outcomes": table(_outcomes, lambda test: f"{test.id} {test.data['title']}"),
        "numbers": table(_numbers, lambda test: test.id),
        "own": [(one.test, own(one)) for one in results if one.test.formulations and not one.test.groups],
    }
