"""Class I of the program itself: its validity block (`barrierbench validity`), one line a check."""

from __future__ import annotations

import json

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.start import built_program, started

from .finding import Finding

CASE = "build"


def findings_of(report: dict) -> list[Finding]:
    """A line for every check of a report; none that judged nothing passes."""
    return [
        Finding(
            CASE,
            "I",
            check["name"],
            "pass" if check["pass"] and check["subjects"] > 0 else "FAIL",
            value=check["value"],
            reference=check["bound"],
            judged=check["subjects"],
            note=check["detail"] or f"of {check['subjects']}",
        )
        for check in report["checks"]
    ]


def judge_build() -> list[Finding]:
    """Raises UserError when the program has no report."""
    done = started("validity", "--json")
    try:
        found = findings_of(json.loads(done.stdout))
    except (ValueError, KeyError, TypeError) as error:
        raise UserError(f"{built_program()} validity: no report ({error}): {done.stderr.strip()}") from None
    return found or [Finding(CASE, "I", "validity", "FAIL", judged=0, note="the report has no check")]
