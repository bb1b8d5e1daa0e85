"""One picture of all scenes: the last state of a run of each, drawn by ./bench render."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path

import matplotlib.image as image
import matplotlib.pyplot as plt

from .. import style
from ..render import Look, render

COLUMNS = 5
PIXELS = (360, 280)
VIEW = (-60.0, 22.0)  # degrees, of a scene that has none of its own


def look_of(scene: dict) -> Look:
    """Of a scene of the catalogue: its view, without the bodies that would hide the others."""
    view = tuple(scene.get("view_deg", VIEW))
    return Look(view=view, size=PIXELS, bare=True, hidden=tuple(scene.get("hidden_bodies", ())))


def contact_sheet(runs: dict[str, tuple[Path, Look]], out: Path) -> Path:
    """A still for each scene -> folder of a run with frames and how it is looked at, with its name above
    it.
    """
    rows = math.ceil(len(runs) / COLUMNS)
    size = (2 * style.WIDE_IN, 2 * style.WIDE_IN * rows / COLUMNS * 0.85)
    fig, axes = plt.subplots(rows, COLUMNS, figsize=size, squeeze=False, layout="constrained")
    for axis in axes.flat:
        axis.set_axis_off()
    with tempfile.TemporaryDirectory() as scratch:
        for axis, (name, (folder, look)) in zip(axes.flat, runs.items()):
            still = render(folder, out=Path(scratch) / f"{name}.png", look=look)
            axis.imshow(image.imread(still))
            axis.set_title(name, fontsize=10)
    out.parent.mkdir(parents=True, exist_ok=True)
    fig.savefig(out, dpi=130, metadata={"Software": None})
    plt.close(fig)
    return out
