"""What the runs of a large group cost against the gap that their contacts reach: a mark for each run."""

from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.tables import run_words

from .comparison import METRICS
from .gather import Entry

SHOWN = (
    "{group}: (a) to (c) cost of each run against its smallest gap at the end of a converged step, in"
    " units of"
    " d_hat: median condition number after block-Jacobi scaling, Newton iterations over all steps, median PCG"
    " iterations on the diagnosed matrices. A mark is a run. {failed}"
)
COSTS = ("cond_bj", "newton", "pcg")


def _table(entries: list[Entry], group: str) -> pd.DataFrame:
    costs = [metric for metric in METRICS if metric.key in COSTS]
    columns = ("formulation", "outcome", "comparability_verdict")
    return pd.DataFrame(
        [
            {"group": group, "run": entry.run, **{name: entry.row.get(name) for name in columns}}
            | {"gap_min_rel": entry.row.get("gap_min_rel_min")}
            | {metric.key: metric.of(entry) for metric in costs}
            for entry in entries
        ]
    )


def _draw(axis, table: pd.DataFrame, cost: str) -> None:
    for formulation, rows in table.groupby("formulation", sort=False):
        look = style.look(formulation)
        for is_solid, some in rows.groupby([not run_words.verdict_word(row) for _, row in rows.iterrows()]):
            label = formulation if is_solid or rows["outcome"].ne("ok").all() else "_"
            face = look.color if is_solid else "none"
            mark = look.line(
                linestyle="none", markerfacecolor=face, markeredgewidth=0.8, alpha=0.75, label=label
            )
            axis.plot(some["gap_min_rel"].astype(float), some[cost].astype(float), **mark)


def figure(entries: list[Entry], group: str, out: Path) -> list[Path]:
    """marks_GROUP.png of a group; runs that failed before they had a gap are counted in the caption."""
    table = _table(entries, group)
    fig, axes = plt.subplots(1, 3, figsize=(style.WIDE_IN, 3.0), layout="constrained")
    names = {metric.key: metric.heading for metric in METRICS}
    for axis, cost in zip(axes, COSTS):
        _draw(axis, table, cost)
        values = table[["gap_min_rel", cost]].apply(pd.to_numeric).dropna()
        if values.empty:
            style.not_measured(axis)
        elif (values["gap_min_rel"] > 0).all():
            axis.set_xscale("log")
        style.log_if_decades(axis)
        axis.set(xlabel="smallest gap / d_hat", ylabel=names[cost])
    style.letter_panels(axes)
    handles = {text: line for axis in axes for line, text in zip(*axis.get_legend_handles_labels())}
    if handles:
        fig.legend(handles.values(), handles, loc="outside lower center", ncols=4, frameon=False)
    without = int(table["gap_min_rel"].isna().sum())
    failed = f"{without} of {len(table)} runs have no such gap and no mark. " if without else ""
    hollow = "Hollow: the run failed, is not valid or not comparable with its reference."
    rows = pd.DataFrame([entry.row | {"series": entry.row["formulation"]} for entry in entries])
    shown = SHOWN.format(group=group, failed=failed + hollow)
    return style.save(fig, out / f"marks_{group}", table, shown, rows)[:1]
