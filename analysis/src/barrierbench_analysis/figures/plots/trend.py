"""The numbers of the gate over the commits that accepted new ones."""

from pathlib import Path

import numpy as np
import pandas as pd

from barrierbench_analysis.figures import panels, style
from barrierbench_analysis.figures.captions import Facts

from .drawing import Drawing

OPTIONS = {
    "metrics": [
        "newton_iterations",
        "log10_cond full/none median",
        "log10_cond full/block_jacobi median",
        "probe_pcg_median",
    ]
}
LABELS = {
    "newton_iterations": "Newton iterations",
    "log10_cond full/none median": "cond, raw, median",
    "log10_cond full/block_jacobi median": "cond, block Jacobi, median",
    "probe_pcg_median": "PCG iterations, median",
}
DASHES = ("-", "--", ":", "-.")
APART = 0.1  # between lines of two cases, in distances of commits
LEAST = 1.1  # an axis reaches at least so far from 1
SHOWN = (
    "What ./bench gate accept kept in results/baselines, commit after commit, over the first value of each"
    " case;"
    " colour and marker: formulation, dash: scene. A line begins with the commit that brought its case. Bars:"
    " the envelope that the gate holds it to."
)


def formulation_of(case: str) -> str:
    """Of a case SCENE-FORMULATION of the gate, the word that has a colour."""
    word = case.rpartition("-")[2]
    return {
        "dynamic": "cubic_dynamic",
        "lagged": "cubic_dynamic_lagged",
        "consistent": "cubic_dynamic_consistent",
    }.get(word, word)


def relative(found: pd.DataFrame, metric: str) -> pd.DataFrame:
    """Rows of the metric with value, lower and upper over the first value of their case; logarithms to base
    10 as the numbers they are of. Cases with fewer than two commits are left out.
    """
    mine = found[(found["metric"] == metric) & found["value"].notna()].sort_values(["case", "at"])
    mine = mine[mine.groupby("case")["at"].transform("size") >= 2]
    ends = mine[["value", "lower", "upper"]].astype(float)
    if metric.startswith("log10"):
        ends = 10**ends
    first = ends["value"].groupby(mine["case"]).transform("first")
    return mine.assign(**{name: ends[name] / first for name in ends})


def draw(axis, found: pd.DataFrame) -> None:
    """Cases a little apart, so that their envelopes do not lie on one another."""
    cases = list(dict.fromkeys(found["case"]))
    scenes = list(dict.fromkeys(case.rpartition("-")[0] for case in cases))
    for k, case in enumerate(cases):
        mine, look = found[found["case"] == case], style.look(formulation_of(case))
        bars = np.clip([mine["value"] - mine["lower"], mine["upper"] - mine["value"]], 0, None)
        dash = DASHES[scenes.index(case.rpartition("-")[0]) % len(DASHES)]
        line = look.line(linestyle=dash, linewidth=0.8, elinewidth=0.5, label=case)
        axis.errorbar(mine["at"] + APART * (k - (len(cases) - 1) / 2), mine["value"], yerr=bars, **line)
    low, high = min(found["lower"].min(), 1 / LEAST), max(found["upper"].max(), LEAST)
    axis.set_ylim(low - 0.05 * (high - low), high + 0.05 * (high - low))


def figure(subject: pd.DataFrame, drawing: Drawing) -> list[Path]:
    of = {metric: relative(subject, metric) for metric in drawing.options["metrics"]}
    of = {metric: found for metric, found in of.items() if not found.empty}
    if not of:
        raise drawing.nothing("no case has baselines of two commits: a clone with its history is needed")
    fig, axes = panels.grid(len(of), drawing.width_in, 2.1, most=2, sharex=True)
    days = subject.drop_duplicates("at").sort_values("at")
    for axis, (metric, found) in zip(axes, of.items()):
        draw(axis, found)
        axis.set_title(LABELS.get(metric, metric))
        names = [f"{c[:7]}\n{d[5:]}" for c, d in zip(days["commit"], days["day"])]
        axis.set_xticks(days["at"], names, fontsize=5)
        if axis.get_subplotspec().is_first_col():
            axis.set_ylabel("over the first")
        if axis.get_subplotspec().is_last_row():
            axis.set_xlabel("commit, day")
    style.letter_panels(axes)
    handles, labels = max((axis.get_legend_handles_labels() for axis in axes), key=lambda h: len(h[1]))
    fig.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False)
    numbers = pd.concat(of.values(), ignore_index=True)
    facts = Facts(
        f"{days.shape[0]} commits, {numbers['case'].nunique()} cases",
        "value of a baseline over the first of its case",
        "the first baseline of each case",
        f"cases {', '.join(dict.fromkeys(numbers['case']))}; {days['day'].iloc[0]} to {days['day'].iloc[-1]}",
    )
    return drawing.save(fig, numbers, SHOWN, facts)
