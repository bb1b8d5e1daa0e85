"""What a report is made of: the records below a folder, what of them cannot be read, and the runs of its
sweeps that have no record.
"""

import os
from collections import Counter
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path

from barrierbench_analysis.io.cases import read_cases, sighted, split_records
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.input_file import below
from barrierbench_analysis.io.record_file import RecordError, leaves, named_files, read_record, read_trace
from barrierbench_analysis.program import processes
from barrierbench_analysis.tables import answer
from barrierbench_analysis.tables.run_rows import run_row
from barrierbench_analysis.tables.words import reservations

from . import expected

PARALLEL_FROM = 200  # records, from which on reading them is shared by the cores
SHOWN_FAULTS = 20  # of an error that names what cannot be read


@dataclass(frozen=True)
class Entry:
    """One record, without what a report does not show."""

    path: Path  # of run.json
    row: dict  # records.run_row; `run` is its folder below that of the report
    settings: dict  # JSON pointer -> value, of the resolved config
    failed_checks: tuple[str, ...]  # of `validity`
    frames: int  # that the record names
    argv: tuple[str, ...]  # of the program
    trace_fault: str = ""  # why its trace cannot be read; its figures over time lack it
    in_archive: bool = False  # `path` is where the archive was unpacked to, and is gone afterwards

    @property
    def run(self) -> str:
        return self.row["run"]

    @property
    def group(self) -> str:
        return self.row["group"]

    @property
    def name(self) -> str:
        return f"{self.group}: {self.row['series']}"

    @property
    def good(self) -> bool:
        """Whether it ended ok and every check of its validity passed."""
        return answer.is_good(self.row)

    @property
    def expected(self) -> expected.End | None:
        """How it is expected to fail; None where it is not."""
        return expected.end_of(self.row)

    @property
    def failed_as_expected(self) -> bool:
        """A surface that passed through another is never expected but where `penetration` is."""
        end = self.expected
        if self.good or end is None or (self.faults and "penetration" not in end.outcomes):
            return False
        return expected.word_of(self.row) in end.outcomes

    @property
    def reserved(self) -> list[str]:
        """Why a run that counts says less than others do; empty for one that does not count."""
        return reservations(self.row) if self.good else []

    def cond(self, matrix: str, statistic: str = "median") -> float | None:
        """A condition number of the clamped matrices; matrix: stage/scaling, as in the summary."""
        return answer.cond_of(self.row, matrix, statistic)

    @property
    def wall_s(self) -> float | None:
        """Of the pass `time`; a run that does not count shows no time."""
        return self.row.get("wall_s") if self.good else None

    @property
    def faults(self) -> int | None:
        """Crossings, motions through each other; None where nothing was judged."""
        if not self.row.get("audit_enabled") or not self.row.get("audit_judged"):
            return None
        return (self.row.get("audit_crossings") or 0) + (self.row.get("audit_violations") or 0)


@dataclass(frozen=True)
class Absent:
    """A run of a sweep without a record."""

    group: str
    label: str
    state: str  # as ./bench status says it
    detail: str


@dataclass
class Folder:
    """All that a report knows of a folder."""

    root: Path
    entries: list[Entry]
    unreadable: list[str] = field(default_factory=list)  # file: place, what was found, what is allowed
    absent: list[Absent] = field(default_factory=list)
    earlier: list[Path] = field(default_factory=list)  # records of no case of their sweep as it is now
    archive: Path | None = None  # that the folder was unpacked from

    @property
    def place(self) -> Path:
        """Where a reader finds it: the folder, or the archive."""
        return self.archive or self.root

    def told(self, fault: str) -> str:
        """A fault that names files, which are named as they are in the archive where there is one."""
        return fault.replace(f"{self.root}/", "") if self.archive else fault

    @cached_property
    def by_run(self) -> dict[str, Entry]:
        return {entry.run: entry for entry in self.entries}

    @cached_property
    def rows(self) -> dict[str, dict]:
        """Folder of a run below the root -> its row."""
        return {entry.run: entry.row for entry in self.entries}

    @property
    def lost(self) -> list[str]:
        """Every file that cannot be read: lists of cases, records, and traces of records that can."""
        return [*self.unreadable, *(entry.trace_fault for entry in self.entries if entry.trace_fault)]

    @cached_property
    def groups(self) -> dict[str, list[Entry]]:
        """Those with the largest share of comparable runs first, else in the order of the records."""
        found: dict[str, list[Entry]] = {}
        for entry in self.entries:
            found.setdefault(entry.group, []).append(entry)
        counts = Counter(row["group"] for row, _ in answer.compared(self.rows.values()))
        return dict(sorted(found.items(), key=lambda group: -counts[group[0]] / len(group[1])))

    def reference_of(self, entry: Entry) -> Entry | None:
        """The run that the record names as its reference, where that very run is in this folder."""
        found = answer.reference_of(entry.row, self.rows)
        return None if found is None else self.by_run[found["run"]]


