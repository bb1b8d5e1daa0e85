"""One figure: the main number of every claim that has one, with its interval and its threshold."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from .. import style
from .judge import Answer
from .verdict import HOLDS, NOT, ONLY_IF, OPEN

COLORS = {HOLDS: "#009E73", ONLY_IF: "#E69F00", NOT: "#D55E00", OPEN: "#888888"}
SHOWN = ("The main number of every claim that has one: a ratio (or what its line says), geometric mean and 95% interval over scenes, levels and jittered "
         "starts; a proof (diamond) has the range of its numbers. Black ticks: the thresholds of the rule; the verdict is that of the whole claim, which may have "
         "more parts (results/CLAIMS.md).")


def draw(answers: list[Answer], stem: Path) -> list[Path]:
    shown = [a for a in answers if a.main is not None]
    fig, axis = plt.subplots(figsize=(style.WIDE_IN, 0.6 + 0.24 * len(shown)), layout="constrained")
    rows = []
    for k, a in enumerate(shown):
        j, color = a.main, COLORS[a.verdict.verdict]
        axis.plot([j.lower, j.upper], [k, k], color=color, linewidth=1.6, solid_capstyle="butt")
        axis.plot([j.value], [k], marker="D" if j.proof else "o", color=color, linestyle="none")
        for bound in j.bounds:
            axis.plot([bound, bound], [k - 0.32, k + 0.32], color="black", linewidth=0.8)
        rows.append({"claim": a.claim.id, "verdict": a.verdict.verdict, "measures": j.measures, "value": j.value, "lower": j.lower, "upper": j.upper,
                     "threshold": j.threshold, "proof": j.proof})
    axis.set_xscale("symlog", linthresh=0.1) if any(j["lower"] <= 0 or min(a.main.bounds) < 0 for j, a in zip(rows, shown)) else axis.set_xscale("log")
    axis.set_yticks(range(len(shown)), [f"{a.claim.id}  {_short(a.main.measures)}" for a in shown])
    axis.set_ylim(len(shown) - 0.4, -0.6)
    axis.set_xlabel("number of the claim's first part")
    for verdict, color in COLORS.items():
        axis.plot([], [], color=color, marker="o", label=verdict)
    axis.plot([], [], color="black", marker="|", linestyle="none", label="threshold")
    fig.legend(loc="outside lower center", ncols=5, frameon=False)
    return style.save(fig, stem, pd.DataFrame(rows), SHOWN)


def _short(text: str, length: int = 78) -> str:
    return text if len(text) <= length else text[: length - 3] + "..."
