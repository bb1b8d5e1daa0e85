"""Which barrier shape makes Newton's method cheapest on kept hard time steps? Searches over 20 parameters of
b(u), u = d/d_hat, for the least measured iterations, and what they find beside `minimax`, which has the least
relative stiffness over a range of loads (docs/theory/load-ranges.md).
"""

from pathlib import Path

from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.studies.kit.study.store import Row

from .measured import MEASURED, measure, run
from .report import rule
from .search import cells, planned

PARTIAL = True
GROWS = True  # a generation follows from the kept rows of those before it
ALIKE = ("half", "search")


def draw(_study: Study, _rows: list[Row], numbers: dict, folder: Path) -> list[Path]:
    from . import figure

    return figure.draw(numbers["curves"], folder / "shape_search.png")


__all__ = ["ALIKE", "GROWS", "MEASURED", "PARTIAL", "cells", "draw", "measure", "planned", "rule", "run"]
