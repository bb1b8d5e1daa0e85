"""The one reader of what a run leaves: run.json, the trace and the frames beside it. Every verb in Python
reads records through it.

A record is read when it is JSON of this schema, holds finite numbers, and its fields have the types that the
schema says. The files beside it are read when they are those that the record names, byte for byte:
`artifacts` has the sha256 of each. Whatever else is refused with file, place, value and what is allowed.
"""

import json
import math
import os
import re
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

import orjson

from . import fields, input_file
from .digests import of_file
from .errors import UserError
from .record_rule import RecordRule, shown

VERSION = fields.schema("run")["$defs"]["SchemaId"]["properties"]
SCHEMA_NAME, SCHEMA_MAJOR = (
    VERSION["name"]["enum"][0],
    VERSION["version"]["pattern"].strip("^").split("\\.")[0],
)
OURS = tuple(int(part) for part in fields.schema("run")["$comment"].removeprefix("version ").split("."))
CHANGED = {
    **fields.schema("run")["x-changed-meaning"],
    **{f"trace {field}": change for field, change in fields.schema("trace")["x-changed-meaning"].items()},
}
TRACE = "trace.jsonl"
HASHED_TRACES = (3, 4)  # the first version whose records name their trace in `artifacts`
NEEDED = {
    "ids": ("run_id",),
    "status": ("outcome", "valid"),
    "labels": ("scene", "formulation"),
    "summary": (),
    "steps": (),
}


class RecordError(UserError):
    """A file that is not a record this version can read, or that does not belong to its record."""


def leaves(value, place: str = "") -> Iterator[tuple[str, object]]:
    """Every value below with its JSON pointer; an empty object or list is a value."""
    if isinstance(value, (dict, list)) and value:
        for key, below in value.items() if isinstance(value, dict) else enumerate(value):
            yield from leaves(below, f"{place}/{key}")
    else:
        yield place, value


def _parts(version: str) -> tuple[int, ...]:
    return tuple(int(part) for part in version.split("."))


def _version(record: dict) -> tuple[int, ...]:
    return _parts(record["schema"]["version"])


def other_meanings(version: str, other: str = ".".join(map(str, OURS))) -> dict[str, dict]:
    """Fields that mean something else in records of the one version than in those of the other, by default
    this reader's: place of the field (`trace ...` of a line of the trace) -> since which version it means
    what it does now, and what it meant before.
    """
    low, high = sorted((_parts(version), _parts(other)))
    return {field: change for field, change in CHANGED.items() if low < _parts(change["since"]) <= high}


def _check_schema(record: dict, path: Path) -> None:
    schema = record.get("schema")
    schema = schema if isinstance(schema, dict) else {}
    version = str(schema.get("version", ""))
    if schema.get("name") != SCHEMA_NAME or not re.fullmatch(rf"{SCHEMA_MAJOR}\.[0-9]+\.[0-9]+", version):
        raise RecordError(
            f"{path}#/schema: found {json.dumps(record.get('schema'))[:100]}; allowed:"
            f" {SCHEMA_NAME} {SCHEMA_MAJOR}.x.y"
        )


@cache
def _rule_of_a_record() -> RecordRule:
    return RecordRule(fields.schema("run"))


def _all_finite(value: dict | list) -> bool:
    """Whether every number below is finite; a loop a container, no call a number."""
    for below in value.values() if isinstance(value, dict) else value:
        kind = type(below)
        if kind is float:
            if not math.isfinite(below):
                return False
        elif (kind is dict or kind is list) and not _all_finite(below):
            return False
    return True


def _not_finite(value) -> tuple[str, object] | None:
    """The first number below that is not finite, with its place."""
    if _all_finite(value):
        return None
    return next(
        (place, found)
        for place, found in leaves(value)
        if isinstance(found, float) and not math.isfinite(found)
    )


def _needed_fault(record: dict) -> str:
    for section, names in NEEDED.items():
        for place in (section, *(f"{section}/{name}" for name in names)):
            value = record
            for name in place.split("/"):
                value = value.get(name) if isinstance(value, dict) else None
            if value is None:
                return f"/{place}: not there; allowed: a record as it was written"
    return ""


def _parsed(path: Path) -> tuple[object, bool]:
    """What a JSON file holds, and whether its numbers are known to be finite: orjson takes only JSON in
    which all are, in a third of the time; what it refuses, Python's own reader takes or says why not. An
    integer beyond 64 bits, which no record of ours has, is read as the nearest double.
    """
    if not os.path.lexists(path) and not path.parent.is_file():
        raise RecordError(f"{path}: not there; allowed: the run.json of a run that is over")
    try:
        text = input_file.read_bytes(path)
    except UserError as fault:
        raise RecordError(str(fault)) from None
    try:
        try:
            return orjson.loads(text), True
        except orjson.JSONDecodeError:
            return json.loads(text.decode()), False
    except (ValueError, RecursionError) as error:  # ValueError: not JSON, not UTF-8
        raise RecordError(f"{path}: not JSON: {error}") from None


