"""What colours mean in a player: fields, units, ends of their scales and colour maps; the same scale for all
films of a page, so that equal colours are equal values.
"""

from dataclasses import dataclass

import matplotlib
import numpy as np
from matplotlib.colors import to_hex

from barrierbench_analysis.figures.pictures.film import Film

STOPS = 33  # colours of a map; between them the page interpolates
NOT_COMPUTED = "#8a8a8a"  # before the first step, and rods where the field is one of triangles
SHARE = 99.0  # percentile of the positive values where an open scale ends: one peak does not hide all others


@dataclass(frozen=True)
class Field:
    """A field of a film. `top` None: the scale ends at a percentile of what is there."""

    array: str  # attribute of Film
    element: str  # vertex or triangle
    label: str
    unit: str
    factor: float
    colour_map: str
    top: float | None


FIELDS = {
    "gap": Field("gap_rel", "vertex", "smallest gap (1: no contact)", "d_hat", 1, "YlGnBu_r", 1.0),
    "stretch": Field("stretch", "triangle", "stretch of a triangle", "%", 100, "YlOrRd", None),
    "force": Field("force_N", "vertex", "contact force on a vertex", "N", 1, "magma_r", None),
}
COLOURS = (*FIELDS, "body")


def top_of(films: list[Film], field: Field) -> tuple[float, bool]:
    """Where the scale ends, in the unit of the field, and whether there are values above."""
    if field.top is not None:
        return field.top, False
    values = np.concatenate([getattr(film, field.array).ravel() for film in films]).astype(float)
    values = field.factor * values[np.isfinite(values)]
    positive = values[values > 0]
    if not positive.size:
        return 1.0, False
    top = float(f"{np.percentile(positive, SHARE):.2g}")
    return top, bool(positive.max() > top)


def longest_arrow(films: list[Film]) -> float:
    """N, of the longest arrow; forces beyond it have its length. 0 where no frame has forces."""
    arrows = [film.arrows_N for film in films if film.arrows_N is not None]
    sizes = np.concatenate([np.zeros(0), *(np.linalg.norm(of, axis=-1).ravel() for of in arrows)])
    positive = sizes[np.isfinite(sizes) & (sizes > 0)]
    return float(f"{np.percentile(positive, SHARE):.2g}") if positive.size else 0.0


def scale(films: list[Film], name: str) -> dict:
    """What the page has to know of a field: label, unit, scale, and its colours from the low end."""
    field = FIELDS[name]
    top, above = top_of(films, field)
    colours = matplotlib.colormaps[field.colour_map](np.linspace(0, 1, STOPS))
    words = {name: getattr(field, name) for name in ("element", "label", "unit", "factor")}
    return words | {"top": top, "above": above, "colours": [to_hex(colour) for colour in colours]}
