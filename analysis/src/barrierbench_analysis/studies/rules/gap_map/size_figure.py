"""The figure of the log beside the cubic against the number of unknowns: a row a target, a line a scene."""

from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.figures.ticks import log_ticks
from barrierbench_analysis.io.errors import UserError

from .size import LIMIT, SHAPE, Size, by_size, drawn_sizes, thetas_of
from .size_tables import failed
from .table import Map

TITLE = "The log over the cubic against the number of unknowns"
METRICS = {
    "cond_p95": "cond, raw",
    "bj_p95": "cond, block Jacobi",
    "pcg": "PCG iterations",
    "newton": "Newton iterations",
}
# Scenes are no formulations: other colours and markers than those of style.LOOKS, dark enough for a line.
COLORS = ("#1b1b1b", "#c23b22", "#1f6fb4", "#7a3e9d", "#2e8b57", "#b8860b", "#d6509b", "#5f6a72")
LOOKS = tuple(zip(COLORS, "os^vDPX<"))
LEAST = 1.5  # over and under 1 that an axis shows at least
SHOWN = (
    "The log's numbers over the {shape}'s in the same scene with the same mesh and the same loads, no strain"
    " limit, against the number of unknowns. A line is a scene, a marker one of its meshes; a row is a target"
    " theta. Above 1 (grey) the log has the larger number. The rows of one column have the same axis."
    " cond: 95th percentile over iterations in contact; PCG: median of block-Jacobi PCG to 1e-6 on one"
    " right-hand side; Newton: iterations of the run. {failed}"
)


def _panel(axis, sizes: list[Size], metric: str, looks: dict[str, tuple[str, str]]) -> None:
    axis.axhline(1, color="#888888", linewidth=0.8, gid=style.REFERENCE, zorder=0)
    for scene, (color, marker) in looks.items():
        mine = sorted((s.unknowns, s.ratios[metric]) for s in sizes if s.scene == scene)
        x, y = [n for n, _ in mine], [ratio for _, ratio in mine]
        axis.plot(x, y, color=color, marker=marker, label=scene, markersize=3)


def _facts(sizes: list[Size]) -> Facts:
    unknowns, scenes = [s.unknowns for s in sizes], dict.fromkeys(s.scene for s in sizes)
    return Facts(
        f"{len(sizes)} pairs of runs in {len({s.place for s in sizes})} places",
        "ratio of two runs, no mean",
        f"the {SHAPE} in the same place under the same loads",
        f"scenes {', '.join(scenes)}; {min(unknowns)} to {max(unknowns)} unknowns; no strain limit",
    )


def draw(found: Map, stem: Path, width_in: float = style.WIDE_IN, title: str = TITLE) -> list[Path]:
    """The same files for the page of the map and for ./bench draw figure. Errors: UserError where no run of
    the log has one of the other shape beside it.
    """
    thetas, sizes = thetas_of(by_size(found.rows)), drawn_sizes(found.rows)
    if not sizes:
        raise UserError(f"nothing to draw: no run of the log beside one of {SHAPE}, limit {LIMIT}")
    looks = dict(zip(dict.fromkeys(s.scene for s in sizes), LOOKS))
    fig, axes = plt.subplots(
        len(thetas),
        len(METRICS),
        figsize=(width_in, 1.45 * len(thetas) + 0.8),
        layout="constrained",
        sharex=True,
        sharey="col",
        squeeze=False,
    )
    for row, theta in zip(axes, thetas):
        for axis, metric in zip(row, METRICS):
            axis.set(xscale="log", yscale="log")
            _panel(axis, [s for s in sizes if s.theta == theta], metric, looks)
        row[0].set_ylabel(f"theta {theta:g}\nlog over {SHAPE}")
    _axes(axes, sizes)
    handles, labels = axes[-1, 0].get_legend_handles_labels()
    fig.legend(handles, labels, loc="outside lower center", ncols=len(looks), frameon=False)
    numbers = [
        {"scene": s.scene, "resolution": s.resolution, "theta": s.theta, "unknowns": s.unknowns, **s.ratios}
        for s in sizes
    ]
    left = failed(found, thetas)
    left = left and f"Not drawn, since one of the two did not get through: {left}."
    shown = SHOWN.format(shape=SHAPE, failed=left).strip()
    return style.save(fig, stem, pd.DataFrame(numbers), f"{title}. {shown} {_facts(sizes).sentence()}")


def _axes(axes, sizes: list[Size]) -> None:
    """Titles, ticks and limits: every column holds its own numbers and 1."""
    low, high = min(s.unknowns for s in sizes) / 1.2, max(s.unknowns for s in sizes) * 1.2
    for k, (metric, title) in enumerate(METRICS.items()):
        ratios = [s.ratios[metric] for s in sizes]
        bottom, top = min(*ratios, 1 / LEAST) / 1.1, max(*ratios, LEAST) * 1.1
        axes[0, k].set_title(title)
        axes[-1, k].set_xlabel("unknowns")
        axes[0, k].set_ylim(bottom, top)
        for axis in axes[:, k]:
            log_ticks(axis.yaxis, bottom, top, 5)
            axis.set_xlim(low, high)
            log_ticks(axis.xaxis, low, high, 4)
