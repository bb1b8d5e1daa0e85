"""CMA-ES, an evolution strategy that adapts the covariance of its draws, with positive weights. Rules and
constants: N. Hansen, The CMA evolution strategy: a tutorial, arXiv:1604.00772, figure 6 and table 1.

It is written here since a search goes on from kept points: what a call draws is a function of the points and
values of the generations before it, and not of how an earlier machine rounded its draws.
"""

import math
from collections.abc import Sequence

import numpy as np


class Evolution:
    """Least value of a function of n numbers. Each generation: ask, and tell."""

    def __init__(self, start: Sequence[float], step: float, size: int, seed: int):
        """step: standard deviation of the first draws. size: points of a generation, at least 4."""
        n, half = len(start), size // 2
        self.mean, self.step, self.size, self.seed = np.array(start, float), float(step), size, seed
        self.generation = 0
        weights = math.log((size + 1) / 2) - np.log(np.arange(1, half + 1))
        self.weights = weights / weights.sum()
        mass = 1 / float(np.sum(self.weights**2))
        self.c_step = (mass + 2) / (n + mass + 5)
        self.damping = 1 + 2 * max(0.0, math.sqrt((mass - 1) / (n + 1)) - 1) + self.c_step
        self.c_path = (4 + mass / n) / (n + 4 + 2 * mass / n)
        self.c_one = 2 / ((n + 1.3) ** 2 + mass)
        self.c_many = min(1 - self.c_one, 2 * (mass - 2 + 1 / mass) / ((n + 2) ** 2 + mass))
        self.mass, self.expected = mass, math.sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n))
        self.covariance, self.path, self.step_path = np.eye(n), np.zeros(n), np.zeros(n)

    def _root(self, power: float) -> np.ndarray:
        """The symmetric power of the covariance."""
        values, vectors = np.linalg.eigh(self.covariance)
        return (vectors * values**power) @ vectors.T

    def ask(self) -> np.ndarray:
        """[size, n] the points of this generation, the same at each call."""
        draws = np.random.default_rng([self.seed, self.generation]).standard_normal(
            (self.size, len(self.mean))
        )
        return self.mean + self.step * draws @ self._root(0.5)

    def tell(self, points: Sequence[Sequence[float]], values: Sequence[float]) -> None:
        """Ends the generation. points: those that were asked for, as they were rounded."""
        order = np.argsort(values, kind="stable")[: len(self.weights)]
        ways = (np.asarray(points, float)[order] - self.mean) / self.step
        way = self.weights @ ways
        kept = 1 - self.c_step
        self.step_path = (
            kept * self.step_path + math.sqrt(self.c_step * (1 + kept) * self.mass) * self._root(-0.5) @ way
        )
        length = float(np.linalg.norm(self.step_path))
        grown = math.sqrt(1 - kept ** (2 * (self.generation + 1)))
        stalls = length / grown >= (1.4 + 2 / (len(self.mean) + 1)) * self.expected
        self.path = (1 - self.c_path) * self.path
        if not stalls:
            self.path += math.sqrt(self.c_path * (2 - self.c_path) * self.mass) * way
        lost = self.c_one * self.c_path * (2 - self.c_path) if stalls else 0.0
        self.covariance = (
            (1 + lost - self.c_one - self.c_many) * self.covariance
            + self.c_one * np.outer(self.path, self.path)
            + self.c_many * (ways.T * self.weights) @ ways
        )
        self.mean = self.mean + self.step * way
        self.step *= math.exp(self.c_step / self.damping * (length / self.expected - 1))
        self.generation += 1
