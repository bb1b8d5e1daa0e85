"""Class II: runs that must end in the same bits. Hashes are compared between runs of one build on one
machine, and kept in no baseline.
"""

from .finding import Finding, exact, not_judged
from .measure import measure
from .records import Run


def _equal(
    case: str, gate_class: str, metric: str, a: str, b: str, note: str = "", absent: str = ""
) -> Finding:
    """Two hashes; `absent` is the note where one of them is empty, which judges nothing and fails."""
    known = bool(a) and bool(b)
    same = known and a == b
    note = note if known else absent
    return Finding(
        case, gate_class, metric, "pass" if same else "FAIL", b, a, judged=2 if known else 0, note=note
    )


def _state(case: str, a: Run, b: Run, threads: str) -> Finding:
    return _equal(case, "II", "state_hash", a.state_hash, b.state_hash, threads, "a record has no state hash")


def same_state(case: str, a: Run, b: Run, configs_differ: bool) -> list[Finding]:
    """Of two stored records: judged only where everything that decides the last bit is the same."""
    reason = "the configs differ" if configs_differ else ""
    if not reason and a.section("config").get("seeds") != b.section("config").get("seeds"):
        reason = "other seeds"
    if not reason and (not a.made_by_same_build[0] or a.made_by_same_build != b.made_by_same_build):
        reason = "another build or machine"
    if reason:
        return [not_judged(case, "II", "state_hash", reason, value=b.state_hash, reference=a.state_hash)]
    return [_state(case, a, b, f"{a.threads} and {b.threads} threads")]


def of_one_config(case: str, runs: list[Run]) -> list[Finding]:
    """Of runs that a gate made just now, one after the other, with 1 and 2 threads: state, config and every
    number but times.
    """

    def numbers_of(run: Run) -> dict[str, float]:
        return {m.name: v for m, v in measure(run).items() if m.gate_class != "V"}

    first, findings = runs[0], []
    numbers = numbers_of(first)
    for run in runs[1:]:
        threads, other = f"{first.threads} and {run.threads} threads", numbers_of(run)
        ids = (r.section("ids").get("config_id", "") for r in (first, run))
        unlike = sorted(
            name for name in numbers.keys() | other.keys() if numbers.get(name) != other.get(name)
        )
        note = ", ".join(unlike) or f"{len(numbers)} equal, {threads}"
        findings += [
            _state(case, first, run, threads),
            _equal(case, "I", "config_id", *ids),
            exact(case, "II", "numbers", len(unlike), len(numbers), note, ""),
        ]
    return findings
