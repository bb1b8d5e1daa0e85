"""docs/engines.png: error against seconds of every engine, a panel a scene; crosses where surfaces cross."""

from __future__ import annotations

from pathlib import Path

from ..style import WIDE_IN, plt
from .level import lines

COLUMNS = 3
COLOURS = ("#000000", "#0072b2", "#56b4e9", "#005a5a", "#d55e00", "#e69f00", "#a03060", "#009e73")
MARKS = "osD^vP<>"
MOST = 100  # % of width: who is farther off has flown away, and would take the axis with it


def _crossed(row: dict) -> bool:
    return row.get("frames_crossing", 0) + row.get("frames_in_obstacles", 0) > 0


def paint(record: dict, path: Path) -> None:
    scenes = record["scenes"]
    height = -(-(len(scenes) + 1) // COLUMNS)
    figure, axes = plt.subplots(
        height, COLUMNS, figsize=(WIDE_IN, 2.4 * height), layout="constrained", squeeze=False
    )
    who = list(dict.fromkeys((row["engine"], row["variant"]) for one in scenes for row in one["rows"]))
    looks = {one: (COLOURS[k % len(COLOURS)], MARKS[k % len(MARKS)]) for k, one in enumerate(who)}
    for axis, one in zip(axes.flat, scenes):
        for name, line in lines(one["rows"]).items():
            colour, mark = looks[name]
            seconds, error = [r["seconds"] for r in line], [min(100 * r["error_mean"], MOST) for r in line]
            axis.plot(seconds, error, "-", marker=mark, color=colour, ms=4, lw=1)
            bad = [k for k, row in enumerate(line) if _crossed(row)]
            axis.plot([seconds[k] for k in bad], [error[k] for k in bad], "x", color="#cc0000", ms=8, mew=1.4)
        known = one["reference_apart"].get("error_mean")
        if known:
            axis.axhline(100 * known, color="#999999", lw=0.8, ls=":")
        axis.set(
            xscale="log",
            yscale="log",
            title=one["scene"],
            xlabel="seconds of steps",
            ylabel="error, % of width",
        )
    for axis in axes.flat[len(scenes) :]:
        axis.axis("off")
    key = axes.flat[len(scenes)]
    for name, (colour, mark) in looks.items():
        key.plot([], [], "-", marker=mark, color=colour, ms=4, lw=1, label=" ".join(name))
    key.plot([], [], "x", color="#cc0000", ms=8, mew=1.4, label="surfaces cross, or are in an obstacle")
    key.plot([], [], " ", label=f"{MOST} %: that or more")
    key.plot([], [], ":", color="#999999", lw=0.8, label="reference, against twice its time step")
    key.legend(loc="center", frameon=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=160)
    plt.close(figure)
