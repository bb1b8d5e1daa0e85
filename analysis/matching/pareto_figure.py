"""One figure a scene: what a run takes against the gap it reaches, the stiffness as the parameter of the path."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from .. import style
from .fronts import Runs

PANELS = (("cond_p95", "cond, raw"), ("cond_bj_p95", "cond, block Jacobi"), ("cond_no_contact_p95", "cond, no contact"),
          ("cond_no_contact_no_limit_p95", "cond, no contact, no limit"), ("newton", "Newton iterations"), ("pcg_probe", "PCG iterations (probe)"),
          ("seconds", "seconds"), ("scale", "stiffness / matched"))
EDGE = 0.6  # times the smallest gap: where failed runs stand
SHOWN = ("{scene}: what a run takes against the smallest gap at its step ends, in units of d_hat. Along a line the stiffness of one formulation grows over {decades:g} decades round the "
         "value that equal force gives it (last panel); thick: geometric means over {starts} jittered starts, thin: each start; lines are broken where a run failed. Compare at "
         "equal gap, that is along a vertical line. Hollow markers left of the dotted line: runs that failed or were never in contact at a step end; what they took until then has "
         "no gap, and a collapsed run has an excellent condition number. cond: 95th percentile of the condition number over the iterations of a run. Seconds depend on the machine.")


def _geometric(values: list[float]) -> float:
    return float(np.exp(np.mean(np.log(values))))


def _means(rows: list[dict], name: str) -> list[tuple[float, float] | None]:
    """(gap, value) a scale, in order of the scale; None where a start failed, which breaks the line."""
    found = []
    for scale in sorted({row["scale"] for row in rows}):
        of_scale = [row for row in rows if row["scale"] == scale]
        good = [row for row in of_scale if row["outcome"] == "ok" and row["gap"] and row[name]]
        found.append((_geometric([r["gap"] for r in good]), _geometric([r[name] for r in good])) if len(good) == len(of_scale) else None)
    return found


def _path(axis, found: list[tuple[float, float] | None], **how) -> None:
    axis.plot([np.nan if p is None else p[0] for p in found], [np.nan if p is None else p[1] for p in found], **how)


def _failed(rows: list[dict], name: str) -> list[float]:
    """One number a scale at which some start failed: the mean of those starts."""
    found = []
    for scale in sorted({row["scale"] for row in rows}):
        bad = [row[name] for row in rows if row["scale"] == scale and (row["outcome"] != "ok" or not row["gap"]) and row[name]]
        found += [_geometric(bad)] if bad else []
    return found


def _panel(axis, runs: Runs, scene: str, name: str, edge: float) -> list[dict]:
    numbers = []
    for formulation in runs.formulations:
        rows, look = runs.of(scene, formulation), style.look(formulation)
        for seed in runs.seeds():
            _path(axis, _means([r for r in rows if r["seed"] == seed], name), color=look.color, linewidth=0.5, alpha=0.35)
        means = _means(rows, name)
        _path(axis, means, color=look.color, linestyle=look.dash, marker=look.marker, label=formulation)
        failed = _failed(rows, name)
        axis.plot([edge] * len(failed), failed, color=look.color, marker=look.marker, linestyle="none", markerfacecolor="none", markeredgewidth=0.8)
        scales = sorted({row["scale"] for row in rows})
        numbers += [{"scene": scene, "metric": name, "formulation": formulation, "scale": s, "gap": p[0], "value": p[1]} for s, p in zip(scales, means) if p]
    axis.set(xscale="log", yscale="log")
    axis.axvline(edge / EDGE**0.5, color="#666666", linewidth=0.6, linestyle=":", gid=style.REFERENCE)
    style.keep_span(axis)
    return numbers


def draw(runs: Runs, scene: str, stem: Path) -> list[Path]:
    """stem.png and its company. Errors: ValueError when no run of the scene reached a gap."""
    gaps = [row["gap"] for row in runs.rows if row["scene"] == scene and row["gap"] and row["outcome"] == "ok"]
    if not gaps:
        raise ValueError(f"{scene}: no run reached a gap: there is nothing to draw")
    fig, axes = plt.subplots(2, 4, figsize=(style.WIDE_IN * 1.35, 4.9), layout="constrained", sharex=True)
    numbers = []
    for axis, (name, title) in zip(axes.flat, PANELS):
        numbers += _panel(axis, runs, scene, name, EDGE * min(gaps))
        axis.set_title(title, fontsize=7)
    style.letter_panels(axes)
    for axis in axes[-1]:
        axis.set_xlabel(r"smallest gap / $\hat d$")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    handles.append(plt.Line2D([], [], color="#444444", marker="o", markerfacecolor="none", linestyle="none"))
    fig.legend(handles, [*labels, "failed (no gap)"], loc="outside lower center", ncols=6, frameon=False)
    fig.suptitle(scene, fontsize=8)
    return style.save(fig, stem, pd.DataFrame(numbers), SHOWN.format(scene=scene, decades=runs.about["decades"], starts=runs.about["starts"]))
