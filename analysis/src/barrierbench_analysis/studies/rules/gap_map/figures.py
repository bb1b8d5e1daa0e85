"""The figures of a gap map: cost against reached gap, by limit mode, and the area law against what was
measured.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.ticks import log_ticks
from barrierbench_analysis.program.start import evaluated
from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.tables.outcomes import OK

from . import size_figure
from .compare import Lines, counted_once, lines, runs_of
from .law import FAR, MADE, pairs, sentences
from .page import TITLES
from .size import drawn_sizes
from .size_figure import METRICS
from .spec import LIMITS, REFERENCE
from .table import NOT_RUN, Map

COLUMN_IN = 2.45  # of one limit mode, on the page of the study
SHOWN = (
    "What a run takes against the gap that its contacts reach: the load-weighted median of d/d_hat at step"
    " ends, deeper to the right. A marker is a target theta ({gaps}), geometric mean over scenes ({scenes}),"
    " their resolutions averaged.{once} All markers of a column are of the same places (a scene at a"
    " resolution): those in which every shape drawn here got through at every target of its line, {places};"
    " lines end where less than half of the places would be left, or at the last target that a shape can"
    " reach. Thin lines: each place alone, as far as it was reached. Markers of the same number along two"
    " lines carry the same loads. All numbers are over those of the log at its first target in the same"
    " place. Dotted, in the first row, where the limit does not follow theta: the area law, C rho(u) but not"
    " below 1, with one C in a panel, from the deepest point of the log. cond: 95th percentile over"
    " iterations in contact; PCG: median of block-Jacobi PCG to 1e-6 on one right-hand side. {modes}"
)
LAW = (
    "The area law against what was measured. A point is a run beside that of the log in the same scene,"
    " resolution, limit mode and theta, so under the same loads. Up: the ratio of cond at step ends (median"
    " over steps). (a) Across: the ratio of rho at the median gaps that both reached. Filled: contact makes"
    " the largest eigenvalue in both (cond at least {made:g} times that without contact). (b) Across: the"
    " same, but not below the ratio that is left without contact. Filled: contact makes the log's. Lines:"
    " equal, and a factor {far:g} off. Of all shapes, those of the other figure too. {sentence}"
)


def _over(found: Map, limit: str, metric: str):
    """What a number of a row is divided by: the log's at its first target in the same place."""
    logs = [r for of in runs_of(found.rows, limit, REFERENCE).values() for r in of]
    first = {
        (r["scene"], r["resolution"]): r[metric]
        for r in logs
        if r["theta"] == max(found.gaps) and r["outcome"] == OK
    }
    return lambda row: first.get((row["scene"], row["resolution"]))


def _rho(found: Map, shape: str, gaps: list[float]) -> list[float]:
    of = next(one for one in found.about["shapes"] if one["label"] == shape)
    query = {"kind": "rho", "shape": of["shape"], "argument": of["argument"]}
    return [answer["rho"] for answer in evaluated([{**query, "u": u} for u in gaps])]


def _law(axis, found: Map, drawn: Lines) -> None:
    """One constant, from the deepest point of the log; every shape over the gaps that it reaches."""
    log = drawn.of.get(REFERENCE)
    if not log:
        return
    deep = min(log, key=lambda p: p.gap)
    scale = deep.value / _rho(found, REFERENCE, [deep.gap])[0]
    for shape, steps in drawn.of.items():
        if len(steps) > 1:
            reached = [p.gap for p in steps]
            gaps = list(np.geomspace(min(reached), max(reached), 40))
            law = [max(1.0, scale * rho) for rho in _rho(found, shape, gaps)]
            color = style.look(shape).color
            axis.plot(gaps, law, color=color, linestyle=":", linewidth=1.0, gid=style.REFERENCE)


def _series(axis, drawn: Lines, shape: str) -> None:
    look, points = style.look(shape), drawn.of[shape]
    for line in drawn.thin[shape].values():
        axis.plot([x for x, _ in line], [y for _, y in line], color=look.color, linewidth=0.4, alpha=0.35)
    axis.plot(
        [p.gap for p in points],
        [p.value for p in points],
        color=look.color,
        linestyle=look.dash,
        marker=look.marker,
        markeredgewidth=0.8,
        label=shape,
    )


