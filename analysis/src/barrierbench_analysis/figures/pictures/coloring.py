"""Colours of a still: of vertices, triangles and bodies, and the legend or bar that says what they mean."""

from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize, to_rgb
from matplotlib.patches import Patch

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.frames import Frame

from .picture import OBSTACLE_COLOR

BODY_COLORS = "#0072B2 #E69F00 #009E73 #CC79A7 #56B4E9 #D55E00 #F0E442 #999999".split()  # Okabe-Ito


@dataclass(frozen=True)
class Coloring:
    """A field of a frame as colours: where it stands, how it is called, its unit factor and its colour
    map."""

    element: str  # vertex or triangle
    key: str
    label: str
    factor: float
    colors: str
    top: float | None  # end of the scale; None: the largest value of the frame


COLORINGS = {
    "gap": Coloring(
        "vertex", "gap_rel", r"smallest gap of a vertex / $\hat d$ (1: no contact)", 1, "YlGnBu_r", 1
    ),
    "load": Coloring("vertex", "load_N", "contact load of a vertex (N)", 1, "magma_r", None),
    "stretch": Coloring("triangle", "stretch", "stretch of a triangle (%)", 100, "YlOrRd", None),
    "crossing": Coloring("vertex", "crossing", "1: vertex of a pair that crosses", 1, "YlOrRd", 1),
}
OF_A_START = ("body", "crossing")  # colours of a config, of which nothing is solved


def _values(frame: Frame, coloring: Coloring) -> np.ndarray:
    """[m, 3]: the field at the corners of every triangle. Raises UserError when the frame has none."""
    fields = frame.of_vertices if coloring.element == "vertex" else frame.of_triangles
    if coloring.key not in fields:
        raise UserError(
            f"this frame has no {coloring.key}: nothing is solved before the first step, and crossings are"
            " drawn of a config; choose a step or --color body"
        )
    values = np.asarray(fields[coloring.key], float) * coloring.factor
    return values[frame.triangles] if coloring.element == "vertex" else np.repeat(values[:, None], 3, axis=1)


def top_of(frame: Frame, color: str) -> float | None:
    """End of the scale of the colours of a frame; None for bodies, which have none."""
    if color == "body":
        return None
    coloring = COLORINGS[color]
    if coloring.top is not None:
        return coloring.top
    return float(_values(frame, coloring).max(initial=0.0))


def colors_of_corners(
    frame: Frame, color: str, top: float | None = None
) -> tuple[np.ndarray, Normalize | None]:
    """[m, 3, 3] colours of the corners, and the scale behind them (None for bodies). top: end of the scale,
    where it is that of more frames than this.
    """
    if color == "body":
        return np.repeat(palette(frame.of_triangles["body"])[:, None, :], 3, axis=1), None
    coloring = COLORINGS[color]
    values = _values(frame, coloring)
    scale = Normalize(0, (top_of(frame, color) if top is None else top) or 1)
    return plt.get_cmap(coloring.colors)(scale(values))[..., :3], scale


def palette(bodies: np.ndarray) -> np.ndarray:
    """[n, 3] colours of bodies by their number."""
    return np.array([to_rgb(c) for c in BODY_COLORS])[np.asarray(bodies) % len(BODY_COLORS)]


def annotate(fig, scene: dict, frame: Frame, color: str, scale: Normalize | None) -> None:
    """Legend of the bodies, or the bar of the colours."""
    axis = fig.axes[0]
    names = ", ".join(o["name"] for o in scene["obstacles"])
    named = []
    if scale is None:
        named = [(BODY_COLORS[i % len(BODY_COLORS)], name) for i, name in enumerate(scene["bodies"])]
    else:
        bar = ScalarMappable(scale, COLORINGS[color].colors)
        fig.colorbar(bar, ax=axis, label=COLORINGS[color].label, shrink=0.7, pad=0.01)
    if names:
        named.append((OBSTACLE_COLOR, f"{names} (analytic)"))
    if len(named) > 12:
        named[11:] = [("none", f"and {len(named) - 11} more")]
    patches = [Patch(color=color, label=label) for color, label in named]
    axis.legend(handles=patches, loc="upper left", frameon=False, fontsize=7)
