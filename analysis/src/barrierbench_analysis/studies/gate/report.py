"""What a gate says: a table, how much was judged, and the same as JSON."""

import argparse
import json
from collections import Counter
from pathlib import Path

from barrierbench_analysis.io.text_table import aligned
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.tables.numbers import significant

from .finding import ALL_CLASSES, JUDGED, Finding, failures, judged

HEADINGS = ("case", "class", "metric", "value", "was", "allowed", "verdict", "")
NUMBERS = {3, 4}  # columns of HEADINGS


def number(value) -> str:
    return value[:12] if isinstance(value, str) else significant(value, 6)


def _allowed(f: Finding) -> str:
    if f.lower is None and f.upper is None:
        return "exact" if f.gate_class in ("I", "II") else "-"
    return f"at most {number(f.upper)}" if f.lower is None else f"{number(f.lower)} .. {number(f.upper)}"


def table(findings: list[Finding]) -> str:
    rows = [
        (f.case, f.gate_class, f.metric, number(f.value), number(f.reference), _allowed(f), f.verdict, f.note)
        for f in findings
    ]
    return "\n".join(aligned(HEADINGS, rows, NUMBERS))


def shown(findings: list[Finding], verbose: bool) -> list[Finding]:
    """Everything when asked for; else what is no plain pass, and times."""
    return findings if verbose else [f for f in findings if f.verdict != "pass"]


def closing(findings: list[Finding]) -> str:
    """One sentence: how much was judged, and how it came out."""
    count, red = judged(findings), len(failures(findings))
    classes = ", ".join(f"{count[c]} of class {c}" for c in ALL_CLASSES)
    words = Counter(f.verdict for f in findings)
    other = [
        f"{words[word]} {word}" for word in ("drift", "better", "xfail", "xpass", "not_judged") if words[word]
    ]
    return f"{sum(count.values())} judged ({classes}){', ' + ', '.join(other) if other else ''}: " + (
        f"RED, {red} failed" if red else "green"
    )


def verbose_argument(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--verbose", action="store_true", help="lines that pass as well")


def say(findings: list[Finding], verbose: bool) -> None:
    """Prints the table, where it has a line, and the closing sentence."""
    if lines := shown(findings, verbose):
        print(table(lines))
    print(closing(findings))


def write_json(path: Path, name: str, findings: list[Finding], **more) -> None:
    red = len(failures(findings))
    body = {
        "schema": {"name": name, "version": "1.0.0"},
        "green": not red,
        "judged": {c: judged(findings)[c] for c in ALL_CLASSES},
        "failed": red,
        "lines": len(findings),
        "verdicts": list(JUDGED) + ["report", "not_judged"],
        **more,
        "findings": [f.json() for f in findings],
    }
    write_whole(path, json.dumps(body, indent=1) + "\n")
