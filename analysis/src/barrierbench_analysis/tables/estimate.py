"""One value a scene, the mean of scenes with its interval, shares, signs, and how much alike starts are. Only
scenes are samples.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

CONFIDENCE = 0.95
Cells = dict[str, dict[str, list[float]]]  # scene -> level -> one value a start


@dataclass(frozen=True)
class OfScene:
    """The value of a scene, and the least and the largest over its levels: a scatter of repeated measures, no
    interval.
    """

    name: str
    value: float
    low: float
    high: float
    levels: int
    n: int


def of_scenes(cells: Cells) -> list[OfScene]:
    """Mean over the levels of a scene of the mean over their starts."""
    found = []
    for name, levels in cells.items():
        means = [float(np.mean(starts)) for starts in levels.values()]
        found.append(
            OfScene(
                name,
                float(np.mean(means)),
                min(means),
                max(means),
                len(means),
                sum(map(len, levels.values())),
            )
        )
    return found


def student(values) -> tuple:
    """95% interval of the mean of scene values by Student's t: lower, upper, of the last axis, so that a
    simulation asks this very function. Needs two scenes. Its coverage is measured: coverage.py.
    """
    from scipy.stats import t

    values = np.asarray(values, float)
    n = values.shape[-1]
    if n < 2:
        raise ValueError(f"{n} scenes: an interval over scenes needs two")
    half = t.ppf(0.5 + CONFIDENCE / 2, n - 1) * values.std(axis=-1, ddof=1) / np.sqrt(n)
    middle = values.mean(axis=-1)
    return middle - half, middle + half


def intraclass(groups: list[list[float]]) -> float | None:
    """Intraclass correlation of the starts at a place (one-way random effects, Shrout and Fleiss 1979, (1,1);
    groups may differ in size). None below two places of two starts, or where all numbers are the same.
    """
    groups = [np.asarray(g, float) for g in groups if len(g) > 1]
    if len(groups) < 2:
        return None
    sizes = np.array([len(g) for g in groups])
    total, places = sizes.sum(), len(groups)
    middle = np.concatenate(groups).mean()
    between = sum(len(g) * (g.mean() - middle) ** 2 for g in groups) / (places - 1)
    within = sum(((g - g.mean()) ** 2).sum() for g in groups) / (total - places)
    size = (total - (sizes**2).sum() / total) / (places - 1)
    whole = between + (size - 1) * within
    return float((between - within) / whole) if whole > 0 else None


def sign_test(wins: int, losses: int) -> float:
    """Two-sided p of so many wins and losses of a fair coin; 1 without any."""
    from scipy.stats import binomtest

    return float(binomtest(wins, wins + losses).pvalue) if wins + losses else 1.0


def wilson(successes: int, n: int) -> tuple[float, float]:
    """95% interval of a share."""
    from scipy.stats import binomtest

    found = binomtest(successes, n).proportion_ci(CONFIDENCE, method="wilson")
    return float(found.low), float(found.high)
