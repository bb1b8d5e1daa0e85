"""Columns of the tables. They come from the schemas, which the program makes from its lists of record
fields."""

import json
from collections.abc import Iterator
from functools import cache

from . import input_file
from .places import SCHEMAS

OWN_NAMES = ("ids", "status", "labels", "summary")  # sections of a run whose fields need no prefix


@cache
def schema(name: str) -> dict:
    """configs/schema/NAME.schema.json."""
    return json.loads(input_file.read_text(SCHEMAS / f"{name}.schema.json"))


def _leaves(
    document: dict, record: dict, path: tuple[str, ...] = ()
) -> Iterator[tuple[tuple[str, ...], str]]:
    """Place and meaning of every field below `record` that holds one value; lists are tables of their own."""
    for name, field in record["properties"].items():
        below = document["$defs"][field["$ref"].rsplit("/", 1)[1]] if "$ref" in field else field
        if "properties" in below:
            yield from _leaves(document, below, (*path, name))
        elif (
            "description" in field
            and field.get("type") != "array"
            and (path or name not in ("config", "samples"))
        ):
            yield (*path, name), field["description"]


def _column(path: tuple[str, ...]) -> str:
    return "_".join(path[1:] if len(path) > 1 and path[0] in OWN_NAMES else path)


@cache
def columns(table: str) -> dict[str, tuple[tuple[str, ...], str]]:
    """Of a row of `runs`, `steps`, `trace` or `cond`: column -> place in the record, meaning. A field of a
    record inside the row is PLACE_FIELD (`contacts_total`, `gap_min_rel_median`), in `runs` without ids,
    status, labels and summary.
    """
    document = schema("run" if table in ("runs", "steps") else "trace")
    record = {
        "runs": document,
        "steps": document["$defs"].get("StepRecord"),
        "trace": document,
        "cond": document["$defs"].get("ConditionSample"),
    }[table]
    found = {}
    for path, doc in _leaves(document, record):
        if _column(path) in found:
            raise ValueError(
                f"{table}: {'/'.join(path)} and {'/'.join(found[_column(path)][0])} are both {_column(path)}"
            )
        found[_column(path)] = path, doc
    return found


def row(table: str, record: dict) -> dict:
    """The columns of a record, step, trace line or condition sample; None where it has no value."""
    out = {}
    for column, (path, _) in columns(table).items():
        value = record
        for name in path:
            value = value.get(name) if isinstance(value, dict) else None
        out[column] = value
    return out
