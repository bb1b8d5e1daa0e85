"""The one figure of the study: log over cubic against the number of unknowns, five numbers, two targets."""

import math
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.figures.ticks import log_ticks
from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.tables.statistics import Ratio, geometric, ratio_over

from .pairs import Rows, Where

PANELS = {
    "cond_p95": ("cond, raw", "diagnosed"),
    "bj_p95": ("cond, block Jacobi", "diagnosed"),
    "pcg": ("PCG iterations", "diagnosed"),
    "velocity_newton": ("Newton iterations", "diagnosed"),
    "velocity_seconds": ("seconds", "pcg"),
}
SIZES = ("XS", "S", "M", "L")
THETAS = {"0.1": "#1f6fb4", "0.01": "#c23b22"}
COLUMNS = 3
LEAST = 1.5  # over and under 1 that an axis shows at least
TITLE = "The log over the cubic, calibrated to the same load, against the number of unknowns"
SHOWN = (
    "A thin line is a scene, its points are its meshes; a bar is the geometric mean over the scenes of a"
    " size with its 95% interval. Above 1 (grey) the log has the larger number. cond: 95th percentile over"
    " diagnosed iterates in contact (every tenth of a step, beginning with its first); PCG: median of"
    " block-Jacobi PCG to 1e-6 on one right-hand side; Newton and seconds: until no vertex moves by more than"
    " 1e-4 d_hat."
)


def _points(rows: Rows, metric: str, theta: str, measure: str) -> list[dict]:
    found = []
    for size in SIZES:
        where = Where(size, theta, measure=measure)
        unknowns = {s: two[0].unknowns for s, two in rows.pairs(where).items()}
        logs = rows.logs(metric, where)
        found += [
            {"scene": s, "size": size, "unknowns": unknowns[s], "theta": theta, "metric": metric, "ln": v}
            for s, v in logs.items()
        ]
    return found


def _means(points: pd.DataFrame) -> list[tuple[float, Ratio]]:
    """(geometric mean of the unknowns, mean of the ratio) of each size."""
    return [
        (geometric(of.unknowns), ratio_over(list(of.ln)))
        for size in SIZES
        if len(of := points[points["size"] == size]) > 0
    ]


def _panel(axis, points: pd.DataFrame) -> None:
    axis.axhline(1, color="#888888", linewidth=0.8, gid=style.REFERENCE, zorder=0)
    for theta, color in THETAS.items():
        mine = points[points.theta == theta]
        for _, of in mine.groupby("scene", sort=False):
            ratios = [math.exp(v) for v in of.ln]
            axis.plot(of.unknowns, ratios, color=color, linewidth=0.5, alpha=0.55, marker=".", markersize=2)
        shift = 0.93 if theta == "0.1" else 1.07
        for x, mean in _means(mine):
            ends = [[mean.value - mean.lower], [mean.upper - mean.value]] if mean.lower else None
            axis.errorbar(
                [x * shift], [mean.value], ends, color=color, fmt="s", markersize=4, capsize=2.5, zorder=3
            )


def draw(study: Study, rows: list[Row], numbers: dict, folder: Path) -> list[Path]:
    """Its files; none before there is a pair of runs."""
    of = Rows(study, rows)
    points = pd.DataFrame(
        [
            p
            for metric, (_, how) in PANELS.items()
            for theta in THETAS
            for p in _points(of, metric, theta, how)
        ]
    )
    if points.empty:
        return []
    panels = {metric: title for metric, (title, _) in PANELS.items() if (points.metric == metric).any()}
    rows_of = math.ceil(len(panels) / COLUMNS)
    size_in = style.WIDE_IN, 2.1 * rows_of + 0.4
    fig, grid = plt.subplots(rows_of, COLUMNS, figsize=size_in, layout="constrained", squeeze=False)
    axes = list(grid.flat)
    for axis in axes[len(panels) :]:
        axis.set_axis_off()
    low, high = points.unknowns.min() / 1.4, points.unknowns.max() * 1.4
    for axis, (metric, title) in zip(axes, panels.items()):
        mine = points[points.metric == metric]
        axis.set(xscale="log", yscale="log", title=title, xlabel="unknowns", xlim=(low, high))
        _panel(axis, mine)
        ratios = [math.exp(v) for v in mine.ln]
        bottom, top = min(*ratios, 1 / LEAST) / 1.1, max(*ratios, LEAST) * 1.1
        axis.set_ylim(bottom, top)
        log_ticks(axis.yaxis, bottom, top, 5)
        log_ticks(axis.xaxis, low, high, 3)
    for axis in grid[:, 0]:
        axis.set_ylabel("log over cubic")
    handles = [plt.Line2D([], [], color=c, marker="s", label=f"theta {t}") for t, c in THETAS.items()]
    fig.legend(handles=handles, loc="outside lower center", ncols=2, frameon=False)
    style.letter_panels(axes[: len(panels)])
    sizes = f"{points.unknowns.min()} to {points.unknowns.max()} unknowns; no strain limit"
    facts = Facts(
        f"{len(points)} ratios of two runs each",
        "95% interval of Student's t over scenes",
        "the cubic in the same scene, whose loads and gaps then differ (results/AT_SIZE.md)",
        f"scenes {', '.join(dict.fromkeys(points.scene))}; {sizes}",
    )
    points["ratio"] = [math.exp(v) for v in points.ln]
    return style.save(fig, folder / "at_size", points, f"{TITLE}. {SHOWN} {facts.sentence()}")