def read_record(path: Path, foreign: bool = False, allow_not_finite: bool = False) -> dict:
    """One run.json. foreign: a record that another program may have written, whose sections may be missing.
    allow_not_finite: the caller judges numbers that are none. Raises RecordError with file and place: not
    there, torn or otherwise not JSON, no record, a version this one does not read, a number that is not
    finite, a field of another type or with an unknown word, a field that is missing.   Cost: of the size.
    """
    path = Path(path)
    try:
        return _judged(path, *_parsed(path), foreign, allow_not_finite)
    except RecursionError:
        raise RecordError(f"{path}: nested too deeply; allowed: a record as it was written") from None


def _judged(path: Path, record: object, finite: bool, foreign: bool, allow_not_finite: bool) -> dict:
    if not isinstance(record, dict):
        raise RecordError(f"{path}: not JSON of a record: found {shown(record)}; allowed: an object")
    _check_schema(record, path)
    if not finite and not allow_not_finite and (bad := _not_finite(record)):
        raise RecordError(
            f"{path}#{bad[0]}: found {bad[1]}; allowed: a finite number, or null with the word that says why"
        )
    version = _version(record)
    needed = "" if foreign else _needed_fault(record)
    complete, words = not foreign and version == OURS, not foreign and version <= OURS
    if fault := needed or _rule_of_a_record().fault(record, complete, words):
        raise RecordError(f"{path}#{fault}")
    return record


def sha256_of(path: Path) -> str:
    """Of the bytes of a file, in hexadecimal digits. Raises RecordError where it cannot be read."""
    try:
        return of_file(path)
    except UserError as error:
        raise RecordError(f"{error}, the one that its record names") from None


def named_files(record: dict, kind: str) -> list[str]:
    """Paths of the files of a kind (frame, frame_scene, matrix, matrix_side_car, pair_forces, trace) that the
    record names, relative to its folder.
    """
    return [file["path"] for file in record.get("artifacts") or [] if file["kind"] == kind]


def bound_file(record: dict, folder: Path, relative: str) -> Path:
    """The file beside the record, if it is the very one that the record names. Raises RecordError: not named,
    not there, another content. Cost: of the artifacts that the record names; bound_files for many.
    """
    return next(bound_files(record, folder, [relative]))


def bound_files(record: dict, folder: Path, relatives: Iterable[str]) -> Iterator[Path]:
    """bound_file of each, one after the other."""
    named = {file["path"]: file for file in record.get("artifacts") or []}
    for relative in relatives:
        yield _same_file(Path(folder) / relative, named.get(relative))


def _same_file(path: Path, known: dict | None) -> Path:
    if known is None:
        raise RecordError(f"{path}: the record beside it names no such file; allowed: one of its `artifacts`")
    if (found := sha256_of(path)) != known["sha256"]:
        raise RecordError(
            f"{path}: found sha256 {found[:16]}, {path.stat().st_size} bytes; allowed: sha256"
            f" {known['sha256'][:16]}, {known['bytes']} bytes, as the record beside it says"
        )
    return path


def trace_lines(path: Path) -> tuple[list[dict], int]:
    """The rows of a trace, whoever wrote it, and how many of its lines were torn by a crash: 0 or 1, since
    only the last one can be. Raises RecordError: a line before the last one that is no JSON object, a number
    that is none.
    """
    lines = input_file.read_text(path).splitlines()
    rows = []
    for number, line in enumerate(lines, 1):
        try:
            row = json.loads(line)
        except ValueError:
            row = None
        if isinstance(row, dict):
            rows.append(row)
        elif number < len(lines):
            raise RecordError(
                f"{path}:{number}: not a JSON object; only the last line of a trace may be torn"
            )
    return rows, len(lines) - len(rows)


def is_hashed(record: dict) -> bool:
    """Whether a record of this version says which trace is its own."""
    return _version(record)[:2] >= HASHED_TRACES


def own_trace(record: dict, folder: Path) -> Path | None:
    """The trace beside the record; None where the run wrote none. Raises RecordError when it is not the very
    one that the record names. A record before version 3.4 names none: of it any trace is the own.
    """
    path = Path(folder) / TRACE
    if not is_hashed(record):
        return path if path.exists() else None
    if TRACE in named_files(record, "trace"):
        return bound_file(record, folder, TRACE)
    if path.exists():
        raise RecordError(
            f"{path}: the record beside it names no trace; allowed: none, since its run wrote none"
        )
    return None


def read_trace(record: dict, folder: Path) -> list[dict]:
    """The rows of the trace beside the record, one a Newton iteration; none where the run wrote none. Raises
    RecordError when it is not the record's, is torn, has not one line an iteration, or a number that is not
    finite: a hash says whose file it is, not that it is whole.
    """
    path = own_trace(record, folder)
    if path is None:
        return []
    rows, torn = trace_lines(path)
    expected = record["summary"].get("newton_iterations")
    if torn or len(rows) != expected:
        raise RecordError(
            f"{path}: found {len(rows)} whole lines{' and a torn one' if torn else ''}; allowed: {expected},"
            " one for each Newton iteration of the record beside it"
        )
    for number, row in enumerate(rows, 1):
        bad = _not_finite(row)
        if bad:
            raise RecordError(
                f"{path}:{number}: {bad[0]} is not finite; allowed: a finite number, or null with the word"
                " that says why"
            )
    return rows