def _numbers(drawn: Lines, limit: str, metric: str) -> list[dict]:
    of = {"places": len(drawn.whole), "places_run": len(drawn.run)}
    return [
        {"limit": limit, "shape": shape, "metric": metric, **vars(step), **of}
        for shape, steps in drawn.of.items()
        for step in steps
    ]


def _span(values: list[float], least: float) -> tuple[float, float]:
    low, high = min(values), max(values)
    room = max(1.15, (least / (high / low)) ** 0.5)
    return low / room, high * room


def _part(found: Map) -> str:
    """Of which runs a figure is, behind a blank; empty where all are there."""
    left = found.counts()[NOT_RUN]
    words = "cells are not run yet; resolution: runs that are there, of those that can be:"
    return f" {left} of {len(found.rows)} {words} {found.extent()}." if left else ""


def _fit_y(axis) -> None:
    """Holds 1 and every number that is drawn, over a factor 3 at least."""
    shown = [line for line in axis.lines if line.get_gid() != style.REFERENCE]
    low, high = _span([1.0, *(float(y) for line in shown for y in line.get_ydata())], 3.0)
    axis.set_ylim(low, high)
    log_ticks(axis.yaxis, low, high)


def _panel(axis, found: Map, limit: str, shapes: list[str], metric: str) -> list[dict]:
    """One metric in one limit mode, with the law where it is of the first metric and the limit does not
    follow theta; the numbers.
    """
    axis.set(xscale="log", yscale="log")
    over = _over(found, limit, metric)
    drawn = lines(found.rows, limit, shapes, metric, over)
    for shape in shapes:
        _series(axis, drawn, shape)
    if metric == next(iter(METRICS)):
        axis.set_title(TITLES[limit], fontsize=8)
        if limit != "on":
            _law(axis, found, drawn)
    axis.axhline(1, color="#666666", linewidth=0.5, gid=style.REFERENCE)
    _fit_y(axis)
    return _numbers(drawn, limit, metric)


def _legend(fig, axis) -> None:
    """Shapes, and the law."""
    handles, labels = axis.get_legend_handles_labels()
    handles.append(plt.Line2D([], [], color="#444444", linestyle=":", linewidth=1.0))
    fig.legend(handles, [*labels, "area law"], loc="outside lower center", ncols=6, frameon=False)


def _shown(found: Map, numbers: list[dict]) -> str:
    modes = " ".join(
        f"{TITLES[m][0].upper()}{TITLES[m][1:]}: {LIMITS[m]}." for m in found.limits if LIMITS[m] != TITLES[m]
    )
    of = {n["limit"]: (n["places"], n["places_run"]) for n in numbers}
    places = "; ".join(f"{n} of {run} ({TITLES[limit]})" for limit, (n, run) in of.items())
    return SHOWN.format(
        once=counted_once(found.scenes),
        scenes=", ".join(found.scenes),
        gaps=", ".join(f"{gap:g}" for gap in found.gaps),
        modes=modes,
        places=places or "none",
    )


def draw_map(found: Map, shapes: list[str], stem: Path, width_in: float | None = None) -> list[Path]:
    """width_in: of the figure; None: what the modes of its page need."""
    limits = found.limits
    fig, axes = plt.subplots(
        len(METRICS),
        len(limits),
        figsize=(width_in or max(style.WIDE_IN, COLUMN_IN * len(limits)), 1.75 * len(METRICS) + 0.6),
        layout="constrained",
        sharex=True,
        squeeze=False,
    )
    numbers = []
    for k, (metric, title) in enumerate(METRICS.items()):
        for axis, limit in zip(axes[k], limits):
            numbers += _panel(axis, found, limit, shapes, metric)
        axes[k, 0].set_ylabel(f"{title}\nover the log's at first")
    gaps = [gap for line in (one for axis in axes.flat for one in axis.lines) for gap in line.get_xdata()]
    low = min([gap for gap in gaps if 0 < gap < 1] or [1e-3]) / 1.3
    axes[0, 0].set_xlim(1.0, low)
    for axis in axes[-1]:
        log_ticks(axis.xaxis, low, 1.0, 7 if len(limits) < 3 else 5)
        axis.set_xlabel(r"reached gap / $\hat d$ (deeper to the right)")
    _legend(fig, axes[0, 0])
    return style.save(fig, stem, pd.DataFrame(numbers), (_shown(found, numbers) + _part(found)).strip())


