"""Which combinations of a factorial are run: for every scene a nearly orthogonal array of its own.

Rule, fixed before any run: from a start drawn by the seed and the name of the scene, combinations are
exchanged for other allowed ones, drawn likewise, wherever that makes the array more balanced, until a
round of exchanges finds nothing. Unbalance is the sum, over all pairs of factors, of the squared counts of
pairs of levels, each times the number of level pairs: least where every pair of levels stands together
equally often (the J2 criterion of Xu 2002, Technometrics 44(4), without weights). It is an integer, so the
draw is the same on every machine. A pair of factors of which exclusions forbid a pair of levels counts as
often as there are pairs of factors: otherwise the balance of single levels wins, all runs with implicit Euler
take the step solver that only implicit Euler has, and no run distinguishes the two.

Scenes have arrays of their own, so that the interactions that an array mixes into a main effect differ
from scene to scene: they widen the interval over scenes and do not shift its middle in one direction.
"""

import random
from itertools import combinations

import numpy as np

from barrierbench_analysis.io.errors import UserError

from .factors import Combination, Factorial

TRIES = 60  # candidates for each place of the array, a round
ROUNDS = 4


class _Counts:
    """How often pairs of levels stand together in an array. A combination is its row among the candidates."""

    def __init__(self, sizes: tuple[int, ...], candidates: tuple[Combination, ...]):
        pairs = list(combinations(range(len(sizes)), 2))
        levels = np.array(candidates)
        many = [sizes[a] * sizes[b] for a, b in pairs]
        first = np.cumsum([0, *many])
        columns = [
            at + levels[:, a] * sizes[b] + levels[:, b] for at, (a, b) in zip(first[:-1], pairs, strict=True)
        ]
        self.cell = np.stack(columns, axis=1)  # [candidates, pairs] the cell of the table `count`
        self.count = np.zeros(first[-1], dtype=np.int64)
        self.allowed = np.zeros(first[-1], dtype=bool)
        self.allowed[self.cell] = True
        whole = [self.allowed[at : at + n].all() for at, n in zip(first[:-1], many, strict=True)]
        self.weight = np.array([n * (1 if each else len(pairs)) for n, each in zip(many, whole, strict=True)])
        self.weight_of_cell = np.repeat(self.weight, many)

    def add(self, row: int, by: int) -> None:
        self.count[self.cell[row]] += by

    def cheapest(self, rows: list[int]) -> int:
        """The first of those by which the unbalance grows least when it is added: (n + 1)^2 - n^2 each."""
        growth = ((2 * self.count[self.cell[rows]] + 1) * self.weight).sum(axis=1)
        return rows[int(growth.argmin())]

    def unbalance(self) -> int:
        return int((self.count * self.count * self.weight_of_cell).sum())


def drawn(factorial: Factorial, scene: str) -> list[Combination]:
    """The combinations of a scene, sorted, each once. Errors: UserError where there are too few."""
    candidates, n = factorial.allowed, factorial.about["combinations"]
    if n > len(candidates):
        raise UserError(
            f"{factorial.path}#/about/combinations: found {n}; allowed: at most {len(candidates)}"
        )
    draw = random.Random(f"{factorial.about['seed']} {scene}")
    rows = range(len(candidates))
    chosen = draw.sample(rows, n)
    counts, inside = _Counts(factorial.sizes, candidates), set(chosen)
    for one in chosen:
        counts.add(one, 1)
    for _ in range(ROUNDS):
        before = counts.unbalance()
        for place, old in enumerate(chosen):
            counts.add(old, -1)
            others = [one for one in draw.sample(rows, min(TRIES, len(rows))) if one not in inside]
            new = counts.cheapest([old, *others])
            counts.add(new, 1)
            inside = inside - {old} | {new}
            chosen[place] = new
        if counts.unbalance() == before:
            break
    return sorted(candidates[one] for one in chosen)


def seldom(factorial: Factorial, array: list[Combination]) -> int:
    """How often the rarest allowed pair of levels stands together."""
    candidates = factorial.allowed
    counts, row = _Counts(factorial.sizes, candidates), {one: k for k, one in enumerate(candidates)}
    for one in array:
        counts.add(row[one], 1)
    return int(counts.count[counts.allowed].min())
