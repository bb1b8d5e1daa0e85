"""Processes that a verb starts for its own work."""

from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing.context import BaseContext

from . import streams


def _begin(also: Callable | None, given: tuple) -> None:
    streams.prepare()
    if also:
        also(*given)


def pool(
    count: int, context: BaseContext | None = None, also: Callable | None = None, *given
) -> ProcessPoolExecutor:
    """A pool whose processes say what they say as the verb does, and begin with `also` of what is given."""
    return ProcessPoolExecutor(count, context, _begin, (also, given))