def _draw_pairs(axis, of: list, shapes: list[str], predicted, made) -> None:
    """Measured against predicted; full where `made` says that contact made the end of the spectrum."""
    for shape in (s for s in shapes if any(p.row["shape"] == s for p in of)):
        look = style.look(shape)
        for full in (False, True):
            some = [p for p in of if p.row["shape"] == shape and made(p) == full]
            axis.plot(
                [predicted(p) for p in some],
                [p.measured for p in some],
                linestyle="none",
                marker=look.marker,
                color=look.color,
                alpha=0.85 if full else 0.4,
                markerfacecolor=look.color if full else "none",
                markeredgewidth=0.6,
                label=shape if full else None,
            )


def _law_numbers(of: list) -> pd.DataFrame:
    columns = ["pair", "predicted", "predicted_p05", "floor", "measured", "made", "made_log"]
    rows = [[p.name, p.predicted, p.predicted_p05, p.floor, p.measured, *p.made] for p in of]
    return pd.DataFrame(rows, columns=columns)


def draw_law(found: Map, shapes: list[str], stem: Path) -> list[Path]:
    """The points are of `shapes`; what the caption says of the law is of all shapes, as on the page."""
    every = pairs(found.rows)
    of = [p for p in every if p.row["shape"] in shapes]
    forms = (
        ("law", lambda p: p.predicted, lambda p: p.by_contact),
        ("law with its floor", lambda p: p.floored, lambda p: p.by_log),
    )
    fig, axes = plt.subplots(
        1, 2, figsize=(style.WIDE_IN, 3.7), layout="constrained", sharex=True, sharey=True
    )
    low, high = _span([0.5, 2.0] + [v for p in of for v in (p.predicted, p.measured)], 10.0)
    for axis, (title, predicted, made) in zip(axes, forms):
        axis.set(xscale="log", yscale="log", xlabel="predicted", title=title)
        _draw_pairs(axis, of, shapes, predicted, made)
        for factor, width in ((1, 0.8), (FAR, 0.4), (1 / FAR, 0.4)):
            ends = [low, high], [factor * low, factor * high]
            axis.plot(*ends, color="#666666", linewidth=width, gid=style.REFERENCE, zorder=0)
        axis.set(xlim=(low, high), ylim=(low, high))
        log_ticks(axis.xaxis, low, high)
        log_ticks(axis.yaxis, low, high)
    axes[0].set_ylabel("measured: ratio of cond to the log's")
    style.letter_panels(axes)
    handles, labels = axes[0].get_legend_handles_labels()
    handles.append(plt.Line2D([], [], color="#444444", marker="o", markerfacecolor="none", linestyle="none"))
    fig.legend(handles, [*labels, "not made by contact"], loc="outside lower center", ncols=4, frameon=False)
    caption = LAW.format(made=MADE, far=FAR, sentence=" ".join(sentences(found.rows))) + _part(found)
    return style.save(fig, stem, _law_numbers(of), caption)


def draw(study: Study, rows: list[Row], numbers: dict, folder: Path) -> list[Path]:
    """The figures of the page."""
    return draw_all(numbers["map"], folder)


def draw_all(found: Map, folder: Path, width_in: float | None = None) -> list[Path]:
    """gap_map and gap_law, each with _more where there are more shapes than one figure holds, and gap_size;
    all their files. width_in: as in draw_map. The program evaluates rho.
    """
    folder.mkdir(parents=True, exist_ok=True)
    rest = [s for s in found.shapes if s not in found.main]
    paths = draw_map(found, list(found.main), folder / "gap_map", width_in)
    if rest:
        paths += draw_map(found, [REFERENCE, *rest], folder / "gap_map_more", width_in)
        paths += draw_law(found, rest, folder / "gap_law_more")
    paths += draw_law(found, list(found.main), folder / "gap_law")
    return paths + (size_figure.draw(found, folder / "gap_size") if drawn_sizes(found.rows) else [])
