"""The log over the cubic: condition numbers and iterations of every pair of runs, by place and theta."""

import textwrap
from collections.abc import Iterable, Mapping
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.figures.ticks import log_ticks
from barrierbench_analysis.tables.answer import RATIOS, Pair, log_over_cubic
from barrierbench_analysis.tables.words import counted

STEM = "answer"
WIDTH_IN = 5.0  # its text can be read on a telephone
MOST_PLACES = 12  # that have a line of their own; more pairs stand against the number of unknowns
LABEL_WIDTH = 20  # characters of a line of the name of a place
LEAST = 2  # over and under 1 that an axis shows at least
THETAS = ("o", "s", "^", "v", "D", "P", "X")  # markers, the largest theta first
COLOURS = ("#1b1b1b", "#1f6fb4", "#c23b22", "#7a3e9d", "#2e8b57", "#b8860b", "#5f6a72")
SHOWN = (
    "The log's numbers over the cubic's in the same place: left of 1 the log has the smaller number. A marker"
    " is a pair of runs; hollow: its record calls the two not comparable, since their contacts rest at other"
    " gaps. cond: median over the diagnosed Newton iterations; PCG: median of block-Jacobi PCG on their"
    " matrices, to 1e-6; Newton: iterations of the run."
)


def _thetas(pairs: list[Pair]) -> dict[float | None, tuple[str, str]]:
    """theta -> marker and colour, the largest first; None: stiffness as given."""
    names = sorted({pair.theta for pair in pairs}, key=lambda theta: -(theta or 0))
    return {name: (THETAS[k % len(THETAS)], COLOURS[k % len(COLOURS)]) for k, name in enumerate(names)}


def _label(theta: float | None) -> str:
    return "stiffness as given" if theta is None else f"theta {theta:g}"


def _draw(axis, pairs: list[Pair], key: str, heights: list[float], looks: dict) -> None:
    axis.axvline(1, color="#888888", linewidth=0.8, gid=style.REFERENCE, zorder=0)
    for pair, height in zip(pairs, heights):
        marker, colour = looks[pair.theta]
        face = colour if pair.is_comparable else "none"
        if (ratio := pair.ratios.get(key)) is not None:
            axis.plot([ratio], [height], marker, color=colour, markerfacecolor=face, markersize=5)


def _limits(axis, pairs: list[Pair], key: str) -> None:
    found = [pair.ratios[key] for pair in pairs if key in pair.ratios]
    low, high = min([*found, 1 / LEAST]) / 1.15, max([*found, LEAST]) * 1.15
    axis.set(xscale="log", xlim=(low, high), title=RATIOS[key][0])
    log_ticks(axis.xaxis, low, high, 5)


def _heights(axis, pairs: list[Pair]) -> list[float]:
    """Where each pair stands on the vertical axis, which is named by the way: its place, or its unknowns."""
    places = list(dict.fromkeys(pair.place for pair in pairs))
    if len(places) > MOST_PLACES:
        axis.set(yscale="log", ylabel="unknowns")
        return [float(pair.unknowns or np.nan) for pair in pairs]
    axis.set_yticks(range(len(places)), [textwrap.fill(place, LABEL_WIDTH) for place in places])
    axis.set_ylim(len(places) - 0.5, -0.5)
    return [float(places.index(pair.place)) for pair in pairs]


def _facts(pairs: list[Pair]) -> str:
    sizes = [pair.unknowns for pair in pairs if pair.unknowns is not None]
    span = f"{min(sizes)} to {max(sizes)} unknowns" if sizes else "unknowns not recorded"
    apart = sum(not pair.is_comparable for pair in pairs)
    thetas = ", ".join(map(_label, _thetas(pairs)))
    return Facts(
        f"{counted(len(pairs), 'pair')} of runs, {apart} of them not comparable",
        "ratio of two runs, no mean",
        "the fixed cubic in the same place",
        f"{thetas}; {span}",
    ).sentence()


def figure(rows: Iterable[Mapping], out: Path) -> list[Path]:
    """answer.png and its companions in `out`; empty where no fixed log stands beside a fixed cubic. rows: of
    `runs`, `run` being the folder of each below one root.
    """
    rows = list(rows)
    pairs = log_over_cubic(rows)
    if not pairs:
        return []
    looks, count = _thetas(pairs), min(len({pair.place for pair in pairs}), MOST_PLACES)
    fig, axes = plt.subplots(
        2, 2, figsize=(WIDTH_IN, 1.5 + 0.5 * count), layout="constrained", sharey=True, squeeze=False
    )
    heights = _heights(axes[0, 0], pairs)
    for axis, key in zip(axes.flat, RATIOS):
        _draw(axis, pairs, key, heights, looks)
        _limits(axis, pairs, key)
    for axis in axes[-1]:
        axis.set_xlabel("log / cubic")
    if len(looks) > 1:
        handles = [
            plt.Line2D([], [], marker=mark, color=colour, linestyle="none", label=_label(theta))
            for theta, (mark, colour) in looks.items()
        ]
        fig.legend(handles=handles, loc="outside lower center", ncols=min(4, len(handles)), frameon=False)
    numbers = pd.DataFrame(
        [
            {"place": p.place, "theta": p.theta, "unknowns": p.unknowns, "comparable": p.is_comparable}
            | {key: p.ratios.get(key) for key in RATIOS}
            for p in pairs
        ]
    )
    return style.save(fig, out / STEM, numbers, f"{SHOWN} {_facts(pairs)}", pd.DataFrame(rows))
