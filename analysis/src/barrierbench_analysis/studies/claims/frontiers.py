"""Who gets how far and at what cost, over the levels of a sweep that stretches several axes from one middle:
table and figure of a claim.
"""

import math
import textwrap
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

from barrierbench_analysis.figures import style
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.text_table import markdown as table_lines
from barrierbench_analysis.studies.kit.metrics import METRICS
from barrierbench_analysis.studies.kit.success import read_for
from barrierbench_analysis.tables import series
from barrierbench_analysis.tables.estimate import wilson
from barrierbench_analysis.tables.numbers import significant
from barrierbench_analysis.tables.robustness import Frontier, Trial, expected_cost, frontier, profile, success

from .ends import end_of_case
from .entry import Claim, read_sweep
from .outcomes import asked, good, hopeless
from .table import Runs, Table

MIDDLE = "nominal"  # the level that all axes start from
LOOKS = {
    "published": ("#D55E00", "D"),
    "ours_per_iteration": ("#E69F00", "s"),
    "ours_per_step": ("#CC79A7", "v"),
    "ours_consistent": ("#332288", "*"),
    "fixed_cubic": ("#009E73", "^"),
    "fixed_log": ("#0072B2", "o"),
}
SHOWN = (
    "Ways to a stiffness over {n} problems of the sweep `{sweep}` (scenes x levels x starts), nothing"
    " retuned{left_out}. A run gets through when it {asked}. (a) Data profile: share of the problems that"
    " were solved with at most so many {cost}; a run that failed is never solved."
)
SHARES = (
    " (b) Share of the runs of a level, over all scenes and starts, that got through: E, m, n, v are Young's"
    " modulus, mass, resolution and speed of impact times the number, beside the nominal level."
)


def cases(runs: Runs) -> list[str]:
    found, looks = dict.fromkeys(row["case"] for row in runs.rows), list(LOOKS)
    return sorted(found, key=lambda case: looks.index(case) if case in looks else len(looks))


def case_labels(claim: Claim, runs: Runs) -> dict[str, str]:
    """Case -> its name with the residual of its ends, where its steps are not asked to converge."""
    sweep = read_sweep(claim.frontier["sweep"])
    ends = {case: end_of_case(runs.rows, case, sweep) for case in cases(runs)}
    return {case: f"{case} ({end})" if end else case for case, end in ends.items()}


def _cost(row: dict, name: str) -> float:
    if row[name] is None:
        raise UserError(f"{row['scene']} {row['level']} {row['case']} main={row['seed']}: no {name}")
    return float(row[name])


def value_of(level: str, axis: str, middle: float) -> float | None:
    """The number of a level on an axis: E10 is 10 on E, nominal the middle; None for a level of another
    axis."""
    if level == MIDDLE:
        return middle
    try:
        return float(level.removeprefix(axis)) if level.startswith(axis) else None
    except ValueError:
        return None


def judged_rows(runs: Runs, bad: str | None) -> list[dict]:
    """Without scenes x levels that no case gets through."""
    left_out = hopeless(runs, bad)
    return [row for row in runs.rows if (row["scene"], row["level"]) not in left_out]


def _trial(row: dict, value: float, cost: float, bad: str | None) -> Trial:
    return Trial(f"{row['scene']} {row['level']} {row['seed']}", value, good(row, bad), cost)


def trials(runs: Runs, case: str, cost: str, bad: str | None = None) -> list[Trial]:
    """Runs of a case for shares, costs and profiles. bad: as of a part (outcomes.py)."""
    return [_trial(row, 0.0, _cost(row, cost), bad) for row in judged_rows(runs, bad) if row["case"] == case]


def along(runs: Runs, case: str, axis: str, middle: float, bad: str | None = None) -> list[Trial]:
    """All runs of a case at the levels of an axis, for its frontier: what nobody gets through bounds it as
    well. No cost is asked.
    """
    values = [(row, value_of(row["level"], axis, middle)) for row in runs.rows if row["case"] == case]
    return [_trial(row, value, 0.0, bad) for row, value in values if value is not None]


