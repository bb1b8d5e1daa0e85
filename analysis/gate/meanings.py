"""Fields that mean something else in a record of an earlier version: named, and compared with nothing."""

from __future__ import annotations

from ..record_file import other_meanings
from .finding import Finding
from .records import Run


def _has(run: Run, field: str) -> bool:
    """Whether the record (`trace ...`: its trace) has the field. A record of another program may lack it."""
    if field.startswith("trace "):
        return bool(run.trace)
    value = run.record
    for name in field.split("."):
        value = value.get(name) if isinstance(value, dict) else None
    return value is not None


def of_other_version(case: str, runs: list[Run], *versions: str) -> list[Finding]:
    """A line when these runs have fields that mean something else in the one version than in the other, by default this program's."""
    fields = [field for field in other_meanings(*versions) if any(_has(run, field) for run in runs)]
    if not fields:
        return []
    between = " and ".join(versions) if len(versions) > 1 else f"{versions[0]} and now"
    return [Finding(case, "I", "meanings", "not_judged", judged=0, note=f"of {between}, in which {', '.join(fields)} mean different things: not compared")]
