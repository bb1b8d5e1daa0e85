"""Whether a main effect rests on an interaction: its direct effect, in the runs that its level and the first
one may both have, of which those with some level of another factor are left out. It has to agree with the
fitted one whatever one or two such levels are left out. Of ratios the fitted effects of the other factors
are taken off. Of shares nothing is: the fitted effect of a level that fails with one shape alone would make
a difference where every run gets through.

Where exclusions bind a level, so that it may not stand with all that the first one may stand with, its
coefficient leans on the other factors having no interactions in the part that it cannot reach: there the
direct effect has to agree with nothing left out, too.
"""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from .factors import Combination, Factorial

Part = tuple[int, int]  # factor, level
Contexts = dict[Part, set[Combination]]
MOST_LEFT_OUT = 2  # levels at a time


def contexts(factorial: Factorial) -> Contexts:
    """(factor, level) -> what may stand with it: allowed combinations without the factor."""
    found: Contexts = {}
    for one in factorial.allowed:
        for f, level in enumerate(one):
            found.setdefault((f, level), set()).add(one[:f] + one[f + 1 :])
    return found


def is_bound(allowed: Contexts, part: Part) -> bool:
    return allowed[part] != allowed[part[0], 0]


def left_out(factorial: Factorial, factor: int, bound: bool) -> Iterator[tuple[Part, ...]]:
    """What is left out of the direct effect of a level of a factor, in turn: nothing where exclusions bind
    it, each level of another factor that is not its first, and each two of them."""
    others = [(f, k) for f, n in enumerate(factorial.sizes) for k in range(1, n) if f != factor]
    for n in range(0 if bound else 1, MOST_LEFT_OUT + 1):
        yield from combinations(others, n)


def compared(
    allowed: Contexts,
    part: Part,
    levels: list[Combination],
    y: list[float],
    others: dict[Part, float] | None,
) -> list[tuple[Combination, float | None]]:
    """Of the runs of one scene those that both a level of a factor and the first one may have: levels, and
    the value less the effects of all other factors, None where one of these is not known. others: (factor,
    level) -> fitted effect; None: nothing is taken off.
    """
    f, level = part
    both, found = allowed[part] & allowed[f, 0], []
    for one, value in zip(levels, y, strict=True):
        if one[f] in (0, level) and one[:f] + one[f + 1 :] in both:
            taken = [] if others is None else [others.get((g, k)) for g, k in enumerate(one) if g != f and k]
            found.append((one, None if None in taken else value - sum(taken)))
    return found


def direct(
    part: Part, runs: list[tuple[Combination, float | None]], out: tuple[Part, ...] = ()
) -> float | None:
    """Mean of the level less mean of the first one, of these runs (`compared`) without those that have a
    level of `out`. None where either has no run, or an effect that is needed has no value.
    """
    f, level = part
    arms: dict[int, list[float]] = {0: [], level: []}
    for one, value in runs:
        if not any(one[g] == k for g, k in out):
            if value is None:
                return None
            arms[one[f]].append(value)
    return float(np.mean(arms[level]) - np.mean(arms[0])) if all(arms.values()) else None
