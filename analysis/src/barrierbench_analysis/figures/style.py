"""One look for every figure: a formulation has one colour, one marker and one dash across the project."""

from __future__ import annotations

import base64
import colorsys
import io
import logging
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.colors import to_hex, to_rgb  # noqa: E402

from barrierbench_analysis.io.whole_file import write_figure, write_whole  # noqa: E402
from barrierbench_analysis.tables.run_words import hollow_rule, name_of, verdict_word  # noqa: E402

from . import own_math, pgfplots  # noqa: E402
from .captions import caption  # noqa: E402
from .ticks import make_readable  # noqa: E402

if TYPE_CHECKING:  # stills and pages take looks from here, and start without pandas
    import pandas as pd

NARROW_IN, WIDE_IN = 3.33, 7.0
LEGEND_COLUMN_IN = 2.3  # the longest series with its verdict
LEAST_SPAN = 0.25  # of the largest value: a linear axis never shows less
LEAST_RATIO = 2.0  # a logarithmic axis never shows less
WITH_MARGINS = 1.1  # the span of an axis over that of its data: no marker is cut
REFERENCE = "reference"  # marks lines that are no data
MARKERS = (
    "A formulation has one colour and one marker in every figure; {hollow} A cross ends the line of a run"
    " that failed; the legend has its outcome."
)
FAILURE = "failure"  # gid of that cross
SUFFIXES = (".png", ".pdf", ".csv", ".txt", ".svg", ".dat")  # of the files of a figure

own_math.install()
logging.getLogger("fontTools").setLevel(logging.ERROR)  # it comments on the missing date of the PDF

plt.rcParams.update(
    {f"{name}.labelsize": 7 for name in ("xtick", "ytick")}
    | {f"axes.spines.{side}": False for side in ("top", "right")}
    | {"font.size": 8, "axes.titlesize": 8, "axes.labelsize": 8, "legend.fontsize": 7}
    | {
        "lines.linewidth": 1.0,
        "lines.markersize": 3.5,
        "axes.grid": True,
        "grid.linewidth": 0.3,
        "grid.alpha": 0.6,
    }
    | {"pdf.fonttype": 42, "svg.fonttype": "none", "svg.hashsalt": "barrierbench", "savefig.dpi": 200}
)


@dataclass(frozen=True)
class Look:
    color: str
    marker: (
        str | tuple[int, int, int]
    )  # of matplotlib: a letter, or a star of so many points (points, 1, angle)
    dash: object

    def line(self, **more) -> dict:
        """What matplotlib draws its lines with, and more."""
        return {"color": self.color, "marker": self.marker, "linestyle": self.dash} | more


# Okabe-Ito colours.
LOOKS = {
    "log": Look("#0072B2", "o", "-"),
    "quadratic": Look("#E69F00", "s", "--"),
    "cubic": Look("#009E73", "^", "-."),
    "cubic_dynamic": Look("#D55E00", "D", (0, (5, 1))),
    "cubic_dynamic_lagged": Look("#CC79A7", "v", (0, (3, 1, 1, 1))),
    "cubic_dynamic_consistent": Look("#332288", "*", (0, (4, 1, 2, 1))),
    "cubic_dynamic_consistent_scaled": Look("#882255", "p", (0, (2, 1, 4, 1))),
    "ipc2020": Look("#56B4E9", "P", ":"),
    "log_squared": Look("#000000", "X", (0, (1, 1))),
    "two_stage": Look("#A6761D", "<", (0, (5, 2, 1, 2))),
    "exponential": Look("#CC3311", "H", (0, (7, 1, 1, 1))),
    "minimax": Look("#117733", (4, 1, 0), (0, (6, 1, 1, 1, 1, 1))),
    "minimax_bounded": Look("#6699CC", (3, 1, 0), (0, (6, 3))),
    "log_of_square": Look("#44AA99", "d", (0, (3, 1))),
    "cubic_of_square": Look("#AA4499", "8", (0, (1, 1, 3, 1))),
    "article_cubic": Look("#999999", ">", "-."),
    "quadratic_as_printed": Look("#8B4513", "h", "--"),
}


# Of the second, third, ... run of one formulation in a figure; then they start again with other shades.
VARIANT_DASHES = ((0, (1, 2)), (0, (6, 2, 1, 1)), (0, (8, 2)), (0, (2, 1)), (0, (4, 1, 1, 1, 1, 1)))
VARIANT_LIGHTNESS = (0.0, 0.22, -0.14, 0.34, -0.24, 0.12)  # added to that of the formulation's colour


