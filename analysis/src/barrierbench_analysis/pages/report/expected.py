"""Which runs are expected to fail: those of configs/report/expected.json, and those of a stress test whose
expectation leaves `ok` out. Both are read from the specs of this repository, not from the records.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.spec_file import read_spec
from barrierbench_analysis.tables.outcomes import counted_as

FILE = ROOT / "configs/report/expected.json"
STRESS = "stress"  # the name of the sweeps of the stress suite


@dataclass(frozen=True)
class End:
    """How a run is expected to fail, and why."""

    outcomes: tuple[str, ...]
    because: str


@cache
def _listed() -> dict[tuple[str, str], End]:
    """(sweep, label of a case) -> its end. Errors: UserError for a file that is no list of expected ends."""
    return {
        (sweep, one["case"]): End(tuple(one["outcomes"]), one["because"])
        for sweep, cases in read_spec(FILE, "expected_ends")["sweeps"].items()
        for one in cases
    }


@cache
def _of_stress(name: str) -> dict[str, End]:
    """Label of a run without the key of its cell -> its end, of a stress test by its id; empty where this
    tree has no such test.
    """
    from barrierbench_analysis.studies.rules.stress.entry import OUTCOMES, read_test  # others need no test

    try:
        test = read_test(name)
    except UserError:
        return {}
    found = {}
    for formulation in test.formulations:
        for case in test.cases:
            expected = test.expected(formulation.label, case.label)
            if not expected.holds("ok"):
                outcomes = tuple(word for word in OUTCOMES if expected.holds(word))
                label = f"{name} {formulation.label} {case.label}".replace("/", " per ")
                found[label] = End(outcomes, expected.reason)
    return found


def end_of(row: Mapping) -> End | None:
    """Of a row of `runs`: how it is expected to fail; None where it is expected to end ok and to be valid."""
    group, series = row["group"], row["series"]
    if group == STRESS:
        return _of_stress(series.partition(" ")[0]).get(series.rpartition(" ")[0])
    return _listed().get((group, series))


def word_of(row: Mapping) -> str:
    """What a row of `runs` is counted as."""
    return counted_as(row["outcome"], row["valid"])
