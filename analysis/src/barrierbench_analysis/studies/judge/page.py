"""The page of a judgement: one HTML file that needs no network."""

from pathlib import Path

import numpy as np

from barrierbench_analysis.figures.style import NARROW_IN, WIDE_IN, plt, png
from barrierbench_analysis.io.template import filled

from .energy import words
from .verdict import meaning

TEMPLATE = Path(__file__).resolve().parent / "page.html"
MOST_ROWS = 200  # of findings on the page; the record has all


def _series(record: dict, key: str) -> np.ndarray:
    values = [frame.get(key) for frame in record["frames"]]
    return np.array([np.nan if value is None else value for value in values])


def _crosses(frame: dict) -> bool:
    return frame["crossings"] + frame["obstacle_violations"] + frame.get("changed_sides", 0) > 0


def figure_of(record: dict) -> str:
    """Smallest gaps of each frame, with marks where something crosses, and all vertices by their gap."""
    times = record["trajectory"]["times_s"]
    across = np.arange(len(record["frames"])) if times is None else np.array(times)
    bad = np.array([_crosses(frame) for frame in record["frames"]])
    figure, (left, right) = plt.subplots(1, 2, figsize=(WIDE_IN, NARROW_IN * 0.8), layout="constrained")
    for key, word, dash in (
        ("gap_between_m", "between surfaces", "-"),
        ("gap_obstacles_m", "to obstacles", "--"),
    ):
        gap = _series(record, key)
        if np.isfinite(gap).any():
            left.plot(across, gap, dash, marker="." if len(gap) < 60 else None, label=word)
    for k, at in enumerate(across[bad]):
        left.axvline(at, color="#d55e00", lw=0.8, zorder=0, label="something crosses" if k == 0 else None)
    left.set_xlabel("frame" if times is None else "time (s)")
    left.set_ylabel(f"smallest gap (m), of those below {record['reach_m']:.3g} m")
    if left.get_legend_handles_labels()[0]:
        left.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)
    bins = [b for b in record["total"]["gap_histogram"] if b["from_m"] is not None]
    edges = np.array([b["from_m"] for b in bins])
    right.bar(edges, [b["vertices"] for b in bins], width=edges * (10**0.25 - 1), align="edge")
    right.set_xscale("log")
    right.set_xlabel("gap of a vertex to the closest triangle (m)")
    right.set_ylabel("vertices, over all frames")
    return png(figure, dpi=160)


ENERGIES = (  # key of a frame: label, dash
    ("kinetic_J", "kinetic, of the interval before", "-"),
    ("gravity_J", "of gravity", "--"),
    ("elastic_J", "elastic", ":"),
)


def energy_figure_of(record: dict) -> str | None:
    """Energies over the frames, that of gravity from its first value; None without elastic ones."""
    if not any("elastic_J" in frame for frame in record["frames"]):
        return None
    times = record["trajectory"]["times_s"]
    across = np.arange(len(record["frames"])) if times is None else np.array(times)
    figure, axes = plt.subplots(figsize=(NARROW_IN * 1.3, NARROW_IN * 0.8), layout="constrained")
    for key, word, dash in ENERGIES:
        series = _series(record, key)
        if key == "gravity_J":
            series = series - series[0]
        if np.isfinite(series).any():
            axes.plot(across, series, dash, label=word)
    axes.set_xlabel("frame" if times is None else "time (s)")
    axes.set_ylabel("energy (J)")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, frameon=False)
    return png(figure, dpi=160)


def page_of(record: dict) -> str:
    keys = ("frame", "what", "count", "pair", "depth_m")
    shown = [[row[key] for key in keys] for row in record["findings"][:MOST_ROWS]]
    more = {"energy_figure": energy_figure_of(record), "energy_words": words(record["energy"])}
    more |= {"meaning": meaning(record), "figure": figure_of(record), "shown": shown, "most": MOST_ROWS}
    return filled(TEMPLATE, record | more)