def _shade(color: str, lighter: float) -> str:
    hue, lightness, saturation = colorsys.rgb_to_hls(*to_rgb(color))
    lighter = -lighter if lightness > 0.5 else lighter  # a pale colour gets darker, to stay readable
    return to_hex(colorsys.hls_to_rgb(hue, min(max(lightness + lighter, 0.12), 0.82), saturation))


def look(formulation: str, variant: int = 0) -> Look:
    """Of the formulation. A variant (another d_hat, another step solver) keeps hue and marker and has its own
    shade and dash.
    """
    base = LOOKS.get(formulation)
    if base is None:
        looks = list(LOOKS.values())
        base = looks[zlib.crc32(formulation.encode()) % len(looks)]
    if variant == 0:
        return base
    shade = VARIANT_LIGHTNESS[variant % len(VARIANT_LIGHTNESS)]
    return Look(_shade(base.color, shade), base.marker, VARIANT_DASHES[(variant - 1) % len(VARIANT_DASHES)])


def runs_of(runs: pd.DataFrame, group: str) -> pd.DataFrame:
    """The runs of one figure, with `variant`: 0 for the first run of a formulation, the plain one before all
    others.
    """
    chosen = runs[runs["group"] == group]
    plain = chosen["series"] != chosen["formulation"]
    order = chosen.assign(plain=plain).sort_values("plain", kind="stable")
    return chosen.assign(variant=order.groupby("formulation").cumcount())


