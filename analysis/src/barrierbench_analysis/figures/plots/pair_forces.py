"""Forces between bodies over time, of runs that kept them (/output/pair_forces)."""

from pathlib import Path

import pandas as pd

from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.tables.run import Run

from .drawing import Drawing, SweepRecords, common, each, outcomes

SHOWN = (
    "Sums of the forces of all contacts between two bodies at the end of every time step: {panels}. One line"
    " for each two bodies, named at its end; an obstacle is a body, and a body that touches itself stands"
    " beside itself."
)
PANELS = {"normal_N": "normal force (N)", "friction_N": "friction force (N)"}
COLUMNS = ["formulation", "run", "outcome", "t_s", "pair", "contacts", *PANELS]


def table(pairs: list[tuple[pd.Series, Run]]) -> pd.DataFrame:
    """A row a run, a step and two bodies; steps in which they do not touch have a row with 0."""
    found = []
    for row, run in pairs:
        forces = run.pair_forces
        forces = forces.assign(pair=forces["body_a"] + ", " + forces["body_b"])
        every = pd.MultiIndex.from_product([run.steps["t_s"], forces["pair"].unique()], names=["t_s", "pair"])
        of_pairs = forces.set_index(["t_s", "pair"])[["contacts", *PANELS]]
        steps = of_pairs.reindex(every, fill_value=0).reset_index()
        found.append(
            steps.assign(formulation=row["formulation"], run=row["run"], outcome=row["outcome"])[COLUMNS]
        )
    return pd.concat(found) if found else pd.DataFrame(columns=COLUMNS)


def _draw(axis, found: pd.DataFrame, measure: str) -> None:
    ends: dict[str, tuple[float, float]] = {}
    for _, name, mine, look in each(found):
        for number, ((_, pair), line) in enumerate(mine.groupby(["run", "pair"], sort=True)):
            label = name if number == 0 else "_"
            axis.plot(line["t_s"], line[measure], **look.line(marker="", label=label))
            ends.setdefault(pair, (line["t_s"].iloc[-1], line[measure].iloc[-1]))
    for pair, end in ends.items():
        axis.annotate(pair, end, (2, 0), textcoords="offset points", fontsize=6, va="center")
    axis.set(xlabel="time (s)", ylabel=PANELS[measure])
    axis.margins(x=0.02)


def figure(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    runs, found = subject.records.runs, table(subject.each_run())
    measures = [name for name in PANELS if (found[name] != 0).any()]
    if not measures:
        raise drawing.nothing(f"no two bodies touch ({outcomes(runs)})")
    fig, axes = drawing.panels(len(measures), 2.8)
    for axis, measure in zip(axes, measures):
        _draw(axis, found, measure)
    facts = Facts(
        f"{outcomes(runs)}; {found['pair'].nunique()} pairs of bodies",
        "sums over the contacts of two bodies at the end of a step",
        "none: every step is drawn",
        common(runs, "scene steps dt_s d_hat_m matching_rule matching_theta"),
    )
    shown = SHOWN.format(panels=" and ".join(PANELS[name].removesuffix(" (N)") for name in measures))
    return drawing.finish(fig, axes, found, shown, facts, runs=runs)
