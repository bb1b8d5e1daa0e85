"""Numbers of verdicts in words."""

from barrierbench_analysis.tables import numbers
from barrierbench_analysis.tables.numbers import ratio

from .verdict import Judged


def interval(j: Judged) -> str:
    if j.value is None:
        return "-"
    if j.lower is None:
        return f"{ratio(j.value)} (one scene: no interval)"
    if j.extremes:
        return ratio(j.value) if j.lower == j.upper else f"{ratio(j.lower)} to {ratio(j.upper)}"
    return numbers.interval(j.value, j.lower, j.upper, ratio)
