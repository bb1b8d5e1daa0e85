"""An adversary: for each statement of the study at size and of the claims that hold a random search over the
scenes, starts and parameters of their runs, which looks for runs that contradict it.

A draw is what a statement compares, in one scene with one set of parameters: two runs, or one, or four. Draws
are seeded. Half of them are drawn from the whole region, half close to the most contrary draw before them.
"""

from .draws import cells, planned
from .measured import MEASURED, measure, run
from .page import rule

PARTIAL = True
GROWS = True  # the cells of today follow from the kept rows: each row may bring further draws
ALIKE = ("statement", "draw")

__all__ = ["ALIKE", "GROWS", "MEASURED", "PARTIAL", "cells", "measure", "planned", "rule", "run"]
