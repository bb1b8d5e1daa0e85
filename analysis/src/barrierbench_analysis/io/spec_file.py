"""The one reader of specs: JSON files of what to run and to judge (studies, claims, gap maps, Pareto sweeps,
stress tests, sets of gates, the corpus of matrices, figures), held against their JSON Schema in
configs/schema/. What no schema can say, a reader checks after it.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from . import fields
from .errors import UserError
from .json_file import is_number, read_object

if TYPE_CHECKING:
    from jsonschema import Draft202012Validator
    from jsonschema.exceptions import ValidationError


def _is_integer(_, value) -> bool:
    """2.0 is none."""
    return isinstance(value, int) and not isinstance(value, bool)


@cache
def _validator(kind: str) -> Draft202012Validator:
    from jsonschema import (  # takes as long as all else that a verb begins with
        Draft202012Validator,
        validators,
    )

    types = Draft202012Validator.TYPE_CHECKER
    types = types.redefine("integer", _is_integer).redefine("number", lambda _, value: is_number(value))
    return validators.extend(Draft202012Validator, type_checker=types)(fields.schema(kind))


def _order(error: ValidationError) -> tuple:
    """Of what a reader hears first: another schema, a key that is missing, an unknown one, a value."""
    keywords = ("const", "required", "additionalProperties")
    rank = keywords.index(error.validator) if error.validator in keywords else len(keywords)
    return (len(error.absolute_path) > 1, rank, [str(part) for part in error.absolute_path])


def _words(error: ValidationError) -> str:
    """What is allowed at the place of an error: the `$comment` of its schema, or the rule itself."""
    if "$comment" in error.schema:
        return error.schema["$comment"]
    if error.validator == "const":
        return repr(error.validator_value)
    if error.validator == "enum":
        return f"one of {', '.join(map(str, error.validator_value))}"
    return f"{error.validator} {error.validator_value}"


def _fault(error: ValidationError, above: str) -> str:
    """Place, what was found there and what is allowed."""
    place = "/".join([above, *map(str, error.absolute_path)] if above else map(str, error.absolute_path))
    below = f"{place}/" if place else ""
    if error.validator == "required":
        missing = next(key for key in error.validator_value if key not in error.instance)
        return f"{below}{missing}: is missing"
    if error.validator == "additionalProperties":
        known = error.schema["properties"]
        unknown = next(key for key in error.instance if key not in known)
        return f"{below}{unknown}: unknown; allowed: {', '.join(known)}"
    found = error.instance
    return f"{place}: found {found!r}; {_words(error)} is needed"


def read_spec(path: Path, kind: str) -> dict:
    """A spec as its file has it. Errors: UserError with file and place: no JSON object, another schema, a key
    that is missing or unknown, a value of another type or out of its range.
    """
    return checked(read_object(path), path, kind)


def checked(data: dict, path: Path, kind: str, above: str = "") -> dict:
    """What was read of a file that is not JSON, or stands at its key `above`; otherwise as read_spec."""
    if errors := sorted(_validator(kind).iter_errors(data), key=_order):
        raise UserError(f"{path}#/{_fault(errors[0], above)}")
    return data


def refused(path: Path, place: str, found, needed: str) -> UserError:
    """What a reader raises for what no schema can say. place: the keys to it, joined by /."""
    return UserError(f"{path}#/{place}: found {found!r}; {needed} is needed")


def require_names_once(path: Path, place: str, names: list[str]) -> None:
    """Errors: UserError for a name that is there twice."""
    if len(set(names)) != len(names):
        raise refused(path, place, names, "every name once")


def require_base(data: dict, path: Path, above: str = "") -> Path:
    """The config that a spec, or the part of one at `above`, names relative to its file. Errors: UserError
    where it is not there.
    """
    base = data.get("base")
    if not isinstance(base, str) or not (path.parent / base).is_file():
        raise refused(path, f"{above}base", base, "the path of a config, relative to this file,")
    return path.parent / base
