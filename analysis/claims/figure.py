"""One figure: the main number of every claim that has one, with its interval and its threshold."""

from __future__ import annotations

import textwrap
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from .. import style
from .judge import Answer
from .report import interval
from .verdict import HOLDS, NOT, ONLY_IF, OPEN, Judged

COLORS = {HOLDS: "#009E73", ONLY_IF: "#E69F00", NOT: "#D55E00", OPEN: "#888888"}
RANGE = (0.1, 100.0)  # what is beyond is an arrow at the edge
SHOWN = ("The main number of every claim that has one, that of its first part: a ratio (or what its line says), geometric mean and 95% interval over scenes, levels "
         "and jittered starts; a proof (diamond) has the range of its numbers. Black ticks: the thresholds of the rule; an arrow: beyond the axis. The colour is the "
         "verdict of the whole claim, which may have more parts and other conditions (results/CLAIMS.md). Where steps are not asked to converge, the label has the residual of "
         "their ends.")


def _inside(x: float) -> float:
    return min(max(x, RANGE[0]), RANGE[1])


def _marker(j: Judged) -> str:
    if j.value > RANGE[1]:
        return ">"
    return "<" if j.value < RANGE[0] else "D" if j.proof else "o"


def _row(axis, k: int, a: Answer) -> dict:
    j, color = a.main, COLORS[a.verdict.verdict]
    axis.plot([_inside(j.lower), _inside(j.upper)], [k, k], color=color, linewidth=1.8, solid_capstyle="butt")
    axis.plot([_inside(j.value)], [k], marker=_marker(j), color=color, linestyle="none", clip_on=False)
    for bound in j.bounds:
        if RANGE[0] <= bound <= RANGE[1]:
            axis.plot([bound, bound], [k - 0.36, k + 0.36], color="black", linewidth=0.9)
    axis.annotate(f"{interval(j)}, asked {j.threshold}", (1.03, k), xycoords=("axes fraction", "data"), va="center", fontsize=6)
    return {"claim": a.claim.id, "verdict": a.verdict.verdict, "measures": j.measures, "value": j.value, "lower": j.lower, "upper": j.upper,
            "threshold": j.threshold, "proof": j.proof, "ends": j.ends}


def _says(j: Judged) -> str:
    return f"{j.says} ({j.ends})" if j.ends else j.says


def draw(answers: list[Answer], stem: Path) -> list[Path]:
    shown = [a for a in answers if a.main is not None]
    fig, axis = plt.subplots(figsize=(style.WIDE_IN, 0.6 + 0.26 * len(shown)), layout="constrained")
    rows = [_row(axis, k, a) for k, a in enumerate(shown)]
    axis.set_xscale("log")
    axis.set_xlim(*RANGE)
    axis.set_yticks(range(len(shown)), [f"{a.claim.id}  {_wrapped(_says(a.main))}" for a in shown], fontsize=6)
    axis.set_ylim(len(shown) - 0.4, -0.6)
    axis.set_xlabel("number of the claim's first part")
    for verdict, color in COLORS.items():
        axis.plot([], [], color=color, marker="o", label=verdict)
    axis.plot([], [], color="black", marker="|", linestyle="none", label="threshold")
    fig.legend(loc="outside lower center", ncols=5, frameon=False)
    return style.save(fig, stem, pd.DataFrame(rows), SHOWN)


def _wrapped(text: str, width: int = 52) -> str:
    return "\n".join(textwrap.wrap(text, width))
