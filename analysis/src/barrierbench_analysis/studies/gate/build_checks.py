"""Class I of the program itself: its validity block (`barrierbench validity`), one line a check."""

import json

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.start import built_program, started

from .finding import Finding, exact

CASE = "build"


def findings_of(report: dict) -> list[Finding]:
    """A line for every check of a report; none that judged nothing passes."""
    found = []
    for check in report["checks"]:
        n = check["subjects"]
        line = exact(CASE, "I", check["name"], not check["pass"], n, check["detail"] or f"of {n}", "")
        line.value, line.reference = check["value"], check["bound"]
        found.append(line)
    return found


def judge_build() -> list[Finding]:
    """Raises UserError when the program has no report."""
    done = started("validity", "--json")
    try:
        found = findings_of(json.loads(done.stdout))
    except (ValueError, KeyError, TypeError) as error:
        raise UserError(f"{built_program()} validity: no report ({error}): {done.stderr.strip()}") from None
    return found or [Finding(CASE, "I", "validity", "FAIL", judged=0, note="the report has no check")]
