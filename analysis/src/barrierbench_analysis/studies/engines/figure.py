"""The figure of a record: error against seconds of every engine, a panel a scene; crosses where surfaces
cross, bars from the least to the most of jittered starts.
"""

from pathlib import Path

from barrierbench_analysis.figures.style import WIDE_IN, plt
from barrierbench_analysis.figures.ticks import make_readable
from barrierbench_analysis.io.whole_file import write_figure

from .level import lines
from .scatter import crosses, of_rows, scatter

COLUMNS = 3
COLOURS = ("#000000", "#0072b2", "#56b4e9", "#005a5a", "#d55e00", "#e69f00", "#a03060", "#009e73")
MARKS = "osD^vP<>"
MOST = 100  # % of width: who is farther off has flown away, and would take the axis with it


def _points(one: dict, line: list[dict]) -> list[tuple[float, float, float, float, bool]]:
    """Of each level of an engine: seconds of its own start; error in %, the median of jittered starts where
    there are some, with least and most; whether surfaces cross from any start.
    """
    spread, rows, out = scatter(one), of_rows(one), []
    for row in line:
        who = (row["engine"], row["variant"], row["level"])
        own = row["error_mean"]
        least, middle, most = (spread[who]["error"] if who in spread else None) or (own, own, own)
        percent = [min(100 * error, MOST) for error in (middle, least, most)]
        out.append((row["seconds"], *percent, any(crosses(each) for each in [row, *rows.get(who, [])])))
    return out


def _draw(axis, points: list[tuple], colour: str, mark: str) -> None:
    seconds, error, least, most, bad = zip(*points)
    axis.plot(seconds, error, "-", marker=mark, color=colour, ms=4, lw=1)
    axis.vlines(seconds, least, most, color=colour, lw=1.6, alpha=0.7)
    crossed = [(s, e) for s, e, b in zip(seconds, error, bad) if b]
    if crossed:
        axis.plot(*zip(*crossed), "x", color="#cc0000", ms=8, mew=1.4)


def _key(axis, looks: dict[tuple, tuple[str, str]], has_starts: bool) -> None:
    """Who has which colour and mark, and what crosses, bars and the dotted line are."""
    for name, (colour, mark) in looks.items():
        axis.plot([], [], "-", marker=mark, color=colour, ms=4, lw=1, label=" ".join(name))
    others = {
        "surfaces cross, or are in an obstacle": ("x", {"color": "#cc0000", "ms": 8, "mew": 1.4}),
        "jittered starts: least to most": ("-", {"color": "#666666", "lw": 1.6}),
        f"{MOST} %: that or more": (" ", {}),
        "reference, against twice its time step": (":", {"color": "#999999", "lw": 0.8}),
    }
    for label, (form, look) in others.items():
        if has_starts or not label.startswith("jittered"):
            axis.plot([], [], form, label=label, **look)
    axis.legend(loc="center", frameon=False)


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
            if line:
                _draw(axis, _points(one, line), colour, mark)
        known = one["reference_apart"].get("error_mean")
        if known:
            axis.axhline(100 * known, color="#999999", lw=0.8, ls=":")
        names = {"xlabel": "seconds of steps", "ylabel": "error, % of width", "title": one["scene"]}
        axis.set(xscale="log", yscale="log", **names)
    make_readable(axes.flat[: len(scenes)])
    for axis in axes.flat[len(scenes) :]:
        axis.axis("off")
    _key(axes.flat[len(scenes)], looks, any(one.get("starts") for one in scenes))
    write_figure(figure, path, dpi=160)
    plt.close(figure)
