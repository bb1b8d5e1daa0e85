"""Where long work of a verb in Python is, on a terminal."""

import sys
from collections.abc import Iterable, Iterator
from typing import TypeVar

from .streams import command

T = TypeVar("T")
ERASE = "\r\033[K"


def say_where(text: str) -> None:
    """A line that is rewritten, and goes with an empty text; nothing where stderr is no terminal."""
    if sys.stderr.isatty():
        command(ERASE, sys.stderr)
        print(text, end="", file=sys.stderr, flush=True)


def counted(items: Iterable[T], total: int, what: str) -> Iterator[T]:
    """The items, with a line that says how many of all have come."""
    try:
        say_where(f"{what} 0 of {total}")
        for number, item in enumerate(items, 1):
            say_where(f"{what} {number} of {total}")
            yield item
    finally:
        say_where("")
