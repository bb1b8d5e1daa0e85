"""What a gap map costs: measured seconds, and what they say of runs that are not there yet."""

from __future__ import annotations

import math

import numpy as np

from barrierbench_analysis.tables.statistics import slope

from .rows import PLACE
from .spec import Cell

# power of the unknowns by which seconds grow where too few sizes were measured; a cloth of 192 to 2352
# unknowns has it
GROWTH = 1.7
FEWEST = 2  # sizes that a fit needs


def growth(measured: list[tuple[float, float]]) -> float:
    """Power p of seconds ~ unknowns^p; GROWTH where less than a factor 3 in size was measured."""
    sizes = {n for n, _ in measured}
    if len(sizes) < FEWEST or max(sizes) < 3 * min(sizes):
        return GROWTH
    return max(1.0, slope((math.log(n), math.log(seconds)) for n, seconds in measured))


def estimate(
    cells: list[Cell], rows: list[dict], unknowns: dict[tuple[str, str], int]
) -> dict[tuple[str, str], tuple[int, int, float | None]]:
    """(scene, resolution) -> runs, those that are there, seconds of one core for the rest. A place with runs
    has their mean; another one that of the nearest size of its scene, or of all scenes, grown with the
    unknowns; None where nothing at all was measured.
    """
    timed = [r for r in rows if r["seconds"] and r["unknowns"]]
    done = {tuple(r[c] for c in PLACE) for r in rows if r["seconds"] is not None}
    power = growth([(r["unknowns"], max(r["seconds"], 1e-3)) for r in timed])
    found = {}
    for place in dict.fromkeys((c.scene, c.resolution) for c in cells):
        mine = [c for c in cells if (c.scene, c.resolution) == place]
        left = sum(c.key not in done for c in mine)
        near = [r for r in timed if r["scene"] == place[0]] or timed
        each = None
        if near:
            size = unknowns[place]
            closest = min((r["unknowns"] for r in near), key=lambda n: abs(math.log(n / size)))
            each = (
                float(np.mean([r["seconds"] for r in near if r["unknowns"] == closest]))
                * (size / closest) ** power
            )
        found[place] = (len(mine), len(mine) - left, None if each is None else left * each)
    return found


def lines(found: dict[tuple[str, str], tuple[int, int, float | None]]) -> list[str]:
    text = [
        f"{scene:12} {resolution:>5}: {runs:4} runs, {done:4} there, "
        + (
            "nothing measured to estimate by"
            if left is None
            else f"about {left / 60:.1f} min of one core for the rest"
        )
        for (scene, resolution), (runs, done, left) in found.items()
    ]
    known = [left for _, _, left in found.values() if left is not None]
    text.append(
        f"{'all':18}: {sum(f[0] for f in found.values())} runs, {sum(f[1] for f in found.values())} there, "
        + (
            f"about {sum(known) / 3600:.1f} h of one core for the rest"
            if known
            else "nothing measured to estimate by"
        )
    )
    return text
