"""The text file beside every figure: what is shown, and what the records say of settings, machine and day."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable

SETTINGS = ("scene", "matching_rule", "step_solver", "integrator", "linear_solver", "d_hat_m", "dt_s")


def origin(record: dict) -> dict:
    """Where a record comes from: machine, kernel of the BLAS library, program, day. Empty text where it is not said."""
    provenance, machine = record.get("provenance", {}), record.get("machine", {})
    return {
        "cpu_model": machine.get("cpu_model") or "",
        "cores": machine.get("cores") or "",
        "threads": provenance.get("threads") or "",
        "blas": provenance.get("blas", {}).get("kernel") or provenance.get("libraries", {}).get("blas", "").split(" at ")[0],
        "git_commit": (provenance.get("git_commit") or "")[:10],
        "started_utc": record.get("status", {}).get("started_utc") or "",
    }


def settings(record: dict) -> dict:
    """The settings that a reader of a figure needs, with their units in the keys."""
    labels = record.get("labels", {})
    return {key: labels[key] for key in SETTINGS if labels.get(key) not in (None, "")}


def _distinct(values: Iterable) -> str:
    """Each value once, in order of appearance."""
    return ", ".join(dict.fromkeys(str(v) for v in values if str(v) != ""))


def caption(shown: str, rows: list[dict]) -> str:
    """Wrapped text. `shown`: what the figure shows, in sentences; `rows`: origin() and settings() of its runs, merged."""
    lines = [shown]
    if not rows:
        return textwrap.fill(shown, 100) + "\n"
    named = {key: _distinct(row[key] for row in rows if key in row) for key in SETTINGS}
    lines.append("Settings: " + "; ".join(f"{key} {value}" for key, value in named.items() if value) + ".")
    place = {key: _distinct(row.get(key, "") for row in rows) for key in ("cpu_model", "cores", "threads", "blas", "git_commit")}
    lines.append(
        f"Machine: {place['cpu_model'] or 'not recorded'}, {place['cores'] or '?'} cores, {place['threads'] or '?'} threads; "
        f"BLAS: {place['blas'] or 'not recorded'}; program: commit {place['git_commit'] or 'not recorded'}."
    )
    days = sorted({str(row.get("started_utc", ""))[:10] for row in rows} - {""})
    lines.append(f"Recorded: {' to '.join(dict.fromkeys((days[0], days[-1]))) if days else 'no date'} (UTC), {len(rows)} run{'s' if len(rows) != 1 else ''}.")
    return "\n\n".join(textwrap.fill(line, 100) for line in lines) + "\n"
