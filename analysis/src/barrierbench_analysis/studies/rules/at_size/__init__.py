"""The study at size: which part of the gain of a barrier is left at the sizes of papers. Six questions whose
outcome words are fixed before the first run, and three laws with the observations that would refute them.
"""

from barrierbench_analysis.studies.kit import metrics
from barrierbench_analysis.studies.kit.study import store
from barrierbench_analysis.studies.rules import gap_map
from barrierbench_analysis.tables import outcomes

from .cells import cells
from .figure import draw
from .measured import MEASURED, measure
from .page import rule

PARTIAL = True
ALIKE = ("scene", "size", "setting")  # of a sweep: few runs, so that their rows are kept soon
USES = (gap_map.measured, metrics, store, outcomes)  # what numbers depend on beside this folder
SHOWS = ("figure", "page")  # modules that no number depends on: they are not registered

__all__ = ["ALIKE", "MEASURED", "PARTIAL", "SHOWS", "USES", "cells", "draw", "measure", "rule"]
