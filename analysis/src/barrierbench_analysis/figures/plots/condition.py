"""Condition number of the Newton matrix over a run, raw and block-Jacobi-scaled; both ends of the spectrum in
a figure beside it.
"""

from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from barrierbench_analysis.figures import panels, style
from barrierbench_analysis.tables import series
from barrierbench_analysis.tables.records import LARGEST_COND, Records, condition_of, places_in_time

from . import swings

SCALINGS = {"none": "raw", "block_jacobi": "block-Jacobi-scaled"}
FIELDS = {"cond": "condition number", "lambda_max": "largest eigenvalue", "lambda_min": "smallest eigenvalue"}
LABELS = {"cond": "condition number", "lambda_max": r"$\lambda_{\max}$", "lambda_min": r"$\lambda_{\min}$"}
UNITS = {"none": " (N/m)", "block_jacobi": ""}
BOUNDS = ("lower_bound", "singular")
EIGENVALUES = "_eigenvalues" + series.MORE
SHOWN = (
    "{group}: {panels}, of {what}. Raw: as it is; scaled by block Jacobi: each 3 x 3 diagonal block made the"
    " identity (2 x 2 in planar scenes). Every diagnosed Newton iteration of a step is drawn at its share of"
    " that step, so that all runs stand at the same simulated time. Forks without a line are bounds: the true"
    " condition number is at least as large."
)


@dataclass(frozen=True)
class Panel:
    field: str
    scaling: str

    def name(self) -> str:
        return f"{FIELDS[self.field]}, {SCALINGS[self.scaling]}"


ALL = [Panel(field, scaling) for field in FIELDS for scaling in SCALINGS]


@dataclass(frozen=True)
class Group:
    """The runs of a figure, and the estimates of each with `at`, their place in time."""

    name: str
    runs: pd.DataFrame
    estimates: pd.DataFrame

    def what(self) -> str:
        literal = not self.runs.empty and (self.runs["step_solver"] == "article_literal").all()
        return (
            "the matrix before its Tikhonov term, as the article measures it"
            if literal
            else "the Newton matrix with every element clamped"
        )

    def of(self, row: pd.Series, scaling: str) -> pd.DataFrame:
        return self.estimates[(self.estimates["run"] == row["run"]) & (self.estimates["scaling"] == scaling)]


def _estimates(records: Records, group: str, runs: pd.DataFrame) -> pd.DataFrame:
    columns = "group series outcome run n step iteration stage scaling".split() + [*FIELDS, "status", "at"]
    tables = []
    for scaling in SCALINGS:
        for _, row in runs.iterrows():
            found = condition_of(records, row["run"], scaling)
            if not found.empty:
                at = places_in_time(records, row["run"], found)
                tables.append(found.assign(at=at, group=group, series=row["series"], outcome=row["outcome"]))
    return pd.concat(tables)[columns] if tables else pd.DataFrame(columns=columns)


def _chosen(group: Group, runs: pd.DataFrame, candidates: list[Panel]) -> tuple[list[Panel], str]:
    """The panels that these runs need, and the sentence on the others."""
    mine = group.estimates[group.estimates["run"].isin(runs["run"])].set_index(["run", "n"])
    sure, bounds = mine[mine["status"] == "ok"], mine[mine["status"].isin(BOUNDS)]
    only = [
        panel for panel in candidates if panel.scaling in set(bounds["scaling"]) - set(sure["scaling"])
    ]  # nothing there is equal to another panel's
    drawn = [
        panels.Panel(panel.name(), sure.loc[sure["scaling"] == panel.scaling, panel.field])
        for panel in candidates
        if panel not in only
    ]
    kept, left_out = panels.choose(drawn)
    return [panel for panel in candidates if panel in only or panel.name() in kept], left_out


def _draw_panel(
    axis, panel: Panel, group: Group, runs: pd.DataFrame, end_mark: bool
) -> list[tuple[str, swings.Band]]:
    """Returns what swings in it."""
    bands = []
    for _, row in runs.iterrows():
        estimates = group.of(row, panel.scaling).copy()
        estimates.loc[estimates["status"] == "singular", "cond"] = LARGEST_COND
        sure = estimates[estimates["status"] == "ok"]
        bound = estimates[estimates["status"].isin(BOUNDS) & estimates[panel.field].notna()]
        if not estimates.empty:
            last = int(
                (sure["step"] < sure["step"].max()).sum()
            )  # a cycle is one of the iterations of a step
            at, values = sure["at"].to_numpy(), sure[panel.field].to_numpy()
            bands += [(panel.name(), band) for band in swings.draw(axis, at, values, row, end_mark, last)]
            axis.plot(bound["at"], bound[panel.field], "2", markersize=4, color=style.look_of(row).color)
    style.log_if_decades(axis)
    style.keep_span(axis)
    if not axis.lines:
        style.not_measured(axis)
    unit = UNITS[panel.scaling] if panel.field != "cond" else ""
    axis.set(ylabel=LABELS[panel.field] + unit, title=SCALINGS[panel.scaling], xlabel="time (s)")
    return bands


def _draw(group: Group, runs: pd.DataFrame, shown: list[Panel], says: list[str], stem: Path) -> list[Path]:
    fig, drawn = panels.grid(len(shown), style.WIDE_IN, 2.6, most=2)
    bands = [
        band
        for axis, panel in zip(drawn, shown)
        for band in _draw_panel(axis, panel, group, runs, end_mark=panel.field == "cond")
    ]
    style.letter_panels(drawn)
    fig.suptitle(f"{group.name}: {group.what()}", fontsize=8)
    style.legend_below(fig, drawn[0], group.runs)
    names = "; ".join(panel.name() for panel in shown)
    text = SHOWN.format(group=group.name, what=group.what(), panels=names)
    words = [text, swings.sentence(bands, "{:.3g} s"), *says, style.marker_sentence(group.runs)]
    table = group.estimates[group.estimates["run"].isin(runs["run"])].drop(columns="at")
    return style.save(fig, stem, table, " ".join(filter(None, words)), runs)


def figure(records: Records, group: str, out: Path, name: str = "") -> list[Path]:
    """`name` (condition_GROUP), what it has no room for in NAME_more, and the eigenvalues of its series in a
    third; their files.
    """
    runs = style.runs_of(records.runs, group)
    found, paths = Group(group, runs, _estimates(records, group, runs)), []
    name = name or f"condition_{group}"
    for part, some in series.parts_of_runs(runs, name):
        main = part.suffix == ""
        kept, left_out = _chosen(found, some, [panel for panel in ALL if main or panel.field == "cond"])
        eigenvalues = [panel for panel in kept if panel.field != "cond"]
        where = f"Eigenvalues: {name}{EIGENVALUES}." if eigenvalues else ""
        if not main and not eigenvalues:
            where = "Their eigenvalues: in the CSV."
        cond = [panel for panel in kept if panel.field == "cond"]
        paths += _draw(found, some, cond, [part.says, where, left_out], out / f"{name}{part.suffix}")
        if eigenvalues:
            beside = [f"Beside {name}.", left_out]
            paths += _draw(found, some, eigenvalues, beside, out / f"{name}{EIGENVALUES}")
    return paths
