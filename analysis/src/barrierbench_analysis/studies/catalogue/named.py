"""Functions that a scene names in a key, with their parameters in the keys beside it."""

import inspect
from collections.abc import Callable
from functools import partial
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.spec_file import refused


def call(functions: tuple, key: str, keys: dict, path: Path, place: str, own: tuple = ()) -> Callable:
    """The function that `keys` names at `key`, with all other keys but the `own` ones as parameters; a
    parameter `record` is left to the caller. Errors: UserError with the place: a function that is unknown, a
    parameter that is missing or unknown.
    """
    known = {function.__name__: function for function in functions}
    function = known.get(keys.get(key))
    if function is None:
        raise refused(path, f"{place}/{key}", keys.get(key), f"one of {', '.join(known)}")
    given = {name: value for name, value in keys.items() if name not in (key, *own)}
    takes = {n: p for n, p in inspect.signature(function).parameters.items() if n != "record"}
    if missing := [name for name, one in takes.items() if one.default is one.empty and name not in given]:
        raise UserError(f"{path}#/{place}/{missing[0]}: is missing")
    if unknown := [name for name in given if name not in takes]:
        raise UserError(f"{path}#/{place}/{unknown[0]}: unknown; allowed: {', '.join((key, *own, *takes))}")
    return partial(function, **given)
