"""Repeated `accept` in small steps: a number is held against the first baseline as well as against the last.

Each accept may move a number by its tolerance, so that ten of them move it by ten. A number that the last
baseline passes is a `drift`, and red, when it is further from the first value than FACTOR times the half
width of its envelope, on the side that is no better. `bench gate accept --drift
--reason "..."` makes the last value the first one, and the baseline keeps that it was done, when, and why.
"""

import json
from dataclasses import asdict, dataclass

from barrierbench_analysis.io.digests import of_text

FACTOR = 2
LOGARITHMIC_UNIT = "d_hat"  # gaps: their envelopes are ratios


@dataclass(frozen=True)
class First:
    """What the first baseline said of a metric."""

    value: float
    date: str = ""
    commit: str = ""
    reason: str = ""
    made_by: str = ""  # digest
    here: bool = False  # made by what made the last baseline

    def json(self) -> dict:
        return {name: value for name, value in asdict(self).items() if name != "here"}


def digest(made_by: dict) -> str:
    return of_text(json.dumps(made_by, sort_keys=True))[:12]


def limits(
    first: float, value: float, lower: float, upper: float, unit: str, each: float | None = None
) -> tuple[float, float]:
    """How far a number may be from the first value, the last being `value` in [lower, upper]. each: what a
    cost may rise by at one accept.
    """
    if each is not None:
        return float("-inf"), first * each**FACTOR
    if unit == LOGARITHMIC_UNIT and first > 0 and lower > 0:
        return first * (lower / value) ** FACTOR, first * (upper / value) ** FACTOR
    return first - FACTOR * (value - lower), first + FACTOR * (upper - value)


def note(first: First, lower: float, upper: float, word: str) -> str:
    return (
        f"{word} since the first baseline ({first.value:.6g}, {first.date or 'no date'}): outside"
        f' {lower:.6g} .. {upper:.6g}, {FACTOR} tolerances; bench gate accept --drift --reason "..." if it is'
        " meant"
    )
