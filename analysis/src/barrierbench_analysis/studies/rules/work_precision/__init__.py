"""What a formulation costs for what it gets right: error against work, over tolerance, time step, d_hat and
stiffness.

Errors are distances to a closed form, or to the middle of two runs with a much smaller d_hat and tolerance,
whose distance is the uncertainty of that reference. Runs that fail reach nothing and stay counted.
"""

from collections.abc import Iterator
from pathlib import Path

from barrierbench_analysis.studies.kit.study.spec import Case, Study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.tables.accuracy.errors import MEANING as MEASURED

from . import figure, tables
from .errors import errors_of as measure
from .errors import needs
from .scenes import formulations_of, scenes_of

__all__ = ["MEASURED", "cells", "draw", "measure", "needs", "rule"]


def cells(study: Study) -> Iterator[Case]:
    for scene in scenes_of(study):
        yield from scene.cases(formulations_of(study))


def rule(study: Study, rows: list[Row]) -> dict:
    """The numbers of the page: of each scene, and of all together."""
    scenes = [tables.scene_of(scene, rows) for scene in scenes_of(study)]
    return {"doc": study.about.get("doc", ""), **tables.numbers(scenes)}


def draw(study: Study, rows: list[Row], numbers: dict, folder: Path) -> list[Path]:
    """Error against four costs, of each scene, and how many problems are solved within a budget."""
    scenes = numbers["scenes"]
    ranks = figure.by_rank(scenes)
    drawn = [figure.draw(scene, folder / f"{study.rule}_{scene['name']}", ranks) for scene in scenes]
    drawn.append(figure.draw_profile(scenes, folder / f"{study.rule}_profile"))
    return [path for paths in drawn for path in paths]