def _trace_fault(record: dict, folder: Path) -> str:
    try:
        read_trace(record, folder)
    except RecordError as error:
        return str(error)
    return ""


def _entry(path: Path, found: Folder) -> Entry | str:
    """An entry, or why the record cannot be read."""
    try:
        record = read_record(path)
    except RecordError as error:
        return found.told(str(error))
    checks = (record.get("validity") or {}).get("checks") or []
    return Entry(
        path,
        run_row(record, str(path.parent.relative_to(found.root))),
        dict(leaves(record.get("config") or {})),
        tuple(check["name"] for check in checks if not check["pass"]),
        len(named_files(record, "frame")),
        tuple((record.get("provenance") or {}).get("argv") or ()),
        found.told(_trace_fault(record, path.parent)),
        found.archive is not None,
    )


def _lists(root: Path, found: Folder) -> list[Path]:
    """Records below the folder: those of its sweeps in the order of their cases, then those of no sweep. What
    sweeps lack, and what an earlier form of a sweep file has left there, goes to `found`.
    """
    paths, lists = [], {}
    for file in below(root, "cases.json"):
        try:
            lists[file.parent] = read_cases(file.parent)
        except (UserError, KeyError, TypeError, ValueError) as error:
            fault = str(error) if isinstance(error, UserError) else f"{file}: {error!r}"
            found.unreadable.append(found.told(fault))
            continue
        for case in lists[file.parent]:
            if case.record.is_file():
                paths.append(case.record)
            else:
                sighting = sighted(case)
                found.absent.append(Absent(file.parent.name, case.label, sighting.state, sighting.detail))
    kept, found.earlier = split_records(root, lists)
    return list(dict.fromkeys([*paths, *kept]))


def _half_written(root: Path) -> list[str]:
    return [
        f"{path}: a record that was not finished, without the run.json it would become; ./bench sweep, or the"
        " run again, goes on with it"
        for path in below(root, "run.json.part")
        if not path.with_name("run.json").exists()
    ]


def gathered(root: Path, archive: Path | None = None) -> Folder:
    """archive: that the folder was unpacked from. Errors: UserError: no folder, or no record in it that can
    be read; the faults are named.
    Cost: 3 to 15 ms a record and core, most of them for its trace.
    """
    if not root.is_dir():
        what = "a file" if root.exists() else "nothing there"
        raise UserError(f"{root}: found {what}; allowed: a folder with records (run.json) below it")
    found = Folder(root, [], archive=archive)
    paths = _lists(root, found)
    workers = len(os.sched_getaffinity(0))
    if len(paths) < PARALLEL_FROM or workers == 1:
        read = [_entry(path, found) for path in paths]
    else:
        with processes.pool(workers) as pool:
            one = partial(_entry, found=Folder(root, [], archive=archive))
            read = list(pool.map(one, paths, chunksize=32))
    found.entries = [one for one in read if isinstance(one, Entry)]
    found.unreadable += [one for one in read if isinstance(one, str)]
    found.unreadable += map(found.told, _half_written(root))
    if not found.entries:
        message = f"{found.place}: no record that can be read; allowed: a folder with run.json below it"
        raise UserError("\n".join([message, *found.unreadable[:SHOWN_FAULTS]]))
    return found
