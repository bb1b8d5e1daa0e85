"""JSON from files, and tables in them: columns once, one line a row."""

import json
import math
from collections.abc import Iterable
from pathlib import Path

from . import input_file
from .errors import UserError


def is_number(value) -> bool:
    """A finite number: no truth value, NaN or infinity."""
    if isinstance(value, int):
        return not isinstance(value, bool)
    return isinstance(value, float) and math.isfinite(value)


def number_at(data, place: Iterable[str]) -> int | float | None:
    """The number at a place of an object; None where there is none."""
    for name in place:
        data = data.get(name) if isinstance(data, dict) else None
    return data if is_number(data) else None


class RepeatedKey(ValueError):
    """A key that one object has twice: which value was meant?"""


def _each_key_once(pairs: list[tuple[str, object]]) -> dict:
    made = dict(pairs)
    if len(made) < len(pairs):
        keys = [key for key, _ in pairs]
        raise RepeatedKey(next(key for key in keys if keys.count(key) > 1))
    return made


def read_json(path: Path, remedy: str = "") -> object:
    """What a file holds. remedy: the end of the message about an unreadable file. Errors: UserError, also
    for a key that is given twice in one object.
    """
    text = input_file.read_bytes(path, more=remedy)
    try:
        return json.loads(text, object_pairs_hook=_each_key_once)
    except RepeatedKey as key:
        raise UserError(
            f"{path}: the key {str(key)!r} is given twice in one object; each once{remedy}"
        ) from None
    except (ValueError, RecursionError) as fault:
        raise UserError(f"{path}: not JSON: {fault}{remedy}") from None


def read_object(path: Path, remedy: str = "") -> dict:
    """A JSON object from a file. Errors: UserError, which says what the file is instead."""
    data = read_json(path, remedy)
    if not isinstance(data, dict):
        raise UserError(f"{path}: not a JSON object{remedy}")
    return data


def read_of_schema(path: Path, schema: str, remedy: str = "") -> dict:
    """A JSON object whose `schema` is this one. Errors: UserError."""
    data = read_object(path, remedy)
    if data.get("schema") != schema:
        raise UserError(f"{path}#/schema: found {data.get('schema')!r}; {schema!r} is needed{remedy}")
    return data
