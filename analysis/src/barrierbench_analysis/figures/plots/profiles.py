"""Who solves how many problems at what cost: performance profiles (Dolan and More 2002), data profiles (More
and Wild 2009), and ratios of costs pair by pair.
"""

import math
from pathlib import Path

import numpy as np
import pandas as pd

from barrierbench_analysis.figures import panels, style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.tables.robustness import Trial, profile
from barrierbench_analysis.tables.statistics import spread
from barrierbench_analysis.tables.words import reservations

from .drawing import Drawing, SweepRecords, common, formulations, outcomes

COSTS = {
    "newton_iterations": "Newton iterations",
    "linear_solves": "linear solves",
    "line_search_trials": "line search trials",
    "ccd_queries": "CCD queries",
    "solve_s": "seconds",
}
OPTIONS = {"costs": ["newton_iterations", "line_search_trials"]}
SOLVED = (
    "A problem is a scene of the sweep, and is solved by a run that ends ok and valid; {apart} of the"
    " {solved} solved runs are not comparable with the log: their contacts rest at other gaps"
)
PERFORMANCE = (
    "Share of the problems that a formulation solves at no more than so many times the least cost that any of"
    " them has there: {costs}; a line that ends below 1 leaves the rest unsolved. Last panel: cost of the row"
    " over that of the column, with the number of problems that both solve."
)
DATA = "Share of the problems that a formulation solves with no more than so much work: {costs}."


def trials(runs: pd.DataFrame, cost: str) -> pd.DataFrame:
    """A row a run: formulation, problem (the words of its case that do not name the formulation), cost,
    solved, apart (solved, but not comparable).
    """
    problems = [
        " ".join(word for word in series.split() if word != formulation)
        for series, formulation in zip(runs["series"], runs["formulation"])
    ]
    solved = (runs["outcome"] == "ok") & runs["valid"].astype(bool)
    return pd.DataFrame(
        {
            "formulation": runs["formulation"],
            "problem": problems,
            "cost": pd.to_numeric(runs[cost]).astype(float),
            "solved": solved,
            "apart": solved & (runs["comparability_verdict"] == "not_comparable"),
            "outcome": runs["outcome"],
        }
    ).reset_index(drop=True)


def ratios(found: pd.DataFrame) -> pd.DataFrame:
    """Cost over the least cost of any formulation in the same problem, a row a problem and a column a
    formulation; inf where it is not solved. Errors: ValueError where a formulation has a problem twice.
    """
    costs = found.assign(cost=found["cost"].where(found["solved"], math.inf))
    table = costs.pivot(index="problem", columns="formulation", values="cost").fillna(math.inf)
    least = table.min(axis=1)
    return table.div(least.where(np.isfinite(least), 1.0), axis=0)


def performance(found: pd.DataFrame, formulation: str) -> list[tuple[float, float]]:
    """(ratio, share of all problems that it solves at no more than it), at each ratio that occurs."""
    of = ratios(found)[formulation]
    solved = sorted(of[np.isfinite(of)])
    return [(r, (k + 1) / len(of)) for k, r in enumerate(solved) if k + 1 == len(solved) or solved[k + 1] > r]


def data(found: pd.DataFrame, formulation: str) -> list[tuple[float, float]]:
    """(budget, share of all problems that it solves with no more)."""
    mine = found[found["formulation"] == formulation]
    return profile([Trial(r.problem, 0.0, bool(r.solved), float(r.cost)) for r in mine.itertuples()])


def pairwise(found: pd.DataFrame) -> pd.DataFrame:
    """Geometric mean of cost of `over` divided by that of `under`, over the `n` problems that both solve."""
    good = found[found["solved"] & (found["cost"] > 0)]
    logs = np.log(good.pivot(index="problem", columns="formulation", values="cost"))
    rows = []
    for over in formulations(found):
        for under in formulations(found):
            both = (
                (logs[over] - logs[under]).dropna() if {over, under} <= set(logs) else pd.Series(dtype=float)
            )
            mean = spread(both)[0] if len(both) else math.nan
            rows.append({"over": over, "under": under, "ratio": mean, "n": len(both)})
    return pd.DataFrame(rows)


def draw_steps(axis, points: list[tuple[float, float]], formulation: str, most: float) -> None:
    """A staircase from the first solved problem on to the edge of the panel."""
    label = formulation if points else f"{formulation} (solves none)"
    line = style.look(formulation).line(markevery=style.marks(len(points) + 1, 6), label=label)
    corners = [*points, (most, points[-1][1])] if points else []
    axis.plot(*zip(*corners) if corners else ([], []), drawstyle="steps-post", **line)


