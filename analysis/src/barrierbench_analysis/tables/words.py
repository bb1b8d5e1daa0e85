"""The words of a record in sentences for a reader who has not seen docs/words.md."""

from collections.abc import Mapping

from .numbers import number as number

# Words of core/base/record/outcome.hpp; a test holds the keys to the schema.
OUTCOMES = {
    "invalid_scene": (
        "the scene cannot be run: an element begins beyond its strain limit, or its calibration run could not"
        " be matched; there is no first step"
    ),
    "given_parts_cross": (
        "parts that the scene itself moves or fixes cross each other, which no solver decides"
    ),
    "initial_intersection": "surfaces cross each other before the first step; there is no first step",
    "penetration": "the audit found a surface in or through another",
    "nan": "an energy, a gradient or a position is no finite number",
    "pin_infeasible": "a driven vertex could not reach its place without a collision",
    "ccd_cap": "the step bound reached its number of probes and allowed no progress",
    "stall_overload": "no progress, with a contact load above the largest force that the barrier can carry",
    "newton_stall": "a time step ended at its largest number of iterations without converging",
    "linear_failure": "the linear solver broke down",
    "not_pd": "a matrix that has to be positive definite was not",
    "oom": "memory ran out; the steps before count",
    "kernel_failed": "a kernel of the graphics card failed; the steps before count",
    "timeout": "the time limit of the run was reached between two steps",
    "unproven": "all steps were made, but the audit could not certify every motion",
    "ok": "all steps were made and the audit, where it was requested, is clean",
}

# Words of comparability.verdict.
COMPARED = {
    "comparable": "comparable",
    "not_comparable": "not comparable",
    "no_reference": "no reference",
    "not_valid": "not valid",
}


def meaning(outcome: str) -> str:
    """Of an outcome; a word of a later version has none here."""
    return OUTCOMES.get(outcome, "a word that this version does not know (./bench help record)")


def reservations(row: Mapping) -> list[str]:
    """What the audit of a run that ended ok allows, by a row of `runs`; empty: its surfaces kept out of each
    other and of all obstacles.
    """
    found = {
        "obstacles are judged by points": row.get("audit_obstacles_judge") == "points",
        "overlaps within its promise": (row.get("audit_overlaps") or 0) > 0,
        "corners of obstacles cut": (row.get("audit_corners_cut") or 0) > 0,
    }
    return [text for text, holds in found.items() if holds]


def counted(count: int, one: str, many: str = "") -> str:
    """`1 run`, `2 runs`, `no run`."""
    return f"{count or 'no'} {one if count in (0, 1) else many or one + 's'}"


def listed(words: list[str], most: int = 8) -> str:
    """`a, b and c`; of more than `most` the first ones and how many others there are."""
    if len(words) > most:
        return f"{', '.join(words[:most])} and {len(words) - most} others"
    return f"{', '.join(words[:-1])} and {words[-1]}" if len(words) > 1 else "".join(words)
