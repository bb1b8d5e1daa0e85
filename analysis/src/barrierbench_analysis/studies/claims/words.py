"""Numbers of verdicts in words."""

from __future__ import annotations

from .verdict import Judged


def number(x: float | None) -> str:
    """Three digits, and more where these would make it 1."""
    if x is None:
        return "-"
    return f"{x:.6g}" if x != 1 and f"{x:.3g}" == "1" else f"{x:.3g}"


def interval(j: Judged) -> str:
    if j.value is None:
        return "-"
    if j.lower is None:
        return f"{number(j.value)} (one scene: no interval)"
    if j.extremes:
        return number(j.value) if j.lower == j.upper else f"{number(j.lower)} to {number(j.upper)}"
    return f"{number(j.value)} [{number(j.lower)}, {number(j.upper)}]"
