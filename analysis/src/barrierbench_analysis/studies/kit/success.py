"""The success that methods with different ends of a step share: the simulated time that was asked for, a residual at every step end, a gap of at least
0.05 d_hat, a clean audit of the whole surface, and a record that counts. What falls short says in what."""

from __future__ import annotations

import math

LEAST_GAP = 0.05  # d_hat
ROUNDING = 1e-9


def _finite(value) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def time_asked(record: dict) -> float | None:
    """Simulated seconds that a run was asked for."""
    time = (record.get("config") or {}).get("time") or {}
    if _finite(time.get("duration_s")):
        return float(time["duration_s"])
    return float(time["dt_s"] * time["steps"]) if _finite(time.get("dt_s")) and _finite(time.get("steps")) else None


def _ends(record: dict) -> list[dict]:
    return [step for step in record.get("steps") or [] if step.get("status") == "converged"]


def short_of_time(record: dict) -> float | None:
    """1 when its last whole step ends before the time that was asked for."""
    asked = time_asked(record)
    return None if asked is None else float(max((step["t_s"] for step in _ends(record)), default=0.0) < asked * (1 - ROUNDING))


def without_residual(record: dict) -> float:
    """1 when some step end, or all for want of one, has no residual in tolerances."""
    ends = _ends(record)
    return float(not ends or any(not _finite(step.get("end_error_tolerances")) for step in ends))


def residual_max(record: dict) -> float | None:
    """Largest residual at a step end, in tolerances; None without any."""
    return max((float(step["end_error_tolerances"]) for step in _ends(record) if _finite(step.get("end_error_tolerances"))), default=None)


def close_gap(record: dict) -> float:
    """1 when a contact is closer than LEAST_GAP at a step end. No contact is beyond d_hat."""
    gaps = [step["gap_min_rel"] for step in _ends(record) if _finite(step.get("gap_min_rel"))]
    return float(min(gaps, default=math.inf) < LEAST_GAP)


def failed_audit(record: dict) -> float:
    """1 when the audit of the whole surface found anything, could not certify a motion, or judged nothing."""
    audit = record.get("audit") or {}
    found = any(audit.get(key, 0) for key in ("crossings", "violations", "unproven", "scene_faults"))
    return float(found or not audit.get("enabled") or not audit.get("judged"))


def not_valid(record: dict) -> float:
    """1 when a check of its validity failed."""
    return float(not record["status"]["valid"])


COMMON = "common"  # as `bad` of a part: none of the following
FAILURES = {"short_of_time": ("1 when the simulated time asked for was not reached", short_of_time),
            "without_residual": ("1 when a step end has no residual", without_residual),
            "close_gap": (f"1 when a gap at a step end is below {LEAST_GAP:g} d_hat", close_gap),
            "failed_audit": ("1 when the audit of the whole surface is not clean, or judged nothing", failed_audit),
            "not_valid": ("1 when a check of the run's validity failed", not_valid)}
COMMON_WORDS = f"reaches the simulated time with a residual at every step end, gaps of at least {LEAST_GAP:g} d_hat and a clean audit of the whole surface"
TIME, RESIDUAL = "time_asked", "residual_max"


def failures(bad: str | None) -> tuple[str, ...]:
    """The metrics that `bad` of a part, or of a frontier, means; each is 1 where a run failed."""
    if bad is None:
        return ()
    return tuple(FAILURES) if bad == COMMON else (bad,)


def read_for(bad: str | None) -> tuple[str, ...]:
    """All metrics that judging it reads."""
    return (*failures(bad), TIME, RESIDUAL) if bad == COMMON else failures(bad)
