"""Float against double, from the origin outwards: how far the end of a run is from that in double."""

import json
from pathlib import Path

import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts

from .drawing import OF_RUNS, Drawing, SweepRecords, common, each, failed_words, outcomes

REFERENCE = "double"
DASHES = {"float": "-", "mixed": "--"}
FEW_ULPS = 10.0
OPTIONS = {"offset": "/scene/translate_m"}
SHOWN = (
    "The same scene moved away from the origin. Left: largest distance of a vertex at the end of a run from"
    " the run in double of the same formulation and place, over the size of the scene; grey: half a unit in"
    " the last place of a float of that coordinate. Right: smallest gap at a step end in units in the last"
    " place of the largest coordinate, in the precision of the run; line: {few:g}. Solid: float; dashed:"
    " mixed. Crosses at the upper edge: runs that failed, by outcome: {failed}."
)


def _last_frame(subject: SweepRecords, row: pd.Series) -> tuple[int, np.ndarray] | None:
    last = None
    for step, frame in subject.run(row).frames():
        last = step, np.asarray(frame.vertices, float)
    return last


def table(subject: SweepRecords, offset: str) -> pd.DataFrame:
    """A row a run that is not in double: offset_m, error (nan where it, or its run in double, has not come to
    the end), gap_ulps.
    """
    runs = subject.records.runs.assign(
        offset_m=[float(np.linalg.norm(place)) for place in map(_numbers, subject.records.runs[offset])]
    )
    doubles = {
        (row["formulation"], row["offset_m"]): row
        for _, row in runs[runs["precision"] == REFERENCE].iterrows()
    }
    rows = []
    for _, row in runs[runs["precision"] != REFERENCE].iterrows():
        against, error = doubles.get((row["formulation"], row["offset_m"])), np.nan
        if against is not None and row["outcome"] == against["outcome"] == "ok":
            mine, theirs = _last_frame(subject, row), _last_frame(subject, against)
            if mine and theirs and mine[0] == theirs[0]:
                distance = np.linalg.norm(mine[1] - theirs[1], axis=1).max()
                error = float(distance) / row["scene_extent_m"]
        rows.append(
            {"formulation": row["formulation"], "precision": row["precision"], "offset_m": row["offset_m"]}
            | {"outcome": row["outcome"], "error": error, "gap_ulps": row["gap_min_ulps"]}
            | {"ulp": 0.5 * np.spacing(np.float32(max(row["offset_m"], row["scene_extent_m"])))}
            | {"extent_m": row["scene_extent_m"]}
        )
    return pd.DataFrame(rows)


def _numbers(place) -> list[float]:
    """Of a swept place, which a table keeps as JSON text."""
    return json.loads(place) if isinstance(place, str) else place


def draw(axis, found: pd.DataFrame, column: str) -> None:
    """Places side by side, since the first is 0."""
    places = sorted(found["offset_m"].unique())
    for k, name, of, look in each(found, "offset_m"):
        for precision, dash in DASHES.items():
            mine = of[of["precision"] == precision]
            if mine.empty:
                continue
            at = [places.index(offset) for offset in mine["offset_m"]]
            label = name if precision == "float" else f"{name}, {precision}"
            axis.plot(at, mine[column], **look.line(linestyle=dash, label=label))
            failed = [place for place, outcome in zip(at, mine["outcome"]) if outcome != "ok"]
            style.failures_above(axis, failed, look.color, k)
    axis.set(yscale="log", xlabel="distance from the origin (m)")
    axis.set_xticks(range(len(places)), [f"{place:g}" for place in places])


def figure(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    runs, offset = subject.records.runs, drawing.options["offset"]
    if offset not in runs:
        raise drawing.nothing(f"no run has {offset}")
    found = table(subject, offset)
    if found.empty or found["error"].isna().all():
        raise drawing.nothing(f"no run beside one in double, both with a last frame ({outcomes(runs)})")
    fig, axes = drawing.panels(2, 2.8)
    for axis, column in zip(axes, ("error", "gap_ulps")):
        draw(axis, found, column)
    ulps = found.drop_duplicates("offset_m").sort_values("offset_m")
    half, grey = ulps["ulp"] / ulps["extent_m"], {"color": "#888888", "linewidth": 0.8}
    axes[0].plot(range(len(ulps)), half, **grey, gid=style.REFERENCE)
    style.reference_line(axes[1], FEW_ULPS, f"{FEW_ULPS:g} ulps")
    axes[0].set(ylabel="distance from double / size")
    axes[1].set(ylabel="smallest gap (ulps)")
    for axis in axes:
        low, high = axis.get_ylim()
        axis.set_ylim(low, high * (high / low) ** 0.2)
    facts = Facts(
        outcomes(runs),
        "largest distance of a vertex; smallest gap",
        "the run in double at the same place",
        common(runs, f"{OF_RUNS} steps"),
    )
    shown = SHOWN.format(few=FEW_ULPS, failed=failed_words(found) or "none")
    return drawing.finish(fig, axes, found, shown, facts, runs=runs)
