"""Class I: what must hold exactly, with no tolerance. Each check counts what it judged, and judging nothing
is a failure.
"""

from __future__ import annotations

import json
from dataclasses import dataclass

import jsonschema

from barrierbench_analysis.io import fields

from .finding import Finding
from .records import Run, leaves, not_finite

NOT_A_SPECTRUM = (
    "not_pd",
    "singular",
    "not_converged",
    "non_finite",
)  # statuses that no clamped matrix may have


@dataclass(frozen=True)
class Checked:
    judged: int
    faults: int
    note: str = ""


def _outcome(run: Run) -> Checked:
    status, checks = run.section("status"), run.section("validity").get("checks") or []
    failed = [c.get("name", "?") for c in checks if not c.get("pass")]
    bad = status.get("outcome") != "ok"
    note = f"{status.get('outcome')}: {status.get('detail', '')}" if bad else ", ".join(failed)
    return Checked(
        len(checks) + ("outcome" in status), len(failed) + bad + (status.get("valid", True) is not True), note
    )


def _audit(run: Run) -> Checked:
    """That it ran, and had primitives to compare in states as well as in motions."""
    audit = run.section("audit")
    if not audit.get("enabled"):
        return Checked(0, 1, "the audit did not run")
    idle = [name for name in ("states", "motions") if not audit.get(name)]
    return Checked(
        int(audit.get("judged") or 0), len(idle), f"no {' and no '.join(idle)} judged" if idle else ""
    )


def _audit_count(name: str):
    def check(run: Run) -> Checked:
        audit = run.section("audit")
        judged, found = audit.get("judged"), audit.get(name)
        if not isinstance(found, int):  # absent, null, a word
            return Checked(
                judged if isinstance(judged, int) else 0, 1, f"audit/{name} is {json.dumps(found)}, no count"
            )
        return Checked(judged if isinstance(judged, int) else 0, found)

    return check


def _numbers(run: Run) -> Checked:
    subjects = [*leaves(run.record, "run"), *leaves(run.trace, "trace")]
    count = sum(isinstance(value, (int, float)) and not isinstance(value, bool) for _, value in subjects)
    bad = [*not_finite(run.record), *(f"trace{line}" for line in not_finite(run.trace))]
    return Checked(count, len(bad), bad[0] if bad else "")


def _matrices(run: Run) -> Checked:
    """Of clamped matrices, which are positive definite by construction. Solved ones may fail: Newton then
    raises its level.
    """
    statuses: dict[str, int] = {}
    for matrix, conditioning in (run.section("summary").get("cond") or {}).items():
        if not matrix.startswith("solved/"):
            for status, count in (conditioning.get("statuses") or {}).items():
                statuses[status] = statuses.get(status, 0) + count
    bad = {s: n for s, n in statuses.items() if s in NOT_A_SPECTRUM and n}
    return Checked(sum(statuses.values()), sum(bad.values()), ", ".join(f"{n} {s}" for s, n in bad.items()))


def _trace(run: Run) -> Checked:
    """One line an iteration, none torn."""
    expected = run.section("summary").get("newton_iterations")
    missing = abs(int(expected or 0) - len(run.trace))
    note = f"{run.torn} torn, {len(run.trace)} lines for {expected} iterations" if missing or run.torn else ""
    return Checked(len(run.trace), missing + run.torn, note)


def _schema(run: Run) -> Checked:
    validator = jsonschema.Draft202012Validator(fields.schema("run"))
    errors = [
        f"/{'/'.join(map(str, e.absolute_path))}: {e.message}"[:200]
        for e in validator.iter_errors(run.record)
    ]
    return Checked(len(run.record), len(errors), errors[0] if errors else "")


CHECKS = {
    "schema": _schema,
    "outcome": _outcome,
    "numbers": _numbers,
    "audit": _audit,
    "crossings": _audit_count("crossings"),
    "violations": _audit_count("violations"),
    "unproven": _audit_count("unproven"),
    "matrices": _matrices,
    "trace": _trace,
}
# What a record of another program cannot be blamed for when the section is not there at all.
SECTION_OF = {
    "audit": "audit",
    "crossings": "audit",
    "violations": "audit",
    "unproven": "audit",
    "matrices": "summary",
}


def judge(case: str, run: Run, foreign: bool = False) -> list[Finding]:
    """A line a check. foreign: a record that our program may not have written; sections that it lacks judge
    nothing and say so.
    """
    findings = []
    for name, check in CHECKS.items():
        absent = foreign and (
            (name in SECTION_OF and SECTION_OF[name] not in run.record)
            or (name == "trace" and not run.has_trace)
            or (name == "schema")
            or (name == "matrices" and not run.section("summary").get("cond"))
            or (SECTION_OF.get(name) == "audit" and not run.section("audit").get("enabled"))
        )
        if absent:
            findings.append(
                Finding(case, "I", name, "not_judged", judged=0, note="the record has no such part")
            )
            continue
        result = check(run)
        note = result.note or ("judged nothing" if result.judged == 0 else f"of {result.judged}")
        findings.append(
            Finding(
                case,
                "I",
                name,
                "pass" if result.faults == 0 and result.judged > 0 else "FAIL",
                value=result.faults,
                reference=0,
                unit="1",
                judged=result.judged,
                note=note,
            )
        )
    return findings
