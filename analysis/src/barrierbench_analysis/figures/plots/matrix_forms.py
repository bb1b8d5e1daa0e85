"""Condition number of the clamped and of the solved Newton matrix along one run: what papers compare, and
what is factorised.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.tables.records import LARGEST_COND, Records, condition_of, places_in_time

from .condition import BOUNDS

SCALINGS = (("none", "raw"), ("block_jacobi", "block-Jacobi-scaled"))
FORMS = (("clamped", "every element clamped", "-"), ("solved", "solved", ":"))
SHOWN = (
    "{group}, run {series}: condition number of two matrices of the same Newton iterations. Clamped: negative"
    " eigenvalues of every element set to 0, the matrix that papers compare. Solved: the one that was"
    " factorised, the exact Hessian or as far from it as positive definiteness asks; drawn where it is"
    " another. Forks without a line are bounds: the true condition number is at least as large. The Newton"
    " iterations of a step stand evenly within it. Left: as it is; right: scaled by block"
    " Jacobi."
)


def figure(records: Records, group: str, out: Path) -> list[Path]:
    """One figure of the first run of the group that has both matrices; none where no run has."""
    for _, row in style.runs_of(records.runs, group).iterrows():
        both = {
            (form, scaling): condition_of(records, row["run"], scaling, matrix=form)
            for form, _, _ in FORMS
            for scaling, _ in SCALINGS
        }
        if not both["solved", "none"].empty:
            return _draw(records, group, row, both, out)
    return []


def _draw(records: Records, group: str, row: pd.Series, both: dict, out: Path) -> list[Path]:
    fig, axes = plt.subplots(1, 2, figsize=(style.WIDE_IN, 2.6), sharex=True, layout="constrained")
    numbers = []
    color = style.look(row["formulation"]).color
    for axis, (scaling, title) in zip(axes, SCALINGS):
        for form, name, dash in FORMS:
            part = both[form, scaling].assign(at=lambda p: places_in_time(records, row["run"], p))
            part.loc[part["status"] == "singular", "cond"] = LARGEST_COND
            bound = part[part["status"].isin(BOUNDS) & part["cond"].notna()]
            part = part[part["status"] == "ok"]
            own = color if form == "clamped" else "#000000"
            line = {"color": own, "marker": "o", "markersize": 2.5, "linewidth": 0.9}
            axis.plot(part["at"], part["cond"], dash, **line, label=name)
            axis.plot(bound["at"], bound["cond"], "2", color=own, markersize=5, markeredgewidth=0.9)
            numbers.append(part)
        axis.set(xlabel="time (s)", ylabel="condition number")
        axis.set_title(title)
        style.log_if_decades(axis)
    fig.suptitle(f"{group}, run {row['series']}: the Newton matrix, clamped and as it was solved", fontsize=8)
    style.letter_panels(axes)
    style.legend_below(fig, axes[0])
    columns = "run matrix scaling step iteration cond lambda_min lambda_max".split()
    runs, shown = (
        records.runs[records.runs["run"] == row["run"]],
        SHOWN.format(group=group, series=row["series"]),
    )
    return style.save(fig, out / f"matrix_forms_{group}", pd.concat(numbers)[columns], shown, runs)
