"""One line of a gate's answer, and what the lines say together."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, dataclass

RED = ("FAIL", "drift")  # drift: further from the first baseline than the last one shows (drift.py)
JUDGED = (
    "pass",
    *RED,
    "better",
    "xfail",
    "xpass",
)  # the others are said and judge nothing: report, not_judged
SAME = 1e-6  # relative: a smaller change is not worth a word
ALL_CLASSES = ("I", "II", "III", "IV")


@dataclass
class Finding:
    case: str
    gate_class: str
    metric: str
    verdict: str
    value: float | str | None = None
    reference: float | str | None = None
    lower: float | None = None
    upper: float | None = None
    unit: str = ""
    judged: int = 1  # subjects that were looked at
    note: str = ""

    def json(self) -> dict:
        line = asdict(self)
        line["class"] = line.pop("gate_class")
        return line


def failures(findings: list[Finding]) -> list[Finding]:
    return [f for f in findings if f.verdict in RED]


def judged(findings: list[Finding]) -> Counter:
    """Class -> how many lines judged something."""
    return Counter(f.gate_class for f in findings if f.verdict in JUDGED and f.judged > 0)


def without_subject(findings: list[Finding], required: tuple[str, ...] = ALL_CLASSES) -> list[Finding]:
    """A failure for each class that has judged nothing: such a gate is no green one."""
    count = judged(findings)
    return [
        Finding(
            "all cases",
            c,
            "judged",
            "FAIL",
            value=0,
            lower=1,
            judged=0,
            note=f"no line of class {c} judged anything",
        )
        for c in required
        if count[c] == 0
    ]


def moved(value: float, reference: float, unit: str) -> str:
    """Direction and size of a change."""
    if value == reference or abs(value - reference) < SAME * max(
        abs(reference), 1.0 if unit == "log10" else 0.0
    ):
        return "same"
    word = "higher" if value > reference else "lower"
    if unit == "log10":
        return f"{word}, x {10 ** (value - reference):.3g}"
    return f"{word}, {100 * (value - reference) / abs(reference):+.3g}%" if reference else word
