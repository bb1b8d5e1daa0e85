"""CMA-ES (N. Hansen, arXiv:1604.00772) by the package cma, which goes on from kept points: a generation is
told the points that were measured, rounded as they were, and its draws come from a generator of its own.
"""

from collections.abc import Sequence
from functools import cached_property

import numpy as np


class Evolution:
    """Least value of a function of n numbers. Each generation: ask, and tell."""

    def __init__(self, start: Sequence[float], step: float, size: int, seed: int):
        """step: standard deviation of the first draws. size: points of a generation, at least 4."""
        from cma import CMAEvolutionStrategy  # a third of a second

        draws = np.random.default_rng(seed).standard_normal
        options = {"popsize": size, "seed": float("nan"), "randn": lambda *n: draws(n), "verbose": -9}
        self.strategy, self.size = CMAEvolutionStrategy(list(start), step, options), size

    @property
    def generation(self) -> int:
        return self.strategy.countiter

    @property
    def mean(self) -> np.ndarray:
        """Of the draws of this generation."""
        return self.strategy.mean

    @cached_property
    def _asked(self) -> list[np.ndarray]:
        return self.strategy.ask()

    @property
    def spread(self) -> float:
        """Largest standard deviation of a parameter in the draws of this generation."""
        return float(self.strategy.stds.max())

    def ask(self) -> np.ndarray:
        """[size, n] the points of this generation, the same at each call."""
        return np.array(self._asked)

    def tell(self, points: Sequence[Sequence[float]], values: Sequence[float]) -> None:
        """Ends the generation. points: those that were asked for, as they were rounded."""
        self.ask()  # also of kept points, so that later draws are those of an unbroken search
        self.strategy.tell([np.array(point, float) for point in points], list(values))
        del self._asked
