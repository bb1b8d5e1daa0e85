"""rho(u) of the shapes that searches found, beside those of the program."""

import re
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from barrierbench_analysis.figures import style

from . import shape

DRAWN = re.compile(
    r"(log|cubic|exponential|minimax)(:8| \(.*)?"
)  # of the program: of an exponent one is enough
COLOURS = ("#000000", "#D55E00", "#CC79A7", "#56B4E9")  # of searches
SHOWN = (
    "Relative stiffness rho = d_hat b''/|b'| over the gap: stiffness of a contact for its load. Thick: best"
    " shapes (full) and centres of the draws (dashed) of the searches for the fewest Newton iterations; thin:"
    " shapes of the program. Between the dotted lines 5 % to 95 % of the load of the steps rests, the widest"
    " range over steps."
)


def _line(axis, one, color: str, **how) -> None:
    axis.plot(shape.CURVE, one.rho, color=color, label=one.label, **how)


def draw(curves: dict, stem: Path) -> list[Path]:
    """curves: known and found shapes (report.Found). stem: of the files."""
    fig, axis = plt.subplots(figsize=(style.WIDE_IN, 4.0), layout="constrained")
    for one in curves["known"]:
        if (drawn := DRAWN.fullmatch(one.label)) and one.label != "minimax:8":
            look = style.look(drawn[1])
            _line(axis, one, look.color, linestyle=look.dash, linewidth=1.0)
    for k, one in enumerate(curves["found"]):
        dash = "-" if one.label.endswith("best") else (0, (4, 1))
        _line(axis, one, COLOURS[k // 2 % len(COLOURS)], linestyle=dash, linewidth=2.0, alpha=0.8)
    for one in curves["found"][:1]:
        for u in one.rests:
            axis.axvline(u, color="#666666", linewidth=0.6, linestyle=":", gid=style.REFERENCE)
    axis.set(
        xscale="log", yscale="log", xlabel=r"$u=d/\hat d$", ylabel=r"$\rho=\hat d\,b''/|b'|$", ylim=(1, 400)
    )
    style.legend_below(fig, axis)
    every = [*curves["known"], *curves["found"]]
    tables = [pd.DataFrame({"shape": one.label, "u": shape.CURVE, "rho": one.rho}) for one in every]
    return style.save(fig, stem.with_suffix(""), pd.concat(tables, ignore_index=True), SHOWN)
