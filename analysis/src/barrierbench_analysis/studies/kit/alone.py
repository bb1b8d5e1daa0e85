"""One run as a sweep of its own with a limit of processor time: a hang, a crash or a refusal is how that run
ends, and touches no other.
"""

import math
import os
import re
import signal
import subprocess
from collections.abc import Sequence
from datetime import datetime, timezone
from pathlib import Path

from barrierbench_analysis.io.errors import BAD_INPUT, TRY_AGAIN, UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.record_file import RecordError, read_record
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.start import run_sweep

from .metrics import FOLDER
from .runs import Sweep

TIMEOUT, REFUSED, CRASH = "timeout", "refused", "crash"  # outcomes of a run that left no record
CLOCK = 4  # times the limit on the clock, so that a busy machine makes no timeouts
DETAIL = 400  # characters of a message that are kept
LIMITED = (
    'ulimit -c 0; ulimit -St {soft}; ulimit -Ht {hard}; exec "$@"'  # SIGXCPU ends it, without a core file
)


def without_record(outcome: str, detail: str, begun: datetime, valid: bool = False) -> dict:
    """In place of the record of a run: how it ended, why, and when; it has no steps and no numbers."""
    times = (begun, datetime.now(timezone.utc))
    started, ended = (time.isoformat(timespec="milliseconds").replace("+00:00", "Z") for time in times)
    return {
        "status": {
            "outcome": outcome,
            "valid": valid,
            "detail": detail,
            "started_utc": started,
            "ended_utc": ended,
        },
        "ids": {"run_id": "", "build_id": ""},
        "machine": {"cpu_model": "unknown", "cores": os.cpu_count()},
        "provenance": {},
        "schema": {"version": ""},
        "scene": {"free_dofs": 0},
        "summary": {},
        "steps": [],
    }


def run(made: Sweep, folder: Path, limit_s: float, plugins: Sequence[str] = ()) -> dict:
    """The record of the one case of a sweep, or `without_record`. A record that is there is not made again.
    Errors: UserError for what is a fault of the machine and no result.
    """
    spec, begun = folder / "spec.json", datetime.now(timezone.utc)
    write_whole(spec, made.text)
    soft = math.ceil(limit_s)
    under = ["bash", "-c", LIMITED.format(soft=soft, hard=soft + 1), "bash"]
    try:
        done = run_sweep(
            spec,
            folder / "runs",
            "--progress",
            "none",
            plugins=list(plugins),
            under=under,
            timeout=CLOCK * limit_s,
        )
    except subprocess.TimeoutExpired:
        return without_record(TIMEOUT, f"not over after {CLOCK * limit_s:.0f} s", begun)
    message = _message(done.stderr)
    if done.returncode == -signal.SIGXCPU:
        return without_record(TIMEOUT, f"not over after {soft} s of processor time", begun)
    if done.returncode == BAD_INPUT:
        return without_record(REFUSED, message, begun)
    if done.returncode == TRY_AGAIN:
        raise UserError(f"{folder}: {message}", TRY_AGAIN)
    if done.returncode != 0:
        return without_record(CRASH, f"the program ended with {done.returncode}: {message}", begun)
    file = _record(spec, folder / "runs", plugins)
    try:
        return {**read_record(file), FOLDER: str(file.parent)}
    except RecordError as fault:
        return without_record(CRASH, str(fault), begun)


def _record(spec: Path, folder: Path, plugins: Sequence[str]) -> Path:
    """The record of this very config; those that an earlier program made of it may lie beside it."""
    made = sorted(folder.glob("*/run.json"))
    if len(made) == 1:
        return made[0]
    named = run_sweep(spec, folder, "--dry-run", plugins=list(plugins)).stdout.strip()
    return Path(named or folder) / "run.json"


def _message(text: str) -> str:
    """Of the program, without the place of the generated sweep."""
    lines = [
        re.sub(r"\S*spec\.json\S*( \[[^]]*\])? ?", "", line).strip()
        for line in text.splitlines()
        if line.strip()
    ]
    return "; ".join(lines).replace(f"{ROOT}/", "")[:DETAIL]
