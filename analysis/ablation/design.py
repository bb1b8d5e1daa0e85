"""Which combinations of a factorial are run: for every scene a nearly orthogonal array of its own.

Rule, fixed before any run: from a start drawn by the seed and the name of the scene, combinations are
exchanged for other allowed ones, drawn likewise, wherever that makes the array more balanced, until a
round of exchanges finds nothing. Unbalance is the sum, over all pairs of factors, of the squared counts of
pairs of levels, each times the number of level pairs: least where every pair of levels stands together
equally often (the J2 criterion of Xu 2002, Technometrics 44(4), without weights). It is an integer, so the
draw is the same on every machine. A pair of factors of which exclusions forbid a pair of levels counts as
often as there are pairs of factors: otherwise the balance of single levels wins, all runs with implicit Euler
take the step solver that only implicit Euler has, and the two are not told apart.

Scenes have arrays of their own, so that the interactions that an array mixes into a main effect differ
from scene to scene: they widen the interval over scenes and do not shift its middle in one direction.
"""

from __future__ import annotations

import random
from itertools import combinations

from ..errors import UserError
from .factors import Combination, Factorial

TRIES = 60  # candidates for each place of the array, a round
ROUNDS = 4


class _Counts:
    """How often pairs of levels stand together in an array."""

    def __init__(self, sizes: tuple[int, ...], candidates: list[Combination]):
        self.pairs = list(combinations(range(len(sizes)), 2))
        self.weight = {}
        for a, b in self.pairs:
            whole = len({(one[a], one[b]) for one in candidates}) == sizes[a] * sizes[b]
            self.weight[a, b] = sizes[a] * sizes[b] * (1 if whole else len(self.pairs))
        self.count: dict[tuple[int, int, int, int], int] = {}

    def keys(self, one: Combination):
        return ((a, b, one[a], one[b]) for a, b in self.pairs)

    def add(self, one: Combination, by: int) -> None:
        for key in self.keys(one):
            self.count[key] = self.count.get(key, 0) + by

    def cost_of(self, one: Combination) -> int:
        """What the unbalance grows by when `one` is added: (n + 1)^2 - n^2 each."""
        return sum((2 * self.count.get(key, 0) + 1) * self.weight[key[:2]] for key in self.keys(one))

    def unbalance(self) -> int:
        return sum(n * n * self.weight[key[:2]] for key, n in self.count.items())


def drawn(factorial: Factorial, scene: str) -> list[Combination]:
    """The combinations of a scene, sorted, each once. Errors: UserError where there are too few."""
    candidates, n = factorial.allowed(), factorial.spec["combinations"]
    if n > len(candidates):
        raise UserError(
            f"{factorial.path}#/combinations: found {n}; at most {len(candidates)}, which are allowed"
        )
    draw = random.Random(f"{factorial.spec['seed']} {scene}")
    chosen = draw.sample(candidates, n)
    counts, inside = _Counts(factorial.sizes, candidates), set(chosen)
    for one in chosen:
        counts.add(one, 1)
    for _ in range(ROUNDS):
        before = counts.unbalance()
        for place, old in enumerate(chosen):
            counts.add(old, -1)
            others = [
                one for one in draw.sample(candidates, min(TRIES, len(candidates))) if one not in inside
            ]
            new = min([old, *others], key=counts.cost_of)
            counts.add(new, 1)
            inside = inside - {old} | {new}
            chosen[place] = new
        if counts.unbalance() == before:
            break
    return sorted(chosen)


def seldom(factorial: Factorial, array: list[Combination]) -> int:
    """How often the rarest allowed pair of levels stands together."""
    candidates = factorial.allowed()
    counts = _Counts(factorial.sizes, candidates)
    for one in array:
        counts.add(one, 1)
    return min(counts.count.get(key, 0) for one in candidates for key in counts.keys(one))
