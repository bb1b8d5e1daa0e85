"""Drift of a frictionless card: the kinetic energy that a card loses, or gains, while it slides over a
meshed floor.

Without friction nothing may change the horizontal speed, so that any loss is an error of the contact
between two meshes. A scene is one direction of the floor's mesh, a level one size of its triangles; a
number is the largest share of the kinetic energy over the levels of a scene, geometric mean over scenes
with Student's 95% interval.
"""

import math
from collections import defaultdict

from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.tables.numbers import written
from barrierbench_analysis.tables.outcomes import OK
from barrierbench_analysis.tables.statistics import ratio_of_scenes

FLOOR = 1e-12  # shares below it are rounding


def _share(row: Row) -> float | None:
    """Of the kinetic energy once the card has settled on the floor, the part that is gone, or has come, at
    the end.
    """
    settled, end = row.values["settled_J"], row.values["end_J"]
    return None if row.outcome != OK or not settled or end is None else max(abs(1 - end / settled), FLOOR)


def rule(study: Study, rows: list[Row]) -> dict:
    """The table of the page."""
    body = []
    for label, name in study.about["names"].items():
        mine = [row for row in rows if row.place["formulation"] == label]
        ended = [row for row in mine if _share(row) is not None]
        of_scene: dict[str, list[float]] = defaultdict(list)
        for row in ended:
            of_scene[row.place["scene"]].append(_share(row))
        found = ratio_of_scenes({scene: {"largest": [math.log(max(v))]} for scene, v in of_scene.items()})
        gaps = [row.values["gap_min"] for row in ended if row.values["gap_min"] is not None]
        newton = [row.values["newton"] for row in ended]
        numbers = [written(found), f"{min(gaps):.2g}" if gaps else "-"]
        mean = f"{sum(newton) / len(newton):.0f}" if newton else "-"
        body.append([name, f"{len(ended)} of {len(mine)}", *numbers, mean])
    head = ["formulation", "ends ok", "largest share of kinetic energy", "least gap / d_hat", "Newton (mean)"]
    return {"table": "\n".join(markdown(head, body)), "scenes": len({row.place["scene"] for row in rows})}
