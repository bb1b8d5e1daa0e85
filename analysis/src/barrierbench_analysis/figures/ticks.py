"""Readable ticks of logarithmic axes: few, and in plain numbers where these are short."""

import math

import numpy as np
from matplotlib.ticker import (
    FixedLocator,
    FuncFormatter,
    LogFormatterSciNotation,
    LogLocator,
    MaxNLocator,
    NullFormatter,
)

MOST = 7  # ticks of an axis
STEPS = ((1, 2, 5), (1, 3), (1,))  # within a decade, the finest first
PLAIN = (1e-3, 1e4)  # numbers that are short


def places(low: float, high: float, most: int = MOST) -> list[float]:
    """At least two, at most `most` numbers between low and high: 1, 2, 5 of every decade, or 1 and 3, or
    decades; round numbers where the axis is too narrow for these. Decades alone where numbers get long.
    Requires 0 < low < high.
    """
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    found = [[m * 10.0**d for d in decades for m in steps if low <= m * 10.0**d <= high] for steps in STEPS]
    if len(found[0]) < 2:
        return [
            float(x) for x in MaxNLocator(4, steps=[1, 2, 5, 10]).tick_values(low, high) if low <= x <= high
        ]
    long = (low < PLAIN[0] or high > PLAIN[1]) and len(found[-1]) >= 2
    finest = found[-1] if long else next((ticks for ticks in found if 2 <= len(ticks) <= most), found[-1])
    return finest[:: math.ceil(len(finest) / most)]


def words(ticks: list[float]) -> list[str]:
    """Plain numbers, or powers of ten for all where the ticks are decades and some number is long."""
    decades = all(abs(math.log10(x) - round(math.log10(x))) < 1e-9 for x in ticks)
    if decades and any(not PLAIN[0] <= x <= PLAIN[1] for x in ticks):
        return [f"$10^{{{round(math.log10(x))}}}$" for x in ticks]
    return [f"{x:g}" for x in ticks]


def log_ticks(axis, low: float, high: float, most: int = MOST) -> None:
    """axis: an XAxis or YAxis that shows low to high on a logarithmic scale."""
    ticks = places(low, high, most)
    named = dict(zip(ticks, words(ticks)))
    axis.set_major_locator(FixedLocator(ticks))
    axis.set_major_formatter(FuncFormatter(lambda x, _: named.get(x, "")))
    axis.set_minor_formatter(NullFormatter())


def make_readable(panels) -> None:
    """Every logarithmic axis that was given no ticks of its own; a narrow or low one gets fewer."""
    for panel in panels:
        width = panel.get_position().width * panel.figure.get_figwidth()
        for axis, limits, most in (
            (panel.xaxis, panel.get_xlim(), 5 if width < 2 else MOST),
            (panel.yaxis, panel.get_ylim(), 5),
        ):
            own = not isinstance(axis.get_major_locator(), LogLocator) or not isinstance(
                axis.get_major_formatter(), LogFormatterSciNotation
            )
            if not own and np.isfinite(limits).all() and limits[0] != limits[1]:
                log_ticks(axis, min(limits), max(limits), most)
