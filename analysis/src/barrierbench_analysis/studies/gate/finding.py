"""One line of a gate's answer, and what the lines say together."""

from collections import Counter
from dataclasses import asdict, dataclass

RED = ("FAIL", "drift")  # drift: further from the first baseline than the last one shows (drift.py)
JUDGED = ("pass", *RED, "better", "xfail", "xpass")  # others are shown alone: report, not_judged
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


def exact(
    case: str, gate_class: str, metric: str, faults: int, judged: int, note: str = "", unit: str = "1"
) -> Finding:
    """Of a check without tolerance, by the number of its faults; judging nothing is a failure."""
    verdict = "pass" if faults == 0 and judged > 0 else "FAIL"
    return Finding(case, gate_class, metric, verdict, faults, 0, unit=unit, judged=judged, note=note)


def not_judged(case: str, gate_class: str, metric: str, note: str, **more) -> Finding:
    return Finding(case, gate_class, metric, "not_judged", judged=0, note=note, **more)


def failures(findings: list[Finding]) -> list[Finding]:
    return [f for f in findings if f.verdict in RED]


def judged(findings: list[Finding]) -> Counter:
    """Class -> how many lines judged something."""
    return Counter(f.gate_class for f in findings if f.verdict in JUDGED and f.judged > 0)


def without_subject(findings: list[Finding], required: tuple[str, ...] = ALL_CLASSES) -> list[Finding]:
    """A failure for each class that has judged nothing: such a gate is no green one."""
    count = judged(findings)
    absent = [c for c in required if count[c] == 0]
    note = "no line of class {} judged anything"
    return [
        Finding("all cases", c, "judged", "FAIL", 0, lower=1, judged=0, note=note.format(c)) for c in absent
    ]


def moved(value: float, reference: float, unit: str) -> str:
    """Direction and size of a change."""
    size = max(abs(reference), 1.0 if unit == "log10" else 0.0)
    if value == reference or abs(value - reference) < SAME * size:
        return "same"
    word = "higher" if value > reference else "lower"
    if unit == "log10":
        return f"{word}, x {10 ** (value - reference):.3g}"
    return f"{word}, {100 * (value - reference) / abs(reference):+.3g}%" if reference else word
