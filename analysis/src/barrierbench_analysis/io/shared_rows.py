"""Kept rows, *.jsonl: one JSON value a line. The first line is the schema; an object says what the rows below
it share, and an array is a row.
"""

import json
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TypeVar

from . import input_file
from .errors import UserError
from .whole_file import write_whole

T = TypeVar("T")


def _first(schema: str) -> str:
    return json.dumps({"schema": schema})


def read_shared(
    path: Path,
    schema: str,
    names: Iterable[str],
    row_of: Callable[[list, dict], T],
    needed: str,
    remedy: str = "",
) -> Iterator[tuple[str, T]]:
    """Of every row its place in the file, and row_of(array, what it shares: these names). Errors: UserError
    with the line of another schema, and of what is no row (`needed`), and the remedy.
    """
    first, *lines = input_file.read_text(path).splitlines() or [""]
    if first != _first(schema):
        raise UserError(f"{path}: line 1: found {first[:60]!r}; allowed: {_first(schema)}{remedy}")
    shared: dict = {}
    for number, line in enumerate(lines, 2):
        try:
            data = json.loads(line)
            if isinstance(data, dict):
                shared = {name: data[name] for name in names}
                continue
            row = row_of(data, shared)
        except (ValueError, TypeError, KeyError) as fault:
            raise UserError(f"{path}: line {number}: {fault}; allowed: {needed}{remedy}") from None
        yield f"{path}: line {number}", row


def write_shared(path: Path, schema: str, rows: Iterable[tuple[dict, list]]) -> None:
    """Writes the rows, each with what it shares with its neighbours. Errors: UserError where the disk is
    full, and then the file is as it was; ValueError for a number that is not finite.
    """
    lines, before = [_first(schema)], None
    for shared, row in rows:
        if shared != before:
            before = shared
            lines.append(json.dumps(shared))
        lines.append(json.dumps(row, separators=(",", ":"), allow_nan=False))
    write_whole(path, "\n".join(lines) + "\n")