def _share(runs: Runs, case: str, every: list[Trial], bad: str | None) -> str:
    """Share of runs, and of scenes in which every run gets through, whose interval is over scenes."""
    through: dict[str, bool] = {}
    for row in judged_rows(runs, bad):
        if row["case"] == case:
            through[row["scene"]] = through.get(row["scene"], True) and good(row, bad)
    whole, n = sum(through.values()), len(through)
    low, high = wilson(whole, n)
    share = success(every)
    return f"{share.ok} of {share.n} runs; every run in {whole} of {n} scenes [{low:.3f}, {high:.3f}]"


def _reach(f: Frontier) -> str:
    """The range that all runs get through; a square bracket outwards where the next tested value fails."""
    if f.low is None or f.high is None:
        return "not even the middle"
    below, above = "]" * (f.fails_below is not None), "[" * (f.fails_above is not None)
    return f"{below}{f.low:g} to {f.high:g}{above}"


def _left_out(runs: Runs, bad: str | None) -> str:
    """How many places are left out, and which; empty when none is."""
    places = hopeless(runs, bad)
    if not places:
        return ""
    of_case = [row for row in runs.rows if row["case"] == runs.rows[0]["case"]]
    n = sum((row["scene"], row["level"]) in places for row in of_case)
    every = len({(row["scene"], row["level"]) for row in runs.rows})
    return (
        f"{len(places)} of {every} scenes x levels ({n} runs of each case) are left out, since no case gets"
        f" through: {', '.join(sorted(' '.join(p) for p in places))}"
    )


def has_runs(claim: Claim, table: Table) -> bool:
    """Whether there is a frontier and its runs. Numbers that were kept before the frontier asked for more are
    of other runs.
    """
    runs = table.sweeps.get(claim.frontier.get("sweep", ""))
    return (
        bool(runs and runs.rows)
        and {claim.frontier["cost"], *read_for(claim.frontier.get("bad"))} <= runs.rows[0].keys()
    )


def lines(claim: Claim, table: Table) -> list[str]:
    """The table for results/CLAIMS.md; nothing for a claim without a frontier or without its runs."""
    if not has_runs(claim, table):
        return []
    runs, cost, axes = table.sweeps[claim.frontier["sweep"]], claim.frontier["cost"], claim.frontier["axes"]
    bad = claim.frontier.get("bad")
    left_out = _left_out(runs, bad)
    found = [
        f"![data profile and shares of the policies](../docs/policies_{claim.id}.png)",
        "",
        f"Over `{claim.frontier['sweep']}`: runs that get through ({asked(claim.frontier)}), and the scenes"
        f" in which every run does [95% over scenes, Wilson], {METRICS[cost][0]} of all runs over the number"
        " of successes (ert), and the frontier: the range of each axis, from the nominal level outwards, in"
        " which every run of every scene and start gets through; a bracket that opens outwards means that"
        " the next tested value fails."
        + (f" The frontier counts every run. From share and ert {left_out}." if left_out else ""),
        "",
    ]
    rows = []
    for case, label in case_labels(claim, runs).items():
        every = trials(runs, case, cost, bad)
        ert = expected_cost(every)
        reaches = [
            _reach(frontier(along(runs, case, axis, middle, bad), middle)) for axis, middle in axes.items()
        ]
        rows.append([label, _share(runs, case, every, bad), significant(ert, 4), *reaches])
    head = ["case", "gets through", f"ert ({cost})", *(f"frontier of {axis}" for axis in axes)]
    return [*found, *table_lines(head, rows), ""]


def _profiles(axis, runs: Runs, names: dict[str, str], cost: str, bad: str | None) -> list[dict]:
    spent = {case: trials(runs, case, cost, bad) for case in names}
    costs = [t.cost for every in spent.values() for t in every if t.cost > 0]
    left, right, numbers = 0.9 * min(costs), max(costs), []
    for case, every in spent.items():
        color, marker = LOOKS.get(case, ("#444444", "x"))
        steps = profile(every)
        x = [left, *(b for b, _ in steps), right]
        y = [0.0, *(s for _, s in steps), steps[-1][1] if steps else 0.0]
        look = {"color": color, "marker": marker, "markevery": style.marks(len(x), 8)}
        axis.plot(x, y, drawstyle="steps-post", label=_two_lines(names[case]), **look)
        numbers += [{"panel": "profile", "case": case, "budget": b, "share": s} for b, s in steps]
    axis.set(xscale="log", xlim=(left, 1.05 * right), ylim=(0, 1.02))
    axis.set(xlabel=f"budget of {cost}", ylabel="share of problems solved")
    axis.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.xaxis.set_major_formatter(ScalarFormatter())
    axis.xaxis.set_minor_formatter(NullFormatter())
    return numbers


