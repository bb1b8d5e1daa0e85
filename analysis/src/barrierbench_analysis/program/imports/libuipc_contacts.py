"""The table of contacts of a scene of libuipc as coefficients of bodies (contact_tabular.cpp, 619a541)."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

RULES = {"min": min, "max": max, "mean": lambda a, b: (a + b) / 2}
Pair = tuple[int, int]


@dataclass
class Contacts:
    """By pair of contact elements, the smaller number first: the coefficient, and whether they meet. A pair
    that the table has no row for is as the pair (0, 0).
    """

    rates: dict[Pair, float]
    active: dict[Pair, bool]

    def meet(self, a: int, b: int) -> bool:
        return self.active.get(_pair(a, b), self.active.get((0, 0), True))

    def rate(self, a: int, b: int) -> float:
        return self.rates.get(_pair(a, b), self.rates.get((0, 0), 0.0))

    def coefficients(self, met: Iterable[Pair]) -> tuple[str, dict[int, float], dict[Pair, tuple]]:
        """For the pairs that can meet: how coefficients combine, that of each element, and the pairs that
        come out wrong, with the value of the table and what it became. Where a rule can give all pairs, the
        smallest coefficients that are not too low do it for min, and the largest that are not too high for
        max.
        """
        wanted = {_pair(*pair): self.rate(*pair) for pair in met}
        partners: dict[int, list[float]] = {}
        for pair, rate in wanted.items():
            for element in set(pair):
                partners.setdefault(element, []).append(rate)
        found = {
            "min": {element: max(rates) for element, rates in partners.items()},
            "max": {element: min(rates) for element, rates in partners.items()},
            "mean": _means(wanted, sorted(partners)),
        }
        wrong = {rule: _wrong(wanted, rule, found[rule]) for rule in RULES}
        best = min(RULES, key=lambda rule: len(wrong[rule]))
        return best, found[best], wrong[best]


def _pair(a: int, b: int) -> Pair:
    return (a, b) if a <= b else (b, a)


def _means(wanted: dict[Pair, float], elements: list[int]) -> dict[int, float]:
    """Coefficients whose means are nearest to those of the pairs."""
    if not wanted:
        return {}
    matrix = np.zeros((len(wanted), len(elements)))
    for row, pair in zip(matrix, wanted):
        for element in pair:
            row[elements.index(element)] += 0.5
    found = np.linalg.lstsq(matrix, np.array(list(wanted.values())), rcond=None)[0]
    return dict(zip(elements, np.maximum(found, 0.0).round(12).tolist()))


def _wrong(wanted: dict[Pair, float], rule: str, of_element: dict[int, float]) -> dict[Pair, tuple]:
    made = {pair: RULES[rule](*(of_element[element] for element in pair)) for pair in wanted}
    return {pair: (rate, made[pair]) for pair, rate in wanted.items() if abs(made[pair] - rate) > 1e-9}
