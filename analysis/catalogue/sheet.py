"""One picture of all scenes: the last state of a run of each, drawn by ./bench render."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path

import matplotlib.image as image
import matplotlib.pyplot as plt

from .. import style
from ..render import render

COLUMNS = 5
PIXELS = (360, 280)


def contact_sheet(runs: dict[str, tuple[Path, tuple]], out: Path) -> Path:
    """A still for each scene -> folder of a run with frames and view (degrees, as ./bench render has it),
    with its name above it.
    """
    rows = math.ceil(len(runs) / COLUMNS)
    size = (2 * style.WIDE_IN, 2 * style.WIDE_IN * rows / COLUMNS * 0.85)
    fig, axes = plt.subplots(rows, COLUMNS, figsize=size, squeeze=False, layout="constrained")
    for axis in axes.flat:
        axis.set_axis_off()
    with tempfile.TemporaryDirectory() as scratch:
        for axis, (name, (folder, view)) in zip(axes.flat, runs.items()):
            still = render(folder, out=Path(scratch) / f"{name}.png", view=view, size=PIXELS)
            axis.imshow(image.imread(still))
            axis.set_title(name, fontsize=10)
    out.parent.mkdir(parents=True, exist_ok=True)
    fig.savefig(out, dpi=130, metadata={"Software": None})
    plt.close(fig)
    return out
