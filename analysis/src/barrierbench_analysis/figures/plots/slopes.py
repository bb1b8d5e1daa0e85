"""Lines through points on two logarithmic axes, and their slopes."""

import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.tables import statistics

from .drawing import each


def slope(x, y) -> float | None:
    """Least squares of log y over log x; None with fewer than two different x above 0."""
    x, y = np.asarray(x, float), np.asarray(y, float)
    good = (x > 0) & (y > 0) & np.isfinite(x) & np.isfinite(y)
    return statistics.slope(zip(np.log(x[good]), np.log(y[good])))


def draw(axis, found: pd.DataFrame, x: str, y: str) -> dict[str, float | None]:
    """A line and its slope for each formulation of a table with `outcome`; failed runs are crosses at the
    upper edge.
    """
    of = {}
    for row, name, mine, look in each(found, x):
        good = mine[np.isfinite(mine[y]) & (mine[y] > 0)]
        axis.plot(good[x], good[y], **look.line(label=name))
        style.failures_above(axis, mine.loc[mine["outcome"] != "ok", x], look.color, row)
        of[name] = slope(good[x], good[y])
    axis.set(xscale="log", yscale="log")
    style.keep_span(axis)
    return of


def note(axis, of: dict[str, float | None]) -> None:
    """The slopes, in the upper left corner, which the lines leave free."""
    words = [f"{name}: {'-' if value is None else f'{value:.2f}'}" for name, value in of.items()]
    box = {"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 1}
    text = "\n".join(["slopes", *words])
    axis.text(0.03, 0.9, text, transform=axis.transAxes, ha="left", va="top", fontsize=5.5, bbox=box)
