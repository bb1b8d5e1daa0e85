"""Rows that a call made in a folder of its own beside the kept rows of the same cells: how far a repetition
with another build or on another machine is from what is published.
"""

import math
from collections.abc import Iterable

from barrierbench_analysis.io.text_table import fitted
from barrierbench_analysis.tables.statistics import spread
from barrierbench_analysis.tables.words import counted

from .store import Row


def _logs(pairs: list[tuple[Row, Row]], name: str) -> list[float]:
    """Logarithms of new over kept, where both are numbers above 0."""
    found = [(kept.values.get(name), new.values.get(name)) for kept, new in pairs]
    return [math.log(b / a) for a, b in found if _is_above_0(a) and _is_above_0(b)]


def _is_above_0(value: object) -> bool:
    return isinstance(value, (int, float)) and value > 0


def lines(kept: dict[str, Row], new: Iterable[Row]) -> list[str]:
    """A sentence about outcomes and builds, and a table of the ratios new/kept of each number. Empty where no
    new row has a kept one with its key."""
    pairs = [(kept[row.key], row) for row in new if row.key in kept]
    if not pairs:
        return []
    same = sum(a.outcome == b.outcome for a, b in pairs)
    builds = len({(row.origin["machine"], row.origin["build"]) for pair in pairs for row in pair})
    body = []
    for name in pairs[0][1].values:
        if logs := _logs(pairs, name):
            body.append([name, str(len(logs)), *(f"{value:.6g}" for value in spread(logs))])
    cells = counted(len(pairs), "cell")
    head = f"{cells} with a kept row: the same outcome in {same}, {counted(builds, 'build')}"
    return [head, *fitted(["new/kept", "cells", "geometric mean", "least", "largest"], body)]
