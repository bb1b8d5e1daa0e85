"""What Python hands to the program: numbers and arrays that are real, configs and queries as JSON."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from numbers import Integral, Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core


def reals(value: Any, where: str) -> NDArray[np.float64]:
    """An array of doubles. Errors: ConfigError for complex numbers, None, text and other objects, and ragged lists.

    >>> reals([1, 2.5], "d").tolist()
    [1.0, 2.5]
    >>> reals([1 + 2j], "d")
    Traceback (most recent call last):
        ...
    barrierbench._core.ConfigError: d: found complex numbers; allowed: real numbers
    """
    try:
        found = np.asarray(value)
    except ValueError:
        raise _refused(where, "lists of different lengths", "an array of real numbers") from None
    if found.dtype.kind not in "uif":
        raise _refused(where, _kind(found), "real numbers")
    return found.astype(float, copy=False)


def finite_reals(value: Any, where: str) -> NDArray[np.float64]:
    """The same without infinity and NaN. Errors: ConfigError with the first element that is neither."""
    found = reals(value, where)
    wrong = np.argwhere(~np.isfinite(found))
    if len(wrong):
        at = tuple(map(int, wrong[0]))
        place = where + "".join(f"[{i}]" for i in at)
        raise _refused(place, str(found[at]), "a finite number")
    return found


def real(value: Any, where: str) -> float:
    """One finite number, of Python or numpy. Errors: ConfigError."""
    found = finite_reals(value, where)
    if found.ndim:
        raise _refused(where, f"an array of shape {found.shape}", "one number")
    return float(found)


def folder(out: str | os.PathLike | None) -> str:
    """A folder to write to, as a path; "" for None. Errors: ConfigError for a text that is empty."""
    if out is None:
        return ""
    if not os.fspath(out):
        raise _refused("out", "an empty path", "a folder, or None")
    return os.fspath(out)


def json_text(value: Any, where: str) -> str:
    """JSON of dicts, lists, tuples, numbers, texts, paths, and numpy arrays and scalars. Errors: ConfigError with the
    place of what is none of these, of an infinite number and of NaN.

    >>> json_text({"steps": np.int64(3), "axis": np.array([0.0, 0, 1])}, "config")
    '{"steps": 3, "axis": [0.0, 0.0, 1.0]}'
    """
    return json.dumps(_plain(value, f"{where}#"))


def _plain(value: Any, where: str) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {_key(key, where): _plain(one, f"{where}/{key}") for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one, f"{where}/{i}") for i, one in enumerate(value)]
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if value is None or isinstance(value, bool | str):
        return value
    if isinstance(value, Integral):
        return int(value)
    if isinstance(value, Real) and math.isfinite(value):
        return float(value)
    found = str(value) if isinstance(value, Real) else f"{value!r:.60} of type {type(value).__name__}"
    raise _refused(where, found, "a finite number, text, true, false, null, a list or a dict")


def _key(key: Any, where: str) -> str:
    if not isinstance(key, str):
        raise _refused(where, f"the key {key!r}", "keys that are text")
    return key


def _kind(found: NDArray[Any]) -> str:
    if found.dtype.kind == "c":
        return "complex numbers"
    if found.dtype.kind == "O" and any(one is None for one in found.flat):
        return "None"
    return f"{'an array of ' if found.ndim else ''}type {found.dtype}"


def _refused(where: str, found: str, allowed: str) -> _core.ConfigError:
    return _core.ConfigError(f"{where}: found {found}; allowed: {allowed}")
