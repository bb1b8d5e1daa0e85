"""Where a series goes up and down in turns, and the band that it does so in."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style

WINDOW = 10  # iterations
LEAST_SWING = 0.1  # of the value: smaller ones are read well on a line
BAND = "band"  # gid of its edges


def swings_from(values: np.ndarray) -> int | None:
    """From which index on, to the end and for at least WINDOW values, at least half of every WINDOW values
    turn back; None where it does not. A turn counts by the smaller of its two moves; where that finds none, a
    swing of unlike moves, one large among small ones, counts by the range of its WINDOW.
    """
    if len(values) < WINDOW + 2:
        return None
    moves = np.diff(values)
    back = moves[1:] * moves[:-1] < 0
    small = np.minimum(abs(moves[1:]), abs(moves[:-1])) > LEAST_SWING * abs(values[1:-1])
    low, high = band(values[1:-1])
    wide = high - low > LEAST_SWING * abs(values[1:-1])
    starts = [_start(back & small), _start(back & wide)]
    return next((start for start in starts if start is not None), None)


def _start(turns: np.ndarray) -> int | None:
    share = np.convolve(turns, np.ones(WINDOW) / WINDOW, mode="valid")
    calm = np.flatnonzero(share < 0.5)
    start = int(calm[-1]) + 1 if len(calm) else 0
    return start if start < len(share) else None


def band(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Running smallest and largest of WINDOW values."""
    rolling = pd.Series(values).rolling(WINDOW, center=True, min_periods=1)
    return rolling.min().to_numpy(), rolling.max().to_numpy()


@dataclass(frozen=True)
class Band:
    """Where a series begins to swing, and between which numbers it does so at its end."""

    series: str
    start: float  # on the horizontal axis
    low: float
    high: float


def draw(
    axis, x: np.ndarray, y: np.ndarray, row: pd.Series, end_mark: bool = False, since: int = 0
) -> list[Band]:
    """The run's line, as a filled band from where it swings, `since` at the earliest. Returns the band, or
    nothing.
    """
    found = swings_from(y[since:])
    if found is None:
        style.draw(axis, x, y, row, end_mark=end_mark)
        return []
    start = since + found
    style.draw(axis, x[: start + 1], y[: start + 1], row, end_mark=False)
    low, high = band(y[start:])
    color = style.look_of(row).color
    axis.fill_between(x[start:], low, high, color=color, alpha=0.25, linewidth=0)
    for edge in (low, high):
        axis.plot(x[start:], edge, color=color, linewidth=0.5, gid=BAND)
    if end_mark and row["outcome"] != "ok":
        style.draw_failure(axis, x[-1], y[-1], color)
    return [Band(row["series"], float(x[start]), float(low[-1]), float(high[-1]))]


def sentence(bands: list[tuple[str, Band]], start: str) -> str:
    """For a caption; bands: what is drawn, and its band; start: where a band begins, as "iteration {:g}".
    Empty without bands.
    """
    words = [
        f"{what}, {b.series} from {start.format(b.start)} on, {b.low:.3g} to {b.high:.3g} at the end"
        for what, b in bands
    ]
    return (
        f"Filled, in place of a line: the least to the largest of {WINDOW} iterations, once at least half of"
        f" them go back ({'; '.join(words)})."
        if words
        else ""
    )
