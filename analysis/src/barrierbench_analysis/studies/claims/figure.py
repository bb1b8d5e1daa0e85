"""One figure, a panel for each kind of number: the main number of every claim that has one, with its scenes,
its interval and its threshold.
"""

import textwrap
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.ticker import LogLocator, NullFormatter

from barrierbench_analysis.figures import style

from .judge import Answer
from .verdict import HOLDS, IN_PART, NOT, ONLY_IF, OPEN, Judged
from .words import interval

COLORS = {HOLDS: "#009E73", ONLY_IF: "#E69F00", IN_PART: "#0072B2", NOT: "#D55E00", OPEN: "#888888"}
# kind of number -> label of its axis, whether it is logarithmic
PANELS = {
    "ratio": ("ratio of two cases, geometric mean of scenes", True),
    "share": ("share (of scenes, of a climb, of a limit)", False),
    "slope": ("slope of log number over log level", False),
    "closed form": ("number of a closed form, range over its arguments", True),
}
OF_SCENE = {"marker": "o", "alpha": 0.45, "markeredgewidth": 0, "linestyle": "none"}
OF_PART = ("measures", "slice", "value", "lower", "upper", "threshold", "ends")
KINDS = {"ratio": "ratio", "at_equal_gap": "ratio", "outcomes": "share", "level": "share", "slope": "slope"}
SHOWN = (
    "The main number of every claim that has one, that of its first part, by kind of number. Light dots"
    " below: the scenes, each the mean of its levels; dot and bar: their mean with its 95% interval over"
    " scenes (Student's t); for shares of scenes in which every run gets through Wilson's interval and no"
    " dots; where a part asks for every run, or has a closed form (diamond), a bar from the least to the"
    " largest number. Black ticks: the threshold of the rule, or the share of the case that has to be beaten."
    " Squares, below their circles: the same number over the scenes of a confirmation, which no rule was"
    " tuned on. The colour of a circle is the exploratory verdict of the whole claim (or that of a closed"
    " form), that of a square the confirmed one; both may have more parts and other conditions"
    " (results/CLAIMS.md). Where steps are not asked to converge, the label has the residual of their ends."
)


def kind_of(j: Judged) -> str:
    return "closed form" if j.proof else KINDS[j.rule]


def _dots(j: Judged) -> list[float]:
    """Values of the scenes, where the number is their mean."""
    return [] if j.rule == "outcomes" else [value for _, value, *_ in j.per_scene]


def _number(axis, j: Judged, y: float, color: str, marker: str) -> None:
    """A number with its interval at the height y, its scenes a little below."""
    dots = _dots(j)
    axis.plot(dots, [y + 0.16] * len(dots), markersize=2.2, color=color, **OF_SCENE)
    if j.lower is not None:
        axis.plot([j.lower, j.upper], [y, y], color=color, linewidth=1.4, solid_capstyle="butt")
    axis.plot([j.value], [y], marker=marker, markersize=3.6, color=color, linestyle="none")


def _row(axis, k: int, a: Answer) -> dict:
    j, again = a.main, a.confirmed_main
    first = k if again is None else k - 0.2
    _number(axis, j, first, COLORS[a.verdict.verdict], "D" if j.proof else "o")
    text = f"{interval(j)}, asked {j.threshold}"
    if again is not None:
        _number(axis, again, k + 0.16, COLORS[a.confirmed.verdict], "s")
        text += f"\n{interval(again)}, confirmation"
    for bound in j.bounds:
        axis.plot([bound, bound], [k - 0.36, k + 0.36], color="black", linewidth=0.9)
    axis.annotate(text, (1.02, k), xycoords=("axes fraction", "data"), va="center", fontsize=5.5)
    return {
        "panel": kind_of(j),
        "claim": a.claim.id,
        "verdict": a.verdict.verdict,
        **{name: getattr(j, name) for name in OF_PART},
        "scenes": " ".join(f"{x:.4g}" for x in _dots(j)),
        "confirmed_verdict": a.confirmed.verdict if a.confirmed is not None else "",
        **{f"confirmed_{name}": getattr(again, name, None) for name in ("value", "lower", "upper")},
    }


def _panel(axis, kind: str, shown: list[Answer]) -> list[dict]:
    rows = [_row(axis, k, a) for k, a in enumerate(shown)]
    label, logarithmic = PANELS[kind]
    if logarithmic:
        axis.set_xscale("log")
        low, high = axis.get_xlim()
        axis.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5) if high / low < 100 else (1,), numticks=12))
        axis.xaxis.set_major_formatter("{x:g}" if high < 1e4 else axis.xaxis.get_major_formatter())
        axis.xaxis.set_minor_formatter(NullFormatter())
    names = [f"{a.claim.id}  {textwrap.fill(_label(a.main), 58)}" for a in shown]
    axis.set_yticks(range(len(shown)), names, fontsize=5.5)
    axis.set_ylim(len(shown) - 0.4, -0.6)
    axis.set_xlabel(label)
    return rows


def _label(j: Judged) -> str:
    return f"{j.says} ({j.ends})" if j.ends else j.says


def draw(answers: list[Answer], stem: Path) -> list[Path]:
    numbered = [a for a in answers if a.main is not None]
    by_kind = {kind: [a for a in numbered if kind_of(a.main) == kind] for kind in PANELS}
    by_kind = {kind: shown for kind, shown in by_kind.items() if shown}
    if not by_kind:
        return []
    heights = [len(shown) + 1.6 for shown in by_kind.values()]
    size = style.WIDE_IN, 0.5 + 0.34 * sum(heights)
    how = {"layout": "constrained", "height_ratios": heights, "squeeze": False}
    fig, axes = plt.subplots(len(by_kind), 1, figsize=size, **how)
    panels = zip(axes[:, 0], by_kind.items())
    rows = [row for axis, (kind, shown) in panels for row in _panel(axis, kind, shown)]
    style.letter_panels(axes[:, 0])
    first = axes[0, 0]
    for verdict, color in COLORS.items():
        first.plot([], [], color=color, marker="o", label=verdict)
    first.plot([], [], color="#888888", markersize=2.6, label="a scene", **OF_SCENE)
    first.plot([], [], color="#888888", marker="s", markersize=3.6, label="confirmation")
    first.plot([], [], color="black", marker="|", linestyle="none", label="threshold")
    fig.legend(loc="outside lower center", ncols=4, frameon=False)
    return style.save(fig, stem, pd.DataFrame(rows), SHOWN)
