"""Where kept numbers come from: day, machine and program of their records."""

from __future__ import annotations

from datetime import datetime

ID_DIGITS = 16  # of run_id and build_id, in tables


def machine_of(record: dict) -> str:
    machine = record["machine"]
    return f"{machine['cpu_model']}, {machine['cores']} cores, 1 thread a run"


def origin(records: list[dict]) -> dict[str, str]:
    """date, machine, commit and build of all records, every value once."""
    found = {
        "date": {r["status"]["started_utc"][:10] for r in records},
        "machine": set(map(machine_of, records)),
        "commit": {r["provenance"].get("git_commit", "")[:10] for r in records},
        "build": {r["ids"]["build_id"][:ID_DIGITS] for r in records},
    }
    return {name: ", ".join(sorted(values)) for name, values in found.items()}


def seconds_of_run(record: dict) -> float:
    """From start to end of a run, all passes."""
    start, end = (
        datetime.fromisoformat(record["status"][key].replace("Z", "+00:00"))
        for key in ("started_utc", "ended_utc")
    )
    return (end - start).total_seconds()
