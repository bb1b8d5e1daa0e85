"""A folder of records held against its files: what is missing, what is there that nothing names, and what was
edited after the program wrote it.
"""

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from barrierbench_analysis.io import fields
from barrierbench_analysis.io.cases import CHECKPOINT, read_cases
from barrierbench_analysis.io.digests import of_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.input_file import below
from barrierbench_analysis.io.record_file import RecordError, read_record, read_trace, sha256_of
from barrierbench_analysis.tables.archive import LOCK, MANIFEST

from . import ids
from .found import CUT, contradictions
from .named import artifacts, inputs, leads_out, unlike_config

MISSING, EXTRA, EDITED = "missing", "extra", "edited"


@dataclass
class Held:
    """What was judged, and what is wrong: (missing, extra or edited, file, what was found)."""

    of_archive: bool = False  # the folder is an unpacked archive, which no file outside belongs to
    records: int = 0
    files: int = 0  # that records name
    ids: int = 0
    sums: int = 0  # numbers of summaries that follow from the steps
    cases: int = 0  # of sweeps
    listed: int = 0  # files of an archive that a folder is held against
    wrong: list[tuple[str, str, str]] = field(default_factory=list)
    outside: dict[Path, list[str]] = field(default_factory=dict)  # record -> inputs that an archive has not
    good: list[Path] = field(default_factory=list)  # records with nothing wrong and with all their inputs

    @property
    def judged(self) -> int:
        return self.records + self.cases + self.listed

    def add(self, kind: str, path: Path, root: Path, found: str) -> None:
        self.wrong.append((kind, str(path.relative_to(root)), found.replace(f"{root}/", "")))


def _of_steps() -> dict[str, Callable]:
    """Fields of the summary that follow from those of the steps with the same name, by the schema: counts are
    sums, and what is the largest of the steps is that.
    """
    defs = fields.schema("run")["$defs"]
    of_step, of_run = (defs[name]["properties"] for name in ("StepRecord", "Summary"))
    shared = {name: shape for name, shape in of_run.items() if name in of_step}
    sums = {name: sum for name, shape in shared.items() if shape.get("type") == "integer"}
    largest = {
        name: max for name, shape in shared.items() if "largest of the steps" in shape.get("description", "")
    }
    return sums | largest


def _check_sums(record: dict, path: Path, root: Path, held: Held) -> None:
    summary, steps = record["summary"], record["steps"]
    if (count := summary.get("steps", len(steps))) != len(steps):
        held.add(EDITED, path, root, f"summary/steps is {count}, and there are {len(steps)} steps")
        return
    for name, follows in _of_steps().items():
        values = [value for step in steps if (value := step.get(name)) is not None]
        is_known = bool(values) or (not steps and follows is sum)  # the sum of no steps is 0
        if not is_known or name not in summary:
            continue
        held.sums += 1
        if follows(values) != summary[name]:
            why = f"summary/{name} is {summary[name]}, the {follows.__name__} of its steps {follows(values)}"
            held.add(EDITED, path, root, why)


def _check_ids(record: dict, path: Path, root: Path, held: Held) -> None:
    for name, found in zip(("config_id", "run_id"), ids.of_record(path)):
        stated = record["ids"].get(name) or "empty"
        held.ids += 1
        if stated != found:
            why = f"ids/{name} is {stated[:16]}, that of its contents {found[:16]}"
            held.add(EDITED, path, root, why)


def _own_files(folder: Path) -> Iterator[Path]:
    """Files in the folder of a record and below it, but for folders of other records."""
    for place, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if not (Path(place) / name / "run.json").is_file())
        yield from (Path(place) / name for name in sorted(names))


def _check_files(record: dict, path: Path, root: Path, held: Held) -> None:
    named = inputs(record) | artifacts(record)
    for name, sha256 in named.items():
        if held.of_archive and leads_out(root, path.parent, name):
            held.outside.setdefault(path, []).append(name)
            continue
        held.files += 1
        file = path.parent / name
        if not file.is_file():
            held.add(MISSING, path, root, f"{name}, which it names, is not there")
        elif (found := sha256_of(file)) != sha256:
            held.add(EDITED, path, root, f"{name} has sha256 {found[:16]}; it names {sha256[:16]}")
    for name in unlike_config(record):
        held.add(EDITED, path, root, f"{name}: its sha256 in the config is not that of scene/mesh_sha256")
    known = {path, path.with_name(LOCK), *(path.parent / name for name in named)}
    if record["status"]["outcome"] in CUT:
        known |= {path.with_name(name) for name in CHECKPOINT}
    for file in _own_files(path.parent):
        if file not in known:
            held.add(EXTRA, file, root, "the record beside it does not name it")


def _check_record(path: Path, root: Path, held: Held) -> None:
    held.records += 1
    before = len(held.wrong)
    try:
        record = read_record(path)
    except RecordError as error:
        held.add(EDITED, path, root, str(error))
        return
    _check_files(record, path, root, held)
    _check_ids(record, path, root, held)
    _check_sums(record, path, root, held)
    for why in contradictions(record):
        held.add(EDITED, path, root, why)
    if len(held.wrong) == before:
        try:
            read_trace(record, path.parent)
        except RecordError as error:
            held.add(EDITED, path, root, str(error))
    if len(held.wrong) == before and path not in held.outside:
        held.good.append(path)


def _check_cases(folder: Path, root: Path, held: Held) -> None:
    """The records of a sweep against its list."""
    try:
        cases = read_cases(folder)
    except (UserError, KeyError, TypeError, ValueError) as error:
        held.add(EDITED, folder / "cases.json", root, str(error))
        return
    for case in cases:
        held.cases += 1
        if not case.record.is_file():
            held.add(MISSING, case.record, root, f"the record of the case {case.label}")
            continue
        try:
            own = read_record(case.record)["ids"]["config_id"]
        except RecordError:
            continue  # its own check reports it
        if own != case.config_id:
            why = f"its config_id is {own[:16]}, in cases.json {case.config_id[:16]}"
            held.add(EDITED, case.record, root, why)
    known = {case.record for case in cases}
    for record in sorted(folder.glob("*/run.json")):
        if record not in known:
            held.add(EXTRA, record, root, "no case of the sweep")


def held_folder(root: Path, of_archive: bool = False) -> Held:
    """Every record and every list of cases below a folder, which may be an unpacked archive. Errors:
    UserError where there is no folder.
    """
    if not root.is_dir():
        raise UserError(f"{root}: no such folder; the folder of a study, or an archive of one, is needed")
    held = Held(of_archive)
    for path in below(root, "run.json"):
        _check_record(path, root, held)
    for path in below(root, "cases.json"):
        _check_cases(path.parent, root, held)
    return held


def against(root: Path, lines: list[dict], held: Held) -> None:
    """All files of a folder against archive.json of an archive of it, byte for byte."""
    listed = {line["path"]: line["sha256"] for line in lines}
    there = {path.relative_to(root).as_posix() for path in root.rglob("*") if path.is_file()}
    for name in sorted(listed):
        held.listed += 1
        if name not in there:
            held.add(MISSING, root / name, root, "it is in the archive")
        elif (found := of_file(root / name)) != listed[name]:
            held.add(EDITED, root / name, root, f"sha256 {found[:16]}, in the archive {listed[name][:16]}")
    for name in sorted(there - listed.keys() - {MANIFEST}):
        if Path(name).name != LOCK:
            held.add(EXTRA, root / name, root, "it is not in the archive")
