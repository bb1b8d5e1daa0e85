"""Effects of levels that exclusions bind. Where a level may not stand with all that the first level of its
factor may stand with, its coefficient leans on the other factors having no interactions in the part that it
cannot reach. Beside it stands the direct effect: of the runs that both levels may have alone, with the fitted
effects of the other factors taken off.
"""

from __future__ import annotations

import numpy as np

from .factors import Factorial

Contexts = dict[tuple[int, int], set[tuple[int, ...]]]


def contexts(factorial: Factorial) -> Contexts:
    """(factor, level) -> what may stand with it: allowed combinations without the factor."""
    found: Contexts = {}
    for one in factorial.allowed:
        for f, level in enumerate(one):
            found.setdefault((f, level), set()).add(one[:f] + one[f + 1 :])
    return found


def is_bound(allowed: Contexts, part: tuple[int, int]) -> bool:
    return allowed[part] != allowed[part[0], 0]


def direct(
    allowed: Contexts,
    part: tuple[int, int],
    levels: list[tuple[int, ...]],
    y: list[float],
    others: dict[tuple[int, int], float],
) -> float | None:
    """Mean of the level less mean of the first one, of the runs of one scene that both may have. others:
    (factor, level) -> fitted effect. None where either has no run, or an effect that is needed has no value.
    """
    f, level = part
    both = allowed[part] & allowed[f, 0]
    arms: dict[int, list[float]] = {0: [], level: []}
    for one, value in zip(levels, y, strict=True):
        if one[f] in arms and one[:f] + one[f + 1 :] in both:
            taken = [others.get((g, k)) for g, k in enumerate(one) if g != f and k]
            if None in taken:
                return None
            arms[one[f]].append(value - sum(taken))
    return float(np.mean(arms[level]) - np.mean(arms[0])) if all(arms.values()) else None
