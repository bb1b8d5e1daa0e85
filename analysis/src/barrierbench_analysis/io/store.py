"""Stores of results, results/*.json: how they are read, how rows are laid out, and how rows are added to
those that are there. They are written whole (whole_file.py), and read by their schema.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TypeVar

from .errors import UserError
from .json_file import read_of_schema

T = TypeVar("T")


def read_store(path: Path, schema: str, of: Callable[[dict], T], remedy: str, empty: T | None = None) -> T:
    """What `of` makes of a store. empty: the answer where there is no file; without it a file is needed.
    Errors: UserError for another schema, for what `of` refuses, and where it misses a part.
    """
    if empty is not None and not path.is_file():
        return empty
    data = read_of_schema(path, schema, remedy)
    try:
        return of(data)
    except UserError:
        raise
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        raise UserError(f"{path}: not a whole table ({type(error).__name__}: {error}){remedy}") from None


def check_digest(path: Path, key: str, found: str | None, needed: str, what: str, again: str) -> None:
    """Errors: UserError where the numbers of a store are of another `what` than is requested now, by its
    digest at a key of the store. again: the command that makes them.
    """
    if found != needed:
        raise UserError(
            f"{path}#/{key}: found {found!r}; {needed!r} is needed: its numbers are of another {what};"
            f" {again} makes them"
        )


def a_line_each(texts: Iterable[str], indent: int, ends: Sequence[str] = "[]") -> str:
    """A JSON list, or an object with the ends {}, of texts that are JSON already, each on its own line."""
    pad = "\n" + " " * indent
    return f"{ends[0]}{pad}{f',{pad}'.join(texts)}{ends[1]}"


def in_columns(rows: Iterable[dict], columns: Sequence[str]) -> list[str]:
    """The rows as JSON arrays in the order of the columns. Errors: ValueError for NaN or infinity."""
    return [
        json.dumps([row[column] for column in columns], separators=(",", ":"), allow_nan=False)
        for row in rows
    ]


def merged(kept: list[dict], new: list[dict], key: Sequence[str], replace: bool = False) -> list[dict]:
    """The kept rows and the new ones, one a key, the kept ones first and in their places. A new row that is
    equal to a kept one changes nothing; no row but that of its key is changed by another. replace: new rows
    take the places of kept ones that have other numbers. Errors: UserError for such a row without `replace`,
    with its key and what differs.
    """
    found = {tuple(row[name] for name in key): row for row in kept}
    for row in new:
        place = tuple(row[name] for name in key)
        before = found.get(place, row)
        if before != row and not replace:
            differ = [name for name in {**before, **row} if before.get(name) != row.get(name)]
            raise UserError(
                f"{', '.join(map(str, place))}: found a row with another {', '.join(differ)} than the kept"
                " one; allowed: an equal row, or a row that replaces it"
            )
        found[place] = row
    return list(found.values())
