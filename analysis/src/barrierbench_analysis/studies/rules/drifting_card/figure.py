"""docs/drifting_card.png: drift and tangential force over the length of the table's edges."""

from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.studies.kit.study.store import Row

from . import arms
from .arms import Arm
from .report import METRICS, Found, gathered

LABELS = {"drift_m": "drift, mm", "pull": "tangential /\nnormal force, 1e-3"}
SHOWN = (
    "A frictionless card that rests on a flat table of triangles, by contact model (columns): drift of its"
    " centre in 0.6 s (upper row) and tangential over normal contact force at rest (lower row), over the"
    " length of the table's edges. Means over {placements} placements; bars are 95% intervals by Student's t,"
    " cut off at the lower edge. On an analytic plane every one of these numbers is below {plane}. A model"
    " that a formulation refuses has no line."
)


def _line(axis, study: Study, found: dict[Arm, Found], model: str, name: str, value: str) -> list[dict]:
    """One formulation. Returns what is drawn."""
    factor, drawn = METRICS[value][1], []
    for k, level in enumerate(study.about["tables"]):
        one = found.get(Arm(name, model, level))
        if one and (mean := one.mean(value)):
            ends = [mean.value if end is None else end for end in (mean.lower, mean.upper)]
            numbers = dict(zip(("mean", "lower", "upper"), (mean.value, *ends)))
            place = {"place": k, "model": model, "formulation": name, "level": level, "value": value}
            drawn.append(place | {key: factor * number for key, number in numbers.items()})
    if drawn:
        table, look = pd.DataFrame(drawn), style.look(name)
        shift = 0.05 * (study.about["drawn"].index(name) - len(study.about["drawn"]) / 2)
        bars = [table["mean"] - table["lower"], table["upper"] - table["mean"]]
        axis.errorbar(
            table["place"] + shift, table["mean"], bars, **look.line(label=name), elinewidth=0.6, markersize=4
        )
    return drawn


def draw(study: Study, rows: list[Row], stem: Path) -> list[Path]:
    """stem: of the files."""
    found, levels = gathered(study, rows), [*study.about["tables"]]
    models = [one for one in arms.models() if one not in study.about["once"]]
    how = {"sharex": True, "sharey": "row", "layout": "constrained", "squeeze": False}
    fig, axes = plt.subplots(len(LABELS), len(models), figsize=(style.WIDE_IN, 4.2), **how)
    drawn: list[dict] = []
    for row, value in zip(axes, LABELS, strict=True):
        for axis, model in zip(row, models, strict=True):
            for name in study.about["drawn"]:
                drawn += _line(axis, study, found, model, name, value)
            axis.set(yscale="log")
        row[0].set_ylabel(LABELS[value])
        means = [one["mean"] for one in drawn if one["value"] == value and one["mean"] > 0]
        row[0].set_ylim(min(means) / 3, max(means) * 4)
    for axis, model in zip(axes[0], models, strict=True):
        axis.set_title(model, fontsize=8)
    for axis in axes[-1]:
        axis.set_xticks(range(len(levels)), [level.removesuffix("mm") for level in levels])
        axis.set_xlabel("table's edges, mm")
    style.legend_below(fig, axes[0, 0])
    plane = [
        METRICS[value][1] * mean.value
        for arm, one in found.items() if arm.model == arms.PLANE
        for value in LABELS if (mean := one.mean(value))
    ]  # fmt: skip
    shown = SHOWN.format(placements=study.about["placements"], plane=f"{max(plane):.1g}" if plane else "-")
    return style.save(fig, stem, pd.DataFrame(drawn), shown)