def _order(level: str, axes: dict) -> tuple:
    for k, (axis, middle) in enumerate(axes.items()):
        if level != MIDDLE and (value := value_of(level, axis, middle)) is not None:
            return (k + 1, value)
    return (0, 0.0)


def _shares(axis, runs: Runs, labels: dict[str, str], axes: dict, bad: str | None) -> list[dict]:
    names, judged = list(labels), judged_rows(runs, bad)
    levels = sorted({row["level"] for row in runs.rows}, key=lambda level: _order(level, axes))
    share, numbers = np.full((len(names), len(levels)), math.nan), []
    for i, case in enumerate(names):
        for j, level in enumerate(levels):
            found = [good(row, bad) for row in judged if (row["case"], row["level"]) == (case, level)]
            if not found:
                continue
            share[i, j] = sum(found) / len(found)
            text = f"{sum(found)}" if all(found) else f"{sum(found)}/{len(found)}"
            color = "white" if share[i, j] < 0.45 else "black"
            axis.text(j, i, text, ha="center", va="center", fontsize=5, color=color)
            numbers.append({"panel": "share", "case": case, "budget": level, "share": share[i, j]})
    axis.imshow(share, vmin=0, vmax=1, cmap="viridis", aspect="auto", alpha=0.85)
    axis.set_xticks(range(len(levels)), levels, rotation=90)
    axis.set_yticks(range(len(names)), map(_two_lines, labels.values()), fontsize=6)
    axis.grid(False)
    return numbers


def _two_lines(label: str) -> str:
    """What the steps of a case end with stands below its name."""
    name, _, end = label.partition(" (")
    return "\n".join([name, *textwrap.wrap("(" + end, 26)]) if end else name


def _rank(claim: Claim, names: dict[str, str]) -> list[str]:
    """The cases that the claim compares first, in the order of its parts."""
    compared = [part.get(key) for part in claim.parts for key in ("case", "over")]
    return [case for case in dict.fromkeys([*compared, *names]) if case in names]


def draw(claim: Claim, runs: Runs, stem: Path) -> list[Path]:
    """The figure, and the profiles that it has no room for in stem_more."""
    names, bad, cost = case_labels(claim, runs), claim.frontier.get("bad"), claim.frontier["cost"]
    problems = {(row["scene"], row["level"], row["seed"]) for row in judged_rows(runs, bad)}
    left_out = _left_out(runs, bad)
    shown = SHOWN.format(
        n=len(problems),
        left_out=f"; {left_out}" if left_out else "",
        sweep=claim.frontier["sweep"],
        cost=cost,
        asked=asked(claim.frontier),
    )
    paths = []
    for part in series.parts(names, _rank(claim, names), stem.name):
        some = {case: names[case] for case in part.names}
        if part.suffix:
            fig, axis = plt.subplots(figsize=(style.WIDE_IN / 1.6, 2.9), layout="constrained")
            numbers = _profiles(axis, runs, some, cost, bad)
        else:
            fig, (axis, table) = plt.subplots(
                1, 2, figsize=(style.WIDE_IN * 1.25, 2.9), layout="constrained", width_ratios=(1, 1.35)
            )
            numbers = _profiles(axis, runs, some, cost, bad) + _shares(
                table, runs, names, claim.frontier["axes"], bad
            )
            style.letter_panels([axis, table])
        handles, labels = axis.get_legend_handles_labels()
        fig.legend(handles, labels, loc="outside lower center", ncols=5, frameon=False)
        said = f"{part.says} {shown.replace('(a) ', '')}" if part.suffix else f"{shown}{SHARES} {part.says}"
        paths += style.save(fig, stem.with_name(stem.name + part.suffix), pd.DataFrame(numbers), said.strip())
    return paths
