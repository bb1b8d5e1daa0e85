"""How far does a frictionless card drift that rests on a flat table of triangles? Without friction nothing
may push it sideways, so every tangential force is an error of the contact between two meshes.

Stiffnesses are matched by force: each formulation, on each surface, carries the card at the same gap.
"""

import tempfile
from pathlib import Path

from barrierbench_analysis.studies.kit.study import collect
from barrierbench_analysis.studies.kit.study.spec import Cell, Study
from barrierbench_analysis.studies.kit.study.store import Row

from .matched import cells
from .measured import MEASURED, measure
from .report import rule

GROWS = True  # stiffnesses of placements follow from the runs that match them
PARTIAL = True  # combinations that cannot be matched have no placements; the page shows how they ended


def run(study: Study, chosen: list[Cell], folder: Path, jobs: int) -> list[Row]:
    """Rows of cells of one base, each with its own limit of processor time. A run has a frame for every
    step, so the runs are kept only where a call names a folder.
    """
    if study.out:
        return collect.run_each(study, chosen, folder, jobs, study.data["run_s"])
    with tempfile.TemporaryDirectory() as scratch:
        return collect.run_each(study, chosen, Path(scratch), jobs, study.data["run_s"])


def draw(study: Study, rows: list[Row], _numbers: dict, folder: Path) -> list[Path]:
    from . import figure

    return figure.draw(study, rows, folder / study.rule)


__all__ = ["GROWS", "MEASURED", "PARTIAL", "cells", "draw", "measure", "rule", "run"]
