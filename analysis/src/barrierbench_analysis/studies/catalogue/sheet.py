"""One picture of all scenes: the last state of a run of each, drawn by ./bench draw still."""

from __future__ import annotations

from pathlib import Path

from barrierbench_analysis.figures.pictures.frame_pixels import Look
from barrierbench_analysis.figures.pictures.stills import COLUMNS, PIXELS, VIEW, Still, sheet


def look_of(scene: dict) -> Look:
    """Of a scene of the catalogue: its view, without the bodies that would hide the others."""
    view = tuple(scene.get("view_deg", VIEW))
    return Look(view=view, size=PIXELS, bare=True, hidden=tuple(scene.get("hidden_bodies", ())))


def contact_sheet(runs: dict[str, tuple[Path, Look]], out: Path) -> Path:
    """A still for each scene -> folder of a run with frames and how it is looked at, with its name above
    it.
    """
    return sheet([Still(name, *run) for name, run in runs.items()], out, COLUMNS)
