"""The list of cases that a sweep keeps in its folder (cases.json), and what each of them is doing."""

import json
import os
import re
import socket
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from . import input_file
from .errors import UserError
from .input_file import below
from .json_file import read_of_schema

SCHEMA = "barrierbench.cases/1"
DEAD_AFTER_S = 60  # dead_after_s of core/base/record/folder_lock.hpp
HOLDER = re.compile(r"process (\d+) on (.*) since (\S+)", re.S)

OVER, RUNNING, DEAD, STOPPED, WAITING = "over", "running", "dead", "stopped", "waiting"
# Files from which a cut run goes on; the first one alone is enough (experiments/run/checkpoint.hpp).
CHECKPOINT = ("checkpoint.bin", "checkpoint.next.bin", "checkpoint.log")
UNREADABLE = "unreadable"  # its record is: the run is made again
STATES = (OVER, RUNNING, DEAD, STOPPED, UNREADABLE, WAITING)


@dataclass(frozen=True)
class Case:
    """One run of a sweep. swept: pointer -> value; `repetition` of a repeated sweep."""

    index: int
    folder: Path
    label: str
    config_id: str
    swept: dict

    @property
    def record(self) -> Path:
        return self.folder / "run.json"


@dataclass(frozen=True)
class Sighting:
    """What a case is doing. detail: who is at it, or what is left of it."""

    state: str
    detail: str = ""


def has_list(folder: Path) -> bool:
    return (folder / "cases.json").is_file()


def split_records(root: Path, lists: dict[Path, list[Case]]) -> tuple[list[Path], list[Path]]:
    """The records below a folder: those of a case or of no sweep, and those that an earlier form of a sweep
    file has left in the sweep's folder. They are in the order of their paths, the cases of a sweep in that of
    its file. lists: folder of a sweep -> its cases.
    """
    place = {case.record: (folder, case.index) for folder, cases in lists.items() for case in cases}
    kept, earlier = [], []
    for path in below(root, "run.json"):
        (kept if path in place or path.parent.parent not in lists else earlier).append(path)
    return sorted(kept, key=lambda path: place.get(path, (path, 0))), earlier


def records_below(root: Path) -> list[Path]:
    """The first of split_records; a line on stderr names each of the others. Errors: UserError for a list of
    cases that is none.
    """
    lists = {path.parent: read_cases(path.parent) for path in below(root, "cases.json")}
    kept, earlier = split_records(root, lists)
    for path in earlier:
        print(f"{path.parent}: no case of its sweep as it is now; left out", file=sys.stderr)
    return kept


def read_cases(folder: Path) -> list[Case]:
    """In the order of the sweep file. Errors: UserError without the list, with what makes it."""
    if not folder.is_dir():
        raise UserError(f"{folder}: no such folder; the folder of a sweep is needed")
    data = read_of_schema(
        folder / "cases.json",
        SCHEMA,
        f"; ./bench plan SPEC --out {folder} --write lists the cases there, and so does ./bench sweep",
    )
    return [
        Case(
            k,
            folder / one["folder"],
            one["label"],
            one["config_id"],
            {pointer: json.loads(text) for pointer, text in one["swept"].items()},
        )
        for k, one in enumerate(data["cases"])
    ]


def _lives(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        pass
    return True


def _holder(lock: Path) -> Sighting | None:
    """Who has the lock of a folder, or had it when it died; None without a lock."""
    try:
        text, age = input_file.read_text(lock), time.time() - lock.stat().st_mtime
    except (UserError, OSError):
        return None
    known = HOLDER.fullmatch(text)
    here = known and known[2] == socket.gethostname()
    dead = age > DEAD_AFTER_S or (here and not _lives(int(known[1])))
    return Sighting(DEAD if dead else RUNNING, f"{text or 'another process'}, sign of life {age:.0f} s ago")


def sighted(case: Case) -> Sighting:
    """A run is dead when its process is gone, or has given no sign of life for DEAD_AFTER_S seconds; stopped
    when it has left a checkpoint: ./bench sweep goes on with both. Its record is not opened: status.py shows
    one that cannot be read from one that can.
    """
    holder = _holder(case.folder / "bench.lock")
    if holder and holder.state == RUNNING:
        return holder
    if case.record.is_file():
        return Sighting(OVER)
    if holder:
        return holder
    kept = case.folder / CHECKPOINT[0]
    return Sighting(STOPPED, f"goes on from {kept.name}") if kept.is_file() else Sighting(WAITING)
