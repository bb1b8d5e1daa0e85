"""Means with intervals over scenes, levels and jittered starts."""

from __future__ import annotations

import numpy as np

SEED, DRAWS = 20261122, 2000
Cells = dict[str, dict[str, list[float]]]  # scene -> level -> one value a start


def mean(cells: Cells) -> float:
    """Of scenes, of their levels, of their starts: every scene counts the same."""
    return float(np.mean([np.mean([np.mean(starts) for starts in levels.values()]) for levels in cells.values()]))


def interval(cells: Cells, resample_scenes: bool = True) -> tuple[float, float]:
    """95% by bootstrap: scenes are drawn with replacement (unless it is one), then their levels, then the starts of each."""
    random = np.random.default_rng(SEED)
    slots = len(cells)
    means = np.stack([_resampled([np.asarray(v, float) for v in levels.values()], slots, random) for levels in cells.values()])
    chosen = random.integers(slots, size=(DRAWS, slots)) if resample_scenes else np.tile(np.arange(slots), (DRAWS, 1))
    drawn = means[chosen, np.arange(DRAWS)[:, None], np.arange(slots)].mean(axis=1)
    return float(np.quantile(drawn, 0.025)), float(np.quantile(drawn, 0.975))


def _resampled(levels: list[np.ndarray], slots: int, random: np.random.Generator) -> np.ndarray:
    """Means of one scene, DRAWS x slots of them, each of levels drawn with replacement and of their starts likewise."""
    n = len(levels)
    size = (DRAWS, slots, n)
    of_level = np.stack([starts[random.integers(len(starts), size=(*size, len(starts)))].mean(axis=-1) for starts in levels])
    which = random.integers(n, size=size)
    return np.take_along_axis(of_level, which[None], axis=0)[0].mean(axis=-1)


def sign_test(wins: int, losses: int) -> float:
    """Two-sided p of so many wins and losses of a fair coin; 1 without any."""
    from scipy.stats import binomtest

    return float(binomtest(wins, wins + losses).pvalue) if wins + losses else 1.0


def wilson(successes: int, n: int) -> tuple[float, float]:
    """95% interval of a share."""
    from scipy.stats import binomtest

    found = binomtest(successes, n).proportion_ci(0.95, method="wilson")
    return float(found.low), float(found.high)
