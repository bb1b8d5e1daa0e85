"""How the gaps of all vertices in contact are spread, frame after frame: a ridge a frame."""

import math
from pathlib import Path

import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts

from .drawing import Drawing, SweepRecords, common, each, outcomes

BINS = 8  # a decade
LEAST = -8.0  # log10 of the smallest gap / d_hat that has a bin of its own
HEIGHT = 0.92  # of the highest ridge, in distances of ridges
SHOWN = (
    "Share of the vertices in contact whose smallest gap is there, in {bins} bins a decade of gap / d_hat (1:"
    " contact begins): a ridge a frame, at its time, all of one scale; vertical marks: medians. A frame"
    " without contact is a flat line. A run that failed ends at its last frame and has its outcome in the"
    " title of its panel."
)


def shares(gaps: np.ndarray, low: float) -> np.ndarray:
    """[bins] share of the gaps below 1 in bins of log10 from `low` to 0, the lowest with all below it; 0
    where nothing is in contact.
    """
    logs = np.log10(np.maximum(gaps[(gaps < 1) & (gaps > 0)], 10**low))
    counts, _ = np.histogram(logs, bins=round(-low * BINS), range=(low, 0.0))
    return counts / max(1, len(logs))


def frames(subject: SweepRecords, row: pd.Series) -> list[tuple[int, np.ndarray]]:
    """Step, and gap / d_hat of every vertex, of each frame after a step."""
    run = subject.run(row)
    return [
        (step, np.asarray(frame.of_vertices["gap_rel"], float))
        for step, frame in run.frames()
        if "gap_rel" in frame.of_vertices and step >= 0
    ]


def table(subject: SweepRecords) -> tuple[pd.DataFrame, float]:
    """A row a run, frame and bin, and log10 of the lower end of the bins."""
    gaps = {row["run"]: frames(subject, row) for _, row in subject.records.runs.iterrows()}
    touching = [g[(g < 1) & (g > 0)] for found in gaps.values() for _, g in found]
    least = min((g.min() for g in touching if len(g)), default=1.0)
    low = max(LEAST, float(math.floor(math.log10(least))) if least < 1 else 0.0)
    rows = []
    for _, row in subject.records.runs.iterrows():
        times = subject.records.steps[subject.records.steps["run"] == row["run"]].set_index("step")["t_s"]
        for step, found in gaps[row["run"]]:
            mine = found[(found < 1) & (found > 0)]
            for k, share in enumerate(shares(found, low)) if low < 0 else ():
                rows.append(
                    {"formulation": row["formulation"], "outcome": row["outcome"], "step": step}
                    | {"t_s": float(times[step]), "log10_gap_rel": low + (k + 0.5) / BINS, "share": share}
                    | {"in_contact": len(mine), "median": np.median(mine) if len(mine) else np.nan}
                )
    return pd.DataFrame(rows), low


def draw(axis, found: pd.DataFrame, spacing: float, highest: float) -> None:
    """The ridges of one run. spacing: of two of them in time; highest: the share that is as high as that."""
    look = style.look(found["formulation"].iloc[0])
    for t, ridge in found.groupby("t_s", sort=True):
        height = ridge["share"].to_numpy() / highest * HEIGHT * spacing
        first = ridge["log10_gap_rel"].iloc[0] - 0.5 / BINS
        edges = 10 ** (first + np.arange(len(ridge) + 1) / BINS)
        axis.stairs(t + height, edges, baseline=t, fill=True, color=look.color, alpha=0.45)
        axis.stairs(t + height, edges, baseline=t, color=look.color, linewidth=0.7)
        if ridge["in_contact"].iloc[0]:
            axis.plot([ridge["median"].iloc[0]] * 2, [t, t + 0.35 * spacing], color="black", linewidth=1)
    axis.set_xscale("log")


def figure(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    numbers, low = table(subject)
    if numbers.empty or not numbers["in_contact"].any():
        raise drawing.nothing("no frame of these runs has a vertex in contact")
    spacing = float(np.diff(np.unique(numbers["t_s"])).min(initial=1.0))
    fig, axes = drawing.panels(numbers["formulation"].nunique(), 3.2, sharex=True, sharey=True)
    for axis, (_, name, mine, _) in zip(axes, each(numbers)):
        draw(axis, mine, spacing, numbers["share"].max())
        outcome = mine["outcome"].iloc[0]
        words = name.replace("_", "\n")
        axis.set_title(words if outcome == "ok" else f"{words}\n{outcome}", fontsize=6)
        axis.set(xlabel=r"gap / $\hat d$", xlim=(10**low, 1))
    axes[0].set_ylabel("time (s)")
    style.letter_panels(axes)
    runs = subject.records.runs
    facts = Facts(
        f"{numbers.groupby(['formulation', 'step']).ngroups} frames of {outcomes(runs)}",
        "share of the vertices in contact of a frame",
        "d_hat, 1",
        common(runs),
    )
    return drawing.save(fig, numbers, SHOWN.format(bins=BINS), facts, runs)
