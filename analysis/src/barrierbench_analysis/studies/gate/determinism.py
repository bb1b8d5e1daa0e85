"""Class II: runs that must end in the same bits. Hashes are compared between runs of one build on one
machine, and kept in no baseline.
"""

from __future__ import annotations

from .finding import Finding
from .measure import measure
from .records import Run


def _hash_finding(case: str, metric: str, a: Run, b: Run, note: str) -> Finding:
    known = bool(a.state_hash) and bool(b.state_hash)
    same = known and a.state_hash == b.state_hash
    return Finding(
        case,
        "II",
        metric,
        "pass" if same else "FAIL",
        b.state_hash,
        a.state_hash,
        judged=2 if known else 0,
        note=note if known else "a record has no state hash",
    )


def same_state(case: str, a: Run, b: Run, configs_differ: bool) -> list[Finding]:
    """Of two stored records: judged only where everything that decides the last bit is the same."""
    reason = "the configs differ" if configs_differ else ""
    if not reason and a.section("config").get("seeds") != b.section("config").get("seeds"):
        reason = "other seeds"
    if not reason and (not a.made_by_same_build[0] or a.made_by_same_build != b.made_by_same_build):
        reason = "another build or machine"
    if reason:
        return [
            Finding(case, "II", "state_hash", "not_judged", b.state_hash, a.state_hash, judged=0, note=reason)
        ]
    return [_hash_finding(case, "state_hash", a, b, f"{a.threads} and {b.threads} threads")]


def of_one_config(case: str, runs: list[Run]) -> list[Finding]:
    """Of runs that a gate made just now, one after the other, with 1 and 2 threads: state, config and every
    number but times.
    """
    first, findings = runs[0], []
    numbers = {m.name: v for m, v in measure(first).items() if m.gate_class != "V"}
    for run in runs[1:]:
        threads = f"{first.threads} and {run.threads} threads"
        findings.append(_hash_finding(case, "state_hash", first, run, threads))
        ids = [r.section("ids").get("config_id", "") for r in (first, run)]
        findings.append(
            Finding(
                case,
                "I",
                "config_id",
                "pass" if ids[0] and ids[0] == ids[1] else "FAIL",
                ids[1],
                ids[0],
                judged=2 if all(ids) else 0,
            )
        )
        other = {m.name: v for m, v in measure(run).items() if m.gate_class != "V"}
        unlike = sorted(
            name for name in numbers.keys() | other.keys() if numbers.get(name) != other.get(name)
        )
        findings.append(
            Finding(
                case,
                "II",
                "numbers",
                "FAIL" if unlike or not numbers else "pass",
                len(unlike),
                0,
                judged=len(numbers),
                note=", ".join(unlike) or f"{len(numbers)} equal, {threads}",
            )
        )
    return findings
