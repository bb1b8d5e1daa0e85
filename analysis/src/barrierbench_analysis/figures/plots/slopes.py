"""Lines through points on two logarithmic axes, and their slopes."""

from __future__ import annotations

import numpy as np

from barrierbench_analysis.figures import style
from barrierbench_analysis.tables import statistics


def slope(x, y) -> float | None:
    """Least squares of log y over log x; None with fewer than two different x above 0."""
    x, y = np.asarray(x, float), np.asarray(y, float)
    good = (x > 0) & (y > 0) & np.isfinite(x) & np.isfinite(y)
    return statistics.slope(zip(np.log(x[good]), np.log(y[good])))


def words(of: dict[str, float | None]) -> str:
    """`name 1.20`, a line each."""
    return "\n".join(f"{name}: {'-' if value is None else f'{value:.2f}'}" for name, value in of.items())


def draw(axis, x, y, formulation: str, failed=(), row: int = 0) -> None:
    """Points of one formulation with a line through them, in order. failed: x of runs without a y, crosses
    in this row at the upper edge.
    """
    look = style.look(formulation)
    axis.plot(x, y, color=look.color, linestyle=look.dash, marker=look.marker, label=formulation)
    style.failures_above(axis, failed, look.color, row)


def note(axis, of: dict[str, float | None], corner: str = "upper left") -> None:
    """The slopes, in a corner that the lines leave free."""
    up, left = corner.split()
    axis.text(
        0.03 if left == "left" else 0.97,
        0.9 if up == "upper" else 0.03,
        "slopes\n" + words(of),
        transform=axis.transAxes,
        ha=left,
        va="top" if up == "upper" else "bottom",
        fontsize=5.5,
        bbox={"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 1},
    )
