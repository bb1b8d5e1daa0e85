"""Main effects that a definition makes, whatever the runs say: they are named so, and are no findings."""

from __future__ import annotations

from .effects import Effect
from .factors import Factorial

BDF2 = "its matrix holds 9/4 of the mass over dt^2"
NEWMARK = "its matrix holds four times the mass over dt^2"
REASONS = {  # number, level -> why
    ("bj_p95", "bdf2"): BDF2,
    ("bj_p95", "newmark"): NEWMARK,
    ("pcg", "bdf2"): BDF2,
    ("pcg", "newmark"): NEWMARK,
    (
        "newton",
        "accumulated_toi",
    ): "its steps end at an accumulated time of impact and ask for no convergence",
}


def by_construction(factorial: Factorial, effect: Effect) -> str:
    """Why; empty where nothing but the runs says it, and for interactions."""
    if len(effect.term.parts) > 1:
        return ""
    factor, level = effect.term.parts[0]
    return REASONS.get((effect.metric, factorial.factors[factor].labels[level]), "")
