"""One figure a scene: what a run takes against the gap it reaches, the stiffness as the parameter of the
path.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from barrierbench_analysis.figures import panels, style
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.tables import series
from barrierbench_analysis.tables.statistics import geometric

from .fronts import Runs, failures

PANELS = {
    "cond_p95": "cond, raw",
    "cond_bj_p95": "cond, block Jacobi",
    "cond_no_contact_p95": "cond, no contact",
    "cond_no_contact_no_limit_p95": "cond, no contact, no limit",
    "newton": "Newton iterations",
    "pcg_probe": "PCG iterations (probe)",
    "seconds": "seconds",
    "scale": "stiffness / matched",
}
PAGE_IN = style.WIDE_IN * 1.35  # wider on the page of the study than in a journal
SHOWN = (
    "{scene}: what a run takes against the {gap} gap at its step ends, in units of d_hat. Along a line the"
    " stiffness of one formulation grows over {decades:g} decades round the value that equal force gives it"
    " (last panel); thick: geometric means over {starts} jittered starts, thin: each start; lines are broken"
    " where a run failed. Compare at equal gap, that is along a vertical line. {failed} cond: 95th percentile"
    " of the condition number over the iterations of a run. Seconds depend on the machine."
)
FAILED = "Not drawn, since runs that failed or were never in contact at a step end have no gap: {runs}."


def _means(runs: Runs, rows: list[Row], name: str) -> dict[float, tuple[float, float] | None]:
    """Scale -> (gap, value), the scales growing; None where a start failed, which breaks the line."""
    found = {}
    for scale in runs.scales:
        of_scale = [row for row in rows if runs.scale(row) == scale]
        good = [row for row in of_scale if runs.gap(row) and runs.value(row, name)]
        found[scale] = (
            (geometric(map(runs.gap, good)), geometric(runs.value(row, name) for row in good))
            if good and len(good) == len(of_scale)
            else None
        )
    return found


def _path(axis, found: dict[float, tuple[float, float] | None], **how) -> None:
    points = found.values()
    axis.plot(
        [np.nan if p is None else p[0] for p in points],
        [np.nan if p is None else p[1] for p in points],
        **how,
    )


def failure_sentence(runs: Runs, scene: str, formulations: tuple[str, ...]) -> str:
    """Which runs of the scene are not drawn; empty where all are."""
    starts = len(runs.seeds)
    of_each = {name: failures(runs, scene, name) for name in formulations}

    def word(scale: float, n: int) -> str:
        return f"x{scale:g}" if n == starts else f"x{scale:g} ({n} of {starts} starts)"

    words = [
        f"{name} at {', '.join(word(scale, ends.total()) for scale, ends in found.items())}"
        for name, found in of_each.items()
        if found
    ]
    return FAILED.format(runs="; ".join(words)) if words else ""


def _panels(runs: Runs) -> dict[str, str]:
    """Metric -> title, of those that the study has."""
    return {name: title for name, title in PANELS.items() if name in (*runs.metrics, "scale")}


def _numbers(runs: Runs, scene: str) -> pd.DataFrame:
    """A row a metric, formulation and scale; without gap and value where a start has none, and `failed` says
    how many.
    """
    rows = []
    for name in _panels(runs):
        for formulation in runs.formulations:
            bad = failures(runs, scene, formulation)
            for scale, point in _means(runs, runs.of(scene, formulation), name).items():
                rows.append(
                    {
                        "scene": scene,
                        "metric": name,
                        "formulation": formulation,
                        "scale": scale,
                        "gap": point and point[0],
                        "value": point and point[1],
                        "failed": bad[scale].total() if scale in bad else 0,
                    }
                )
    return pd.DataFrame(rows)


def _draw_panel(axis, runs: Runs, scene: str, name: str, formulations: tuple[str, ...]) -> None:
    for formulation in formulations:
        rows, look = runs.of(scene, formulation), style.look(formulation)
        for seed in runs.seeds:
            of_start = _means(runs, [row for row in rows if row.place["seed"] == seed], name)
            _path(axis, of_start, color=look.color, linewidth=0.5, alpha=0.35)
        how = {"linestyle": look.dash, "marker": look.marker, "label": formulation}
        _path(axis, _means(runs, rows, name), color=look.color, **how)
    axis.set(xscale="log", yscale="log")
    axis.set_title(PANELS[name], fontsize=7)
    style.keep_span(axis)


def draw(runs: Runs, scene: str, stem: Path, width_in: float = PAGE_IN) -> list[Path]:
    """stem.png and its company, and stem_more with the formulations that it has no room for. width_in: of the
    figure. The scene has a run that reached a gap.
    """
    numbers, paths = _numbers(runs, scene), []
    for part in series.parts(runs.formulations, series.ranked(runs.formulations), stem.name):
        mine = numbers[numbers["formulation"].isin(part.names)]
        drawn = mine.dropna(subset="value").set_index(["formulation", "scale"])
        kept, left_out = panels.choose(
            [
                panels.Panel(title, drawn.loc[drawn["metric"] == name, "value"])
                for name, title in _panels(runs).items()
            ]
        )
        fig, axes = panels.grid(len(kept), width_in, 2.2)
        for axis, name in zip(axes, [name for name, title in _panels(runs).items() if title in kept]):
            _draw_panel(axis, runs, scene, name, part.names)
            axis.set_xlabel(rf"{runs.gap_words} gap / $\hat d$")
        style.letter_panels(axes)
        style.legend_below(fig, axes[0])
        fig.suptitle(scene, fontsize=8)
        shown = SHOWN.format(
            scene=scene,
            gap=runs.gap_words,
            decades=runs.decades,
            starts=len(runs.seeds),
            failed=failure_sentence(runs, scene, part.names),
        )
        paths += style.save(
            fig,
            stem.with_name(stem.name + part.suffix),
            mine,
            " ".join(filter(None, [shown, left_out, part.says])),
        )
    return paths
