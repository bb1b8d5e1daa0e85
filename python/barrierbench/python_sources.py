"""What records name of classes that Python brings to a run: their file and its hash."""

from __future__ import annotations

import hashlib
import inspect
from typing import Any

_sources: dict[str, tuple[str, str]] = {}  # name -> file, sha256


def is_name(name: Any) -> bool:
    """Whether it is a snake_case word, as all names of registries are."""
    return isinstance(name, str) and name.isidentifier() and name == name.lower()


def remember(thing: Any, name: str) -> None:
    """From now on `thing` is what `name` stands for."""
    _sources[name] = _source_of(thing, name)


def brought(*names: str) -> list[tuple[str, str, str]]:
    """Name, file, sha256 of those that Python brought; nothing for names of the program."""
    return [(name, *_sources[name]) for name in names if name in _sources]


def _source_of(thing: Any, name: str) -> tuple[str, str]:
    """Of the file of its class, or of the text of the class where it has none (a notebook)."""
    try:
        file = inspect.getsourcefile(type(thing)) or ""
        with open(file, "rb") as stream:
            return file, hashlib.sha256(stream.read()).hexdigest()
    except (OSError, TypeError):
        pass
    try:
        text = inspect.getsource(type(thing))
    except (OSError, TypeError):
        text = repr(type(thing))
    return f"python:{name}", hashlib.sha256(text.encode()).hexdigest()