def marks(length: int, wanted: int = 12) -> int:
    """markevery: about `wanted` markers on a line of this length."""
    return max(1, length // wanted)


def look_of(row: pd.Series) -> Look:
    """Of a run of runs_of()."""
    return look(row["formulation"], int(row.get("variant", 0)))


def marker_face(row: pd.Series) -> str:
    """What the markers of a run are filled with."""
    return "none" if verdict_word(row) else look_of(row).color


def draw(axis, x, y, row: pd.Series, end_mark: bool = True, steps: str = "default") -> None:
    """One run's line. Hollow markers: run_words.HOLLOW; a failure ends in a cross. steps: matplotlib's
    drawstyle, `steps-mid` for a count of each time step, `steps-post` for a share.
    """
    line = look_of(row).line(drawstyle=steps, markevery=marks(len(x)), label=name_of(row))
    axis.plot(x, y, **line, markerfacecolor=marker_face(row), markeredgewidth=0.8)
    if end_mark and row["outcome"] != "ok" and len(x) > 0:
        draw_failure(axis, x[-1], y[-1], look_of(row).color)


def draw_failure(axis, x: float, y: float, color: str, size: float = 6, **how) -> None:
    """A cross, as at the end of a line."""
    cross = {"marker": "x", "markersize": size, "markeredgewidth": 0.2 + size / 5, "gid": FAILURE}
    axis.plot([x], [y], linestyle="none", color=color, **cross, **how)


def failures_above(axis, places, color: str, row: int = 0) -> None:
    """Crosses at the upper edge: runs that failed and have no number, at their places on the other axis; of
    several series each in a row of its own, the first on top.
    """
    for x in places:
        draw_failure(axis, x, 0.97 - 0.05 * row, color, 5, transform=axis.get_xaxis_transform())


def marker_sentence(runs: pd.DataFrame) -> str:
    """What the markers of a figure mean, for its caption."""
    rule = hollow_rule(runs).replace("\n", " ").replace(r"$\hat{d}$", "d_hat")
    return MARKERS.format(hollow=(rule or "hollow markers: the run failed or is not valid") + ".")


def not_measured(axis, text: str = "not measured") -> None:
    axis.text(0.5, 0.5, text, ha="center", va="center", transform=axis.transAxes, color="#666666")


def legend_below(fig, axis, runs: pd.DataFrame | None = None) -> None:
    """One legend for the figure, below its panels; with `runs`, the rule of hollow markers as its title."""
    handles, labels = axis.get_legend_handles_labels()
    if handles:
        # of a column, inches: its line, and letters of 7 points
        width = max(LEGEND_COLUMN_IN, 0.6 + 0.055 * max(map(len, labels)))
        columns = max(1, min(len(labels), int(fig.get_figwidth() / width)))
        title = (hollow_rule(runs) if runs is not None else "") or None
        how = {"loc": "outside lower center", "ncols": columns, "frameon": False}
        fig.legend(handles, labels, **how, title=title, title_fontsize=6)


def letter_panels(axes) -> None:
    """(a), (b), ... above the upper left corner of every panel, row by row."""
    for letter, axis in zip("abcdefghijklmnopqrstuvwxyz", np.ravel(axes)):
        axis.set_title(f"({letter})", loc="left", fontweight="bold")


def reference_line(axis, y: float, label: str, dash: str = "-", below: bool = False) -> None:
    """A thin horizontal line with its meaning written on it (or below), at the right end. It counts as no
    data, and the axis reaches to it. After the scale of the axis is set.
    """
    low, high = axis.get_ylim()
    axis.set_ylim(min(low, y / 1.2), max(high, 1.2 * y))
    axis.axhline(y, color="#666666", linewidth=0.5, linestyle=dash, gid=REFERENCE)
    where = {"xycoords": ("axes fraction", "data"), "textcoords": "offset points", "ha": "right"}
    where |= {"xytext": (0, -2), "va": "top"} if below else {"xytext": (0, 1), "va": "bottom"}
    box = {"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 0.5}
    text = axis.annotate(label, (0.995, y), **where, fontsize=6, color="#444444", bbox=box)
    text.set_in_layout(False)


def _numbers(axis, which: str) -> np.ndarray:
    lines = [line for line in axis.lines if line.get_gid() != REFERENCE]
    data = [np.asarray(line.get_xdata() if which == "x" else line.get_ydata(), float) for line in lines]
    flat = np.concatenate(data) if data else np.array([])
    return flat[np.isfinite(flat)]


def log_if_decades(axis) -> None:
    """A logarithmic axis where the data span a decade; a narrow range reads better on a linear one."""
    values = _numbers(axis, "y")
    values = values[values > 0]
    if len(values) and values.max() >= 10 * values.min():
        axis.set_yscale("log")


def keep_span(axis, which: str = "y") -> None:
    """Widens an axis whose data differ by little, so that a difference of 1% looks like one.

    A linear axis spans at least LEAST_SPAN of its largest value, a logarithmic one at least LEAST_RATIO.
    After the scale of the axis is set.
    """
    scale, limits = (axis.get_xscale(), axis.set_xlim) if which == "x" else (axis.get_yscale(), axis.set_ylim)
    values = _numbers(axis, which)
    if scale == "log":
        values = values[values > 0]
        if len(values) and values.max() < LEAST_RATIO * values.min():
            middle = np.sqrt(values.max() * values.min())
            half = max(LEAST_RATIO, (values.max() / values.min()) ** WITH_MARGINS) ** 0.5
            limits(middle / half, middle * half)
        return
    least = LEAST_SPAN * np.abs(values).max(initial=0.0)
    if len(values) and np.ptp(values) < least:
        middle = (values.max() + values.min()) / 2
        half = max(least, WITH_MARGINS * np.ptp(values)) / 2
        limits(middle - half, middle + half)


def save(fig, stem: Path, numbers: pd.DataFrame, shown: str, runs: pd.DataFrame | None = None) -> list[Path]:
    """stem.png, stem.pdf, stem.csv, the caption stem.txt, stem.svg, and stem.dat, the numbers as pgfplots
    reads them; the same bytes for the same records.

    shown: sentences on what the figure shows; runs: where settings, machine and day are taken from.
    """
    make_readable(fig.axes)
    paths = [stem.with_name(stem.name + suffix) for suffix in SUFFIXES]
    write_figure(fig, paths[0], metadata={"Software": None})
    fig.set_layout_engine("none")  # the picture is laid out; doing it again takes a third of all the time
    write_figure(fig, paths[1], metadata={"CreationDate": None, "Producer": None, "Creator": None})
    write_whole(paths[2], numbers.to_csv(index=False))
    write_whole(paths[3], caption(shown, [] if runs is None else runs.to_dict("records")))
    write_figure(fig, paths[4], metadata={"Date": None, "Creator": None})
    write_whole(paths[5], pgfplots.text(numbers))
    plt.close(fig)
    return paths


def png(figure: plt.Figure, dpi: int) -> str:
    """A figure for a page of one file: PNG in base64. It is closed."""
    out = io.BytesIO()
    figure.savefig(out, format="png", dpi=dpi)
    plt.close(figure)
    return base64.b64encode(out.getvalue()).decode()