def draw_pairs(axis, pairs: pd.DataFrame) -> None:
    """Numbers in cells; rows over columns."""
    names = list(dict.fromkeys(pairs["over"]))
    table = pairs.pivot(index="over", columns="under", values="ratio").loc[names, names]
    counts = pairs.pivot(index="over", columns="under", values="n").loc[names, names]
    shade = np.log(table.to_numpy())
    limit = max(np.nanmax(np.abs(shade), initial=0.0), math.log(1.1))
    axis.imshow(shade, cmap="cividis", vmin=-limit, vmax=limit, aspect="auto")
    for (i, j), ratio in np.ndenumerate(table.to_numpy()):
        words = f"{ratio:.2f}\n{counts.iat[i, j]}" if counts.iat[i, j] else "none"
        color = "black" if shade[i, j] > 0 else "white"
        axis.text(j, i, words, ha="center", va="center", fontsize=5.5, color=color)
    for ticks in (axis.set_xticks, axis.set_yticks):
        ticks(range(len(names)), [name.replace("_", "\n") for name in names], fontsize=5)
    axis.grid(False)


def judged_alike(runs: pd.DataFrame) -> tuple[pd.DataFrame, str]:
    """The runs whose audit judges obstacles as that of most runs does, by surfaces or by points, since others
    are not the same success; what of the others is to be said.
    """
    if "audit_obstacles_judge" not in runs:
        return runs, ""
    judges = runs["audit_obstacles_judge"].fillna("surface")
    judge = judges.value_counts().sort_index(ascending=False).idxmax()  # surface before points
    others = int((judges != judge).sum())
    text = f"{others} runs whose audit does not judge obstacles by `{judge}` are left out" if others else ""
    return runs[judges == judge], text


def _facts(runs: pd.DataFrame, left_out: str, found: pd.DataFrame, statistic: str) -> Facts:
    problems = found["problem"].nunique()
    solved = runs[(runs["outcome"] == "ok") & runs["valid"].astype(bool)]
    held = [(row["series"], why) for _, row in solved.iterrows() if (why := reservations(row))]
    reserved = "; ".join(f"{series} ({', '.join(why)})" for series, why in held)
    return Facts(
        f"{problems} problems, {outcomes(runs)}",
        statistic,
        "the cheapest formulation of each problem" if "ratio" in statistic else "none",
        f"problems {', '.join(dict.fromkeys(found['problem']))};"
        f" {common(runs, 'scene_free_dofs')};"
        f" {SOLVED.format(apart=int(found['apart'].sum()), solved=int(found['solved'].sum()))}"
        + (f"; {len(held)} solved runs are ok with a reservation: {reserved}" if held else "")
        + (f"; {left_out}" if left_out else ""),
    )


def _draw(subject: SweepRecords, drawing: Drawing, points_of, more: int, axis_words: str):
    """Figure, its panels, the runs and what is left out of them, the trials of every cost, and the numbers
    that were drawn.
    """
    (runs, left_out), costs = judged_alike(subject.records.runs), drawing.options["costs"]
    of = {cost: trials(runs, cost) for cost in costs}
    if not any(found["solved"].any() for found in of.values()):
        raise drawing.nothing(f"no run solves a problem ({outcomes(runs)})")
    fig, axes = panels.grid(len(costs) + more, drawing.width_in, 2.3)
    rows = []
    for axis, (cost, found) in zip(axes, of.items()):
        lines = {name: points_of(found, name) for name in formulations(runs)}
        most = 1.05 * max(x for points in lines.values() for x, _ in points)
        for name, points in lines.items():
            draw_steps(axis, points, name, most)
            rows += [{"cost": cost, "formulation": name, "at": x, "share": y} for x, y in points]
        axis.set(xscale="log", ylim=(0, 1.04), xlabel=axis_words.format(COSTS[cost]))
    axes[0].set_ylabel("share of problems")
    return fig, axes, (runs, left_out), of, pd.DataFrame(rows)


def performance_profile(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    fig, axes, runs, of, numbers = _draw(subject, drawing, performance, 1, "{} / least")
    costs, (cost, first) = [COSTS[cost] for cost in of], next(iter(of.items()))
    pairs = pairwise(first)
    draw_pairs(axes[-1], pairs)
    axes[-1].set_xlabel(f"{costs[0]}: row / column")
    statistic = "ratio to the least cost of a problem; cells: geometric mean of the ratio, and n"
    numbers = pd.concat([numbers, pairs.assign(cost=cost)], ignore_index=True)
    shown, facts = PERFORMANCE.format(costs=", ".join(costs)), _facts(*runs, first, statistic)
    return drawing.finish(fig, axes, numbers, shown, facts, runs=runs[0])


def data_profile(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    fig, axes, runs, of, numbers = _draw(subject, drawing, data, 0, "budget: {}")
    facts = _facts(*runs, next(iter(of.values())), "share of all problems, failed ones among them")
    shown = DATA.format(costs=", ".join(COSTS[cost] for cost in of))
    return drawing.finish(fig, axes, numbers, shown, facts, runs=runs[0])
