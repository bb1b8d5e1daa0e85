"""The gap map: condition numbers and iterations against the gap that contact reaches, by shape, scene,
resolution and strain limit, and the area law beside them.
"""

from .figures import draw
from .measured import MEASURED, measure
from .page import rule
from .skips import decided
from .spec import cells

PARTIAL = True
ALIKE = ("scene", "resolution", "limit", "theta")  # of a sweep: its runs share their calibration runs

__all__ = ["ALIKE", "MEASURED", "PARTIAL", "cells", "decided", "draw", "measure", "rule"]
