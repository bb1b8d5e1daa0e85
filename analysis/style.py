"""One look for every figure: a formulation has one colour, one marker and one dash across the project."""

from __future__ import annotations

import logging
import textwrap
import zlib
from dataclasses import dataclass
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import pandas as pd  # noqa: E402

NARROW_IN, WIDE_IN = 3.33, 7.0
HOLLOW = r"hollow markers: the run failed, is not valid, or its smallest gap/$\hat d$ at converged step ends is not within a factor {ratio:g} of {reference}"
LEGEND_COLUMN_IN = 2.3  # the longest series with its verdict

logging.getLogger("fontTools").setLevel(logging.ERROR)  # it comments on the missing date of the PDF

plt.rcParams.update(
    {
        "font.size": 8,
        "axes.titlesize": 8,
        "axes.labelsize": 8,
        "legend.fontsize": 7,
        "xtick.labelsize": 7,
        "ytick.labelsize": 7,
        "lines.linewidth": 1.0,
        "lines.markersize": 3.5,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "grid.linewidth": 0.3,
        "grid.alpha": 0.6,
        "pdf.fonttype": 42,
        "svg.fonttype": "none",
        "svg.hashsalt": "barrierbench",
        "savefig.dpi": 200,
    }
)


@dataclass(frozen=True)
class Look:
    color: str
    marker: str
    dash: object


# Okabe-Ito colours.
LOOKS = {
    "log": Look("#0072B2", "o", "-"),
    "quadratic": Look("#E69F00", "s", "--"),
    "cubic": Look("#009E73", "^", "-."),
    "cubic_dynamic": Look("#D55E00", "D", (0, (5, 1))),
    "cubic_dynamic_lagged": Look("#CC79A7", "v", (0, (3, 1, 1, 1))),
    "ipc2020": Look("#56B4E9", "P", ":"),
    "log_squared": Look("#000000", "X", (0, (1, 1))),
    "two_stage": Look("#A6761D", "<", (0, (5, 2, 1, 2))),
    "article_cubic": Look("#999999", ">", "-."),
    "quadratic_as_printed": Look("#8B4513", "h", "--"),
}


def look(formulation: str, series: str | None = None) -> Look:
    """Of the formulation; a variant of it (another series name) keeps colour and marker: scaled ones are dotted."""
    base = LOOKS.get(formulation)
    if base is None:
        looks = list(LOOKS.values())
        base = looks[zlib.crc32(formulation.encode()) % len(looks)]
    if series is None or series == formulation:
        return base
    return Look(base.color, base.marker, (0, (1, 2)) if series.endswith(" x s") else (0, (6, 2, 1, 1)))


def marks(length: int, wanted: int = 12) -> int:
    """markevery: about `wanted` markers on a line of this length."""
    return max(1, length // wanted)


def verdict_word(row: pd.Series) -> str:
    """Why the markers of a run are hollow: its outcome, or the program's verdict on comparability; else empty."""
    if row["outcome"] != "ok":
        return row["outcome"]
    return row["comparability"] if row["comparability"] in ("not_valid", "not_comparable") else ""


def name_of(row: pd.Series) -> str:
    """The legend's text: the series, and the word of a run whose marker is hollow."""
    word = verdict_word(row)
    return f"{row['series']} ({word})" if word else row["series"]


def draw(axis, x, y, row: pd.Series, end_word: bool = True) -> None:
    """One run's line. Hollow markers: see HOLLOW; a failure ends in its word."""
    style = look(row["formulation"], row["series"])
    solid = not verdict_word(row)
    axis.plot(
        x,
        y,
        color=style.color,
        linestyle=style.dash,
        marker=style.marker,
        markevery=marks(len(x)),
        markerfacecolor=style.color if solid else "none",
        markeredgewidth=0.8,
        label=name_of(row),
    )
    if end_word and row["outcome"] != "ok" and len(x) > 0:
        axis.annotate(
            row["outcome"], (x[-1], y[-1]), xytext=(3, 0), textcoords="offset points", fontsize=6, color=style.color
        )


def not_measured(axis, text: str = "not measured") -> None:
    axis.text(0.5, 0.5, text, ha="center", va="center", transform=axis.transAxes, color="#666666")


def hollow_rule(runs: pd.DataFrame) -> str:
    """The rule of hollow markers in words; empty where no run of the group has a reference."""
    compared = runs[runs["reference_run"] != ""]
    if compared.empty:
        return ""
    names = runs.drop_duplicates("run").set_index("folder")["series"]
    references = " or ".join(dict.fromkeys(names.get(folder, folder) for folder in compared["reference_run"]))
    text = HOLLOW.format(ratio=compared["max_gap_ratio"].iloc[0], reference=references)
    return "\n".join(textwrap.wrap(text, 110))


def legend_below(fig, axis, runs: pd.DataFrame | None = None) -> None:
    """One legend for the figure, below its panels; with `runs`, the rule of hollow markers as its title."""
    handles, labels = axis.get_legend_handles_labels()
    if handles:
        columns = max(1, min(len(labels), int(fig.get_figwidth() / LEGEND_COLUMN_IN)))
        title = hollow_rule(runs) if runs is not None else ""
        fig.legend(handles, labels, loc="outside lower center", ncols=columns, frameon=False, title=title or None, title_fontsize=6)


def log_if_decades(axis) -> None:
    """A logarithmic axis where the data span a decade; a narrow range reads better on a linear one."""
    values = [v for line in axis.lines for v in line.get_ydata() if v > 0]
    if values and max(values) >= 10 * min(values):
        axis.set_yscale("log")


def save(fig, stem: Path, numbers: pd.DataFrame) -> list[Path]:
    """stem.png, stem.pdf and stem.csv; the same bytes for the same records."""
    stem.parent.mkdir(parents=True, exist_ok=True)
    paths = [stem.with_name(stem.name + suffix) for suffix in (".png", ".pdf", ".csv")]
    fig.savefig(paths[0], metadata={"Software": None})
    fig.savefig(paths[1], metadata={"CreationDate": None, "Producer": None, "Creator": None})
    numbers.to_csv(paths[2], index=False)
    plt.close(fig)
    return paths
