"""docs/work_precision_SCENE.png: error against four costs; docs/work_precision_profile.png: how many problems
are solved within a budget.
"""

from __future__ import annotations

import math
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from barrierbench_analysis.figures import panels, style
from barrierbench_analysis.tables import series

from .judge import COSTS, Point, aside, band_of, formulations, front, points, profile

ERRORS = {
    "e_traj": "largest distance of a vertex / scene",
    "e_com": "distance of centres of mass / scene",
    "e_gap": "|gap - closed form| / d_hat",
    "e_offset": "excess height at rest (m)",
    "e_momentum": "|change of momentum| / momentum",
    "e_energy": "|change of energy| / energy",
}
SHOWN = (
    "{scene}, {error} against what it cost: {n} runs of every formulation and solver (tolerance, time step,"
    " d_hat and stiffness each varied round one anchor). Small marks: runs; lines: the runs of a formulation"
    " that none of its cheaper ones equals. Reference: {reference}.{band}{aside}{failed} {solvers}."
)
CROSSES = (
    " Crosses at the upper edge: runs that failed or are not valid and so have no error, at what they had"
    " cost by then ({counts})."
)
SOLVERS = {"direct": "direct solver", "pcg": "conjugate gradients with block Jacobi, the same settings"}
ASIDE = (
    " Faint marks: other time steps, which are not ranked, since the reference has the time step of the run"
    " and sees no error in time."
)
PROFILE = (
    "Share of the problems (scene, variation) that were solved with at most that work: the run counts and its"
    " error is at most the target of its scene ({targets}). Failed runs are never solved. Other time steps"
    " are no problems in scenes with refined references, which see no error in time. {n} problems a"
    " formulation; the direct solver, for products conjugate gradients with block Jacobi."
)


def by_rank(scenes: list[dict]) -> list[str]:
    """The formulations, what the project compares first, then those that solve most problems at all targets
    together.
    """
    solved = {
        name: sum(
            len(profile(scenes, "newton", name, level)[0])
            for level in range(max(len(scene["targets"]) for scene in scenes))
        )
        for name in formulations(scenes[0])
    }
    return series.ranked(sorted(solved, key=lambda name: -solved[name]))


def _costs(scenes: list[dict], cost: str, names: tuple[str, ...]) -> panels.Panel:
    """What the drawn runs cost over their errors, to find a panel that repeats another."""
    found = {
        (scene["name"], p.formulation, *p.problem): p
        for scene in scenes
        for p in (*points(scene, cost), *aside(scene, cost))
        if p.formulation in names
    }
    index = pd.Index(list(found), tupleize_cols=False)
    errors = pd.Series([p.error for p in found.values()], index=index, dtype=float)
    return panels.Panel(
        COSTS[cost][1], pd.Series([p.cost for p in found.values()], index=index, dtype=float), errors
    )


def _chosen(scenes: list[dict], costs: tuple[str, ...], names: tuple[str, ...]) -> tuple[list[str], str]:
    """The costs that get a panel, and the sentence on the others."""
    kept, said = panels.choose([_costs(scenes, cost, names) for cost in costs])
    return [cost for cost in costs if COSTS[cost][1] in kept], said


def _mark_runs(axis, name: str, drawn: list[tuple[Point, bool]]) -> None:
    """The runs of a formulation that have an error; faint those that are not ranked."""
    look = style.look(name)
    mine = [(p, ranked) for p, ranked in drawn if p.formulation == name]
    for opacity, which in ((0.45, True), (0.15, False)):
        good = [p for p, ranked in mine if p.error is not None and ranked == which]
        axis.plot(
            [p.cost for p in good],
            [p.error for p in good],
            linestyle="none",
            marker=look.marker,
            color=look.color,
            markersize=2.6,
            alpha=opacity,
            markeredgewidth=0,
        )


def _draw_front(axis, name: str, all_points: list[Point]) -> None:
    """The runs of a formulation that none of its cheaper ones equals; where there are none, its legend says
    so.
    """
    look = style.look(name)
    line = [(c, e) for c, e in front(all_points, name) if c > 0]
    if line:
        axis.plot(
            [c for c, _ in line],
            [e for _, e in line],
            color=look.color,
            linestyle=look.dash,
            marker=look.marker,
            markersize=4,
            label=name,
        )
    else:
        axis.plot(
            [],
            [],
            color=look.color,
            linestyle=look.dash,
            marker=look.marker,
            label=f"{name} (no run counts)",
        )


