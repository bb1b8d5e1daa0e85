"""Which panels a figure leaves out: one flat line, or the number of another panel times a constant."""

from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from .style import LEAST_RATIO

FLAT = 1.05  # largest over smallest number of a flat line
SAME = 0.03  # of the height of a panel: a smaller difference is not seen
SHARE = 0.95  # of the points have to keep to it
RULE = (
    f"(a panel is left out where {SHARE:.0%} of its points are within a factor {FLAT:g}, or within"
    f" {SAME:.0%} of its height of another panel times a constant)"
)


@dataclass(frozen=True)
class Panel:
    """name: for captions; numbers: those that would be drawn, by whose they are (the index); across: on the
    other axis, where that differs between panels.
    """

    name: str
    numbers: pd.Series
    across: pd.Series | None = None

    def logs(self) -> pd.Series:
        return _logs(self.numbers)


def _logs(numbers: pd.Series) -> pd.Series:
    numbers = pd.to_numeric(numbers)
    return np.log(numbers[np.isfinite(numbers) & (numbers > 0)])


def _middle(logs: pd.Series) -> tuple[float, float]:
    """Between which SHARE of the numbers lie."""
    low, high = np.quantile(logs, [(1 - SHARE) / 2, (1 + SHARE) / 2])
    return float(low), float(high)


def is_flat(panel: Panel) -> bool:
    low, high = _middle(panel.logs())
    return high - low <= np.log(FLAT)


def _constant(of: pd.Series, over: pd.Series) -> float | None:
    """Of two logarithms: what their difference is where it is the same, as far as one sees, for SHARE of the
    points; None where it is not.
    """
    both = pd.concat([of, over], axis=1, join="inner")
    if len(both) < SHARE * max(len(of), len(over)):
        return None
    differences = both.iloc[:, 0] - both.iloc[:, 1]
    seen = SAME * max(np.ptp(both.iloc[:, 0]), np.log(LEAST_RATIO))
    return (
        float(differences.median())
        if ((differences - differences.median()).abs() <= seen).mean() >= SHARE
        else None
    )


def constant(panel: Panel, other: Panel) -> float | None:
    """What the other's numbers are multiplied by to be those of the panel; None where no constant does it, or
    they are not of the same points.
    """
    if (
        panel.across is not None
        and other.across is not None
        and _constant(_logs(panel.across), _logs(other.across)) is None
    ):
        return None
    found = _constant(panel.logs(), other.logs())
    return None if found is None else float(np.exp(found))


def _why_out(panel: Panel, kept: list[Panel]) -> str:
    """Empty where the panel stays."""
    logs = panel.logs()
    if logs.empty:
        return "not measured"
    if is_flat(panel):
        return (
            f"one flat line at {np.exp(logs.median()):.3g} ({np.exp(logs.min()):.3g} to"
            f" {np.exp(logs.max()):.3g})"
        )
    for other in kept:
        if (factor := constant(panel, other)) is not None:
            return f"{other.name} times {factor:.3g}"
    return ""


def choose(panels: list[Panel]) -> tuple[list[str], str]:
    """Names of the panels that stay, and the sentence on the others. The first one stays whatever it is."""
    kept, out = panels[:1], []
    for panel in panels[1:]:
        if why := _why_out(panel, kept):
            out.append(f"{panel.name}: {why}")
        else:
            kept = [*kept, panel]
    return [panel.name for panel in kept], f"Left out: {'; '.join(out)} {RULE}." if out else ""


def grid(count: int, width: float, height: float, most: int = 4, **how):
    """A figure with so many panels, in rows of equal length as far as it goes; height: of a row. Returns
    figure and panels.
    """
    rows = -(-count // most)
    columns = -(-count // rows)
    fig, axes = plt.subplots(
        rows, columns, figsize=(width, height * rows + 0.6), layout="constrained", squeeze=False, **how
    )
    for axis in axes.flat[count:]:
        axis.remove()
    return fig, list(axes.flat[:count])
