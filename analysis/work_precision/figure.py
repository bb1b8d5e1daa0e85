"""docs/work_precision_SCENE.png: error against four costs; docs/work_precision_profile.png: how many problems are solved within a budget."""

from __future__ import annotations

import math
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from .. import style
from .judge import COSTS, aside, band_of, formulations, front, points, profile

ERRORS = {"e_traj": "largest distance of a vertex / scene", "e_com": "distance of centres of mass / scene", "e_gap": "|gap - closed form| / d_hat",
          "e_offset": "excess height at rest (m)", "e_momentum": "|change of momentum| / momentum", "e_energy": "|change of energy| / energy"}
SHOWN = ("{scene}, {error} against what it cost: {n} runs of every formulation and solver (tolerance, time step, d_hat and stiffness each varied round one anchor). "
         "Small marks: runs; lines: the runs of a formulation that none of its cheaper ones equals. Reference: {reference}.{band}{aside} Crosses at the upper edge: runs "
         "that failed or are not valid, at what they had cost by then ({failed} of {runs} in panels a to c, {failed_pcg} of {runs} in d). Panels a to c: "
         "direct solver; d: conjugate gradients with block Jacobi, the same settings.")
ASIDE = " Faint marks: other time steps, which are not ranked, since the reference has the time step of the run and sees no error in time."
PROFILE = ("Share of the problems (scene, variation) that were solved with at most that work: the run counts and its error is at most the target of its scene ({targets}). "
           "Failed runs are never solved. Other time steps are no problems in scenes with refined references, which see no error in time. {n} problems a formulation; the direct solver, for products conjugate gradients with block Jacobi.")


def _panel(axis, scene: dict, cost: str) -> list[dict]:
    all_points, band = points(scene, cost), band_of(scene)
    drawn = [(p, True) for p in all_points] + [(p, False) for p in aside(scene, cost)]
    drawn = [(p, ranked) for p, ranked in drawn if 0 < p.cost < math.inf]
    rows: list[dict] = []
    for name in formulations(scene):
        look = style.look(name)
        mine = [(p, ranked) for p, ranked in drawn if p.formulation == name]
        for opacity, which in ((0.45, True), (0.15, False)):
            good = [p for p, ranked in mine if p.error is not None and ranked == which]
            axis.plot([p.cost for p in good], [p.error for p in good], linestyle="none", marker=look.marker, color=look.color, markersize=2.6, alpha=opacity, markeredgewidth=0)
        line = [(c, e) for c, e in front(all_points, name) if c > 0]
        if line:
            axis.plot([c for c, _ in line], [e for _, e in line], color=look.color, linestyle=look.dash, marker=look.marker, markersize=4, label=name)
        else:
            axis.plot([], [], color=look.color, linestyle=look.dash, marker=look.marker, label=f"{name} (no run counts)")
        rows += [{"against": cost, **p.__dict__, "ranked": ranked} for p, ranked in mine]
    axis.set_xscale("log")
    axis.set_yscale("log")
    for p, _ in drawn:
        if p.error is None:
            axis.plot([p.cost], [0.96], transform=axis.get_xaxis_transform(), marker="x", color=style.look(p.formulation).color, linestyle="none", markersize=5,
                      markeredgewidth=1.2, gid=style.FAILURE)
    if band > 0:
        axis.axhspan(band / 1e6, band, color="#bbbbbb", alpha=0.5, linewidth=0, zorder=0, gid=style.REFERENCE)
    axis.set_xlabel({"seconds": "seconds"}.get(cost, COSTS[cost][1]))
    return rows


def _limits(scene: dict) -> tuple[float, float]:
    """Of the errors, with room above for the crosses of failed runs and below for the band."""
    errors = [max(r["error"], band_of(scene, r), 1e-300) for r in scene["rows"] if r["error"] is not None] or [1.0]
    low, high = min(errors), max(errors)
    room = max(high / low, 10.0)
    return (min(low, band_of(scene) or low) / room**0.1, high * room ** (0.2 if any(r["error"] is None for r in scene["rows"]) else 0.05))


def draw(scene: dict, stem: Path) -> list[Path]:
    """The figure of one scene of results/work_precision.json."""
    fig, axes = plt.subplots(2, 2, figsize=(style.WIDE_IN, 5.4), sharey=True, layout="constrained")
    rows = [row for axis, cost in zip(axes.flat, COSTS) for row in _panel(axis, scene, cost)]
    for axis in axes[:, 0]:
        axis.set_ylabel(ERRORS[scene["error"]])
    axes[0, 0].set_ylim(*_limits(scene))
    style.letter_panels(axes)
    style.legend_below(fig, axes[0, 0])
    failed = {solver: sum(r["error"] is None for r in scene["rows"] if r["solver"] == solver) for solver in ("direct", "pcg")}
    runs, band = sum(r["solver"] == "direct" for r in scene["rows"]), band_of(scene)
    shown = SHOWN.format(scene=scene["name"], error=scene["error"], n=runs // len(formulations(scene)), reference=scene["references"][0]["name"],
                         band=f" Grey: its own uncertainty, {band:.2g}; what lies in it is not ranked and is drawn at its edge." if band else "",
                         aside=ASIDE if aside(scene, "newton") else "", failed=failed["direct"],
                         failed_pcg=failed["pcg"], runs=runs)
    return style.save(fig, stem, pd.DataFrame(rows), f"{shown} {machine(scene)}")


def machine(scene: dict) -> str:
    about = scene["about"]
    return f"{about['unknowns']} unknowns; {about['machine']}; commit {about['commit']}; {about['date']}."


def draw_profile(scenes: list[dict], stem: Path) -> list[Path]:
    """Data profiles over all scenes: one row a target level, one column a cost."""
    names = formulations(scenes[0])
    levels = range(max(len(scene["targets"]) for scene in scenes))
    shown = ("newton", "factorizations", "products")
    fig, axes = plt.subplots(len(levels), len(shown), figsize=(style.WIDE_IN, 0.8 + 1.7 * len(levels)), sharex="col", sharey="row", layout="constrained", squeeze=False)
    most = {cost: max((p.cost for scene in scenes for p in points(scene, cost) if p.cost < math.inf), default=1) for cost in shown}
    rows = []
    for level in levels:
        for axis, cost in zip(axes[level], shown):
            for name in names:
                costs, total = profile(scenes, cost, name, level)
                look, share = style.look(name), np.arange(len(costs) + 1) / total
                # From the first solved problem on to the edge of the figure, so that a line which ends low is seen to stay there.
                axis.plot([*costs, most[cost]], [*share[1:], share[-1]], color=look.color, linestyle=look.dash, drawstyle="steps-post", marker=look.marker,
                          markevery=[len(costs)], label=name)
                rows += [{"level": level, "cost": cost, "formulation": name, "budget": c, "share": s} for c, s in zip(costs, share[1:])]
            axis.set_xscale("log")
        axes[level, 0].set_ylabel(f"share solved, target {level + 1}")
        axes[level, 0].set_ylim(0, None)
    for axis, cost in zip(axes[-1], shown):
        axis.set_xlabel(f"budget: {COSTS[cost][1]}")
    style.letter_panels(axes)
    style.legend_below(fig, axes[0, 0])
    targets = "; ".join(f"{scene['name']} {scene['error']} " + ", ".join(f"{t:g}" for t in scene["targets"]) for scene in scenes)
    table = pd.DataFrame(rows, columns=["level", "cost", "formulation", "budget", "share"])
    return style.save(fig, stem, table, PROFILE.format(targets=targets, n=profile(scenes, "newton", names[0], 0)[1]))
