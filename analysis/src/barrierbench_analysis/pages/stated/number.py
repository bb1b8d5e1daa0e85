"""A number with its identity: what is measured, under which conditions, and by which evidence."""

from collections.abc import Iterable
from dataclasses import dataclass

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.tables.numbers import interval

ALIKE = 1.02
OWN, SAME, OFF = "limit of the shape's own form", "the same log limit in every run", "no strain limit"


@dataclass(frozen=True)
class Number:
    """The ratio of a metric of one case to that of another, a mean over scenes with its 95% interval."""

    metric: str
    case: str
    over: str
    theta: float | None
    limit: str
    study: str
    confirmed: bool  # on scenes that no rule was tuned on
    scenes: int
    unknowns: tuple[int, int]
    value: float
    lower: float | None
    upper: float | None
    decided: bool  # by the rule of its study
    places: str = ""  # which runs it is of, where a study has several choices
    sweep: str = ""  # of claims
    alike: int = 0  # scenes in which both numbers are within ALIKE of each other, of claims

    @property
    def quantity(self) -> tuple[str, str, str]:
        return self.metric, self.case, self.over

    @property
    def conditions(self) -> tuple[float | None, str]:
        return self.theta, self.limit

    @property
    def evidence(self) -> str:
        return "confirmed" if self.confirmed else "exploratory"

    def __str__(self) -> str:
        return interval(self.value, self.lower, self.upper)


def strength(number: Number) -> tuple[bool, int, int]:
    """Confirmed before exploratory, more scenes before fewer, finer meshes before coarser ones."""
    return number.confirmed, number.scenes, number.unknowns[1]


def strongest(numbers: Iterable[Number], what: str) -> Number:
    """The one that a headline states. Errors: UserError where there is none, or where two are of other
    quantities or conditions.
    """
    found = list(numbers)
    if not found:
        raise UserError(f"{what}: no number of it is there")
    if len({(n.quantity, n.conditions) for n in found}) > 1:
        raise UserError(
            f"{what}: numbers of several quantities or conditions, of which none is the strongest"
        )
    return max(found, key=strength)
