"""Class I: what must hold exactly, with no tolerance. Each check counts what it judged, and judging nothing
is a failure.
"""

import json
from dataclasses import dataclass

import jsonschema

from barrierbench_analysis.io import fields

from .finding import Finding, exact, not_judged
from .records import Run, leaves, not_finite

# Statuses that no clamped matrix may have.
NOT_A_SPECTRUM = ("not_pd", "singular", "not_converged", "non_finite")


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
        found, n = audit.get(name), audit.get("judged")
        judged = n if isinstance(n, int) else 0
        if not isinstance(found, int):  # absent, null, a word
            return Checked(judged, 1, f"audit/{name} is {json.dumps(found)}, no count")
        return Checked(judged, found)

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


AUDIT_COUNTS = ("crossings", "violations", "unproven")
CHECKS = {
    "schema": _schema,
    "outcome": _outcome,
    "numbers": _numbers,
    "audit": _audit,
    **{name: _audit_count(name) for name in AUDIT_COUNTS},
    "matrices": _matrices,
    "trace": _trace,
}
# What a record of another program cannot be blamed for when the section is not there at all.
SECTION_OF = {"matrices": "summary"} | dict.fromkeys(("audit", *AUDIT_COUNTS), "audit")


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
            findings.append(not_judged(case, "I", name, "the record has no such part"))
            continue
        result = check(run)
        note = result.note or ("judged nothing" if result.judged == 0 else f"of {result.judged}")
        findings.append(exact(case, "I", name, result.faults, result.judged, note))
    return findings


def torn(case: str, run: Run) -> list[Finding]:
    """A line where the last line of the trace was cut off."""
    note = f"{run.path.parent}: torn last line"
    line = Finding(case, "I", "trace lines dropped", "report", run.torn, 0, judged=0, note=note)
    return [line] if run.torn else []


def judge_stored(case: str, run: Run) -> list[Finding]:
    """Of a record that is there: a torn line of its trace is reported and no failure."""
    lines = judge(case, run, foreign=True)
    return torn(case, run) + [f for f in lines if not (f.metric == "trace" and run.torn)]