def _cross_failures(axis, drawn: list[tuple[Point, bool]]) -> None:
    """Runs without an error, at the upper edge."""
    for p, _ in drawn:
        if p.error is None:
            axis.plot(
                [p.cost],
                [0.96],
                transform=axis.get_xaxis_transform(),
                marker="x",
                color=style.look(p.formulation).color,
                linestyle="none",
                markersize=5,
                markeredgewidth=1.2,
                gid=style.FAILURE,
            )


def _panel(axis, scene: dict, cost: str, names: tuple[str, ...]) -> None:
    all_points, band = points(scene, cost), band_of(scene)
    drawn = [(p, True) for p in all_points] + [(p, False) for p in aside(scene, cost)]
    drawn = [(p, ranked) for p, ranked in drawn if 0 < p.cost < math.inf and p.formulation in names]
    for name in names:
        _mark_runs(axis, name, drawn)
        _draw_front(axis, name, all_points)
    axis.set_xscale("log")
    axis.set_yscale("log")
    _cross_failures(axis, drawn)
    if band > 0:
        axis.axhspan(band / 1e6, band, color="#bbbbbb", alpha=0.5, linewidth=0, zorder=0, gid=style.REFERENCE)
    axis.set_xlabel(COSTS[cost][1])


def _numbers(scene: dict, names: tuple[str, ...]) -> pd.DataFrame:
    """Every run of these formulations against every cost, drawn or not."""
    rows = [
        {"against": cost, **p.__dict__, "ranked": ranked}
        for cost in COSTS
        for found, ranked in ((points, True), (aside, False))
        for p in found(scene, cost)
        if p.formulation in names and 0 < p.cost < math.inf
    ]
    return pd.DataFrame(rows, columns=["against", *Point.__dataclass_fields__, "ranked"])


def _limits(scene: dict) -> tuple[float, float]:
    """Of the errors, with room above for the crosses of failed runs and below for the band."""
    errors = [
        max(r["error"], band_of(scene, r), 1e-300) for r in scene["rows"] if r["error"] is not None
    ] or [1.0]
    low, high = min(errors), max(errors)
    room = max(high / low, 10.0)
    return (
        min(low, band_of(scene) or low) / room**0.1,
        high * room ** (0.2 if any(r["error"] is None for r in scene["rows"]) else 0.05),
    )


def _solvers(costs: list[str]) -> str:
    """Which panels are of which solver."""
    of = {
        solver: [f"({letter})" for letter, cost in zip("abcd", costs) if COSTS[cost][0] == solver]
        for solver in SOLVERS
    }
    return "; ".join(f"{', '.join(letters)}: {SOLVERS[solver]}" for solver, letters in of.items() if letters)


def _shown(scene: dict, costs: list[str], names: tuple[str, ...]) -> str:
    rows, band = [r for r in scene["rows"] if r["formulation"] in names], band_of(scene)
    bad = {solver: sum(r["error"] is None for r in rows if r["solver"] == solver) for solver in SOLVERS}
    counts = ", ".join(
        f"{n} of {sum(r['solver'] == solver for r in rows)} with the {SOLVERS[solver].split(',')[0]}"
        for solver, n in bad.items()
        if n
    )
    of_direct = sum(r["solver"] == "direct" for r in rows)
    return SHOWN.format(
        scene=scene["name"],
        error=scene["error"],
        n=of_direct // len(names),
        reference=scene["references"][0]["name"],
        band=(
            f" Grey: its own uncertainty, {band:.2g}; what lies in it is not ranked and is drawn at its edge."
            if band
            else ""
        ),
        aside=ASIDE if any(p.formulation in names for p in aside(scene, "newton")) else "",
        failed=CROSSES.format(counts=counts) if counts else "",
        solvers=_solvers(costs),
    )


