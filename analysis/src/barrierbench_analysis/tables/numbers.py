"""Numbers as pages, tables and stores write them. What has no value, None or NaN, is written as `none`."""

import math
from collections.abc import Callable
from typing import TypeVar

KEPT_DIGITS = 6  # of the numbers of a store
T = TypeVar("T")


def _missing(value: float | None) -> bool:
    return value is None or value != value


def written(value: object) -> str:
    """Any value as it writes itself."""
    return "-" if value is None else str(value)


def significant(value: float | None, digits: int = 3, none: str = "-", unit: str = "") -> str:
    """So many significant digits, with a power of ten where Python writes one."""
    return none if _missing(value) else f"{value:.{digits}g}{unit}"


def whole(value: float | None, digits: int = 3, none: str = "-", comma: str = "") -> str:
    """So many significant digits, and every digit before the point. An infinite value is `none` as well.
    comma: "," between thousands.
    """
    if _missing(value) or math.isinf(value):
        return none
    return f"{value:{comma}.{digits}g}" if abs(value) < 10 ** (digits - 1) else f"{value:{comma}.0f}"


def number(value: float | None, digits: int = 3) -> str:
    """As whole, from 1e-3 to 1e5; a power of ten without padding outside: 2.50e7."""
    if not _missing(value) and value != 0 and not 1e-3 <= abs(value) < 1e5:
        return f"{value:.{digits - 1}e}".replace("e+0", "e").replace("e-0", "e-").replace("e+", "e")
    return whole(value, digits)


def ratio(value: float | None) -> str:
    """Three digits; six where three would make it 1, which it is not."""
    return significant(value, 6 if value != 1 and significant(value) == "1" else 3)


def interval(value: float, lower: float | None, upper: float | None, write: Callable = significant) -> str:
    """`value [lower, upper]`, and the value alone where there is no interval."""
    return write(value) + ("" if lower is None else f" [{write(lower)}, {write(upper)}]")


def rounded(value: T, digits: int = KEPT_DIGITS) -> T:
    """Every float of a value, a list or an object to so many significant digits; all else as it is."""
    if isinstance(value, dict):
        return {key: rounded(one, digits) for key, one in value.items()}
    if isinstance(value, list):
        return [rounded(one, digits) for one in value]
    return float(f"{value:.{digits}g}") if isinstance(value, float) else value