def draw(scene: dict, stem: Path, ranks: list[str] | None = None) -> list[Path]:
    """The figure of one scene of results/work_precision.json, and its supplement. ranks: by_rank of all
    scenes, so that their figures have the same formulations.
    """
    paths = []
    for part in series.parts(formulations(scene), ranks or by_rank([scene]), stem.name):
        costs, left_out = _chosen([scene], tuple(COSTS), part.names)
        fig, axes = panels.grid(len(costs), style.WIDE_IN, 2.4, most=2 if len(costs) != 3 else 3, sharey=True)
        for axis, cost in zip(axes, costs):
            _panel(axis, scene, cost, part.names)
        axes[0].set_ylim(*_limits(scene))
        for axis in axes:
            if axis.get_subplotspec().is_first_col():
                axis.set_ylabel(ERRORS[scene["error"]])
        style.letter_panels(axes)
        style.legend_below(fig, axes[0])
        shown = " ".join(
            filter(None, [_shown(scene, costs, part.names), left_out, part.says, machine(scene)])
        )
        paths += style.save(fig, stem.with_name(stem.name + part.suffix), _numbers(scene, part.names), shown)
    return paths


def machine(scene: dict) -> str:
    about = scene["about"]
    return f"{about['unknowns']} unknowns; {about['machine']}; commit {about['commit']}; {about['date']}."


def _profile_panel(
    axis, scenes: list[dict], cost: str, level: int, names: tuple[str, ...], most: float
) -> list[dict]:
    rows = []
    for name in names:
        costs, total = profile(scenes, cost, name, level)
        look, share = style.look(name), np.arange(len(costs) + 1) / total
        # From the first solved problem on to the edge of the figure, so that a line which ends low is seen
        # to stay there.

        axis.plot(
            [*costs, most],
            [*share[1:], share[-1]],
            color=look.color,
            linestyle=look.dash,
            drawstyle="steps-post",
            marker=look.marker,
            markevery=[len(costs)],
            label=name,
        )
        rows += [
            {"level": level, "cost": cost, "formulation": name, "budget": c, "share": s}
            for c, s in zip(costs, share[1:])
        ]
    axis.set_xscale("log")
    return rows


def _targets(scenes: list[dict]) -> str:
    """Of every scene its error and the targets of it."""
    return "; ".join(
        f"{scene['name']} {scene['error']} " + ", ".join(f"{t:g}" for t in scene["targets"])
        for scene in scenes
    )


def _largest(scenes: list[dict], cost: str) -> float:
    """What the dearest run cost, where a profile ends; 1 where no cost is finite."""
    return max((p.cost for scene in scenes for p in points(scene, cost) if p.cost < math.inf), default=1)


def draw_profile(scenes: list[dict], stem: Path) -> list[Path]:
    """Data profiles over all scenes: one row a target level, one column a cost; and the supplement."""
    names, paths, levels = formulations(scenes[0]), [], range(max(len(scene["targets"]) for scene in scenes))
    targets = _targets(scenes)
    for part in series.parts(names, by_rank(scenes), stem.name):
        costs, left_out = _chosen(scenes, ("newton", "factorizations", "products"), part.names)
        fig, axes = plt.subplots(
            len(levels),
            len(costs),
            figsize=(style.WIDE_IN, 0.8 + 1.7 * len(levels)),
            sharex="col",
            sharey="row",
            layout="constrained",
            squeeze=False,
        )
        most = {cost: _largest(scenes, cost) for cost in costs}
        rows = [
            row
            for level in levels
            for axis, cost in zip(axes[level], costs)
            for row in _profile_panel(axis, scenes, cost, level, part.names, most[cost])
        ]
        for level in levels:
            axes[level, 0].set_ylabel(f"share solved, target {level + 1}")
            axes[level, 0].set_ylim(0, None)
        for axis, cost in zip(axes[-1], costs):
            axis.set_xlabel(f"budget: {COSTS[cost][1]}")
        style.letter_panels(axes)
        style.legend_below(fig, axes[0, 0])
        table = pd.DataFrame(rows, columns=["level", "cost", "formulation", "budget", "share"])
        shown = PROFILE.format(targets=targets, n=profile(scenes, "newton", names[0], 0)[1])
        paths += style.save(
            fig,
            stem.with_name(stem.name + part.suffix),
            table,
            " ".join(filter(None, [shown, left_out, part.says])),
        )
    return paths
