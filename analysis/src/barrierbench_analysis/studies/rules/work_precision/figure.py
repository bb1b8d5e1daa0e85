"""docs/work_precision_SCENE.png: error against four costs; docs/work_precision_profile.png: how many problems
are solved within a budget.
"""

import math
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from barrierbench_analysis.figures import panels, style
from barrierbench_analysis.tables import series

from .judge import COSTS, Point, band_of, formulations, front, levels, points, profile

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
BAND = " Grey: its own uncertainty, {band:.2g}; what lies in it is not ranked and is drawn at its edge."
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

    def solved(name: str) -> int:
        return sum(len(profile(scenes, "newton", name, level)[0]) for level in levels(scenes))

    return series.ranked(sorted(formulations(scenes[0]), key=lambda name: -solved(name)))


def _costs(scenes: list[dict], cost: str, names: tuple[str, ...]) -> panels.Panel:
    """What the drawn runs cost over their errors, to find a panel that repeats another."""
    found = {
        (scene["name"], p.formulation, *p.problem): p
        for scene in scenes
        for p in (*points(scene, cost), *points(scene, cost, ranked=False))
        if p.formulation in names
    }
    both = [(p.cost, p.error) for p in found.values()]
    index = pd.Index(list(found), tupleize_cols=False)
    drawn = pd.DataFrame(both, index=index, columns=["cost", "error"], dtype=float)
    return panels.Panel(COSTS[cost][1], drawn["cost"], drawn["error"])


def _chosen(scenes: list[dict], costs: tuple[str, ...], names: tuple[str, ...]) -> tuple[list[str], str]:
    """The costs that get a panel, and the sentence on the others."""
    kept, said = panels.choose([_costs(scenes, cost, names) for cost in costs])
    return [cost for cost in costs if COSTS[cost][1] in kept], said


def _mark_runs(axis, name: str, runs: list[Point], opacity: float) -> None:
    """The runs of a formulation that have an error."""
    look, good = style.look(name), [p for p in runs if p.formulation == name and p.error is not None]
    how = {"linestyle": "none", "marker": look.marker, "markersize": 2.6, "markeredgewidth": 0}
    axis.plot([p.cost for p in good], [p.error for p in good], color=look.color, alpha=opacity, **how)


def _draw_front(axis, name: str, ranked: list[Point]) -> None:
    """The runs of a formulation that none of its cheaper ones equals; where there are none, its legend says
    so.
    """
    look, line = style.look(name), [(c, e) for c, e in front(ranked, name) if c > 0]
    how = {"linestyle": look.dash, "marker": look.marker, "color": look.color, "markersize": 4}
    label = name if line else f"{name} (no run counts)"
    axis.plot([c for c, _ in line], [e for _, e in line], label=label, **how)


def _cross_failures(axis, runs: list[Point]) -> None:
    """Runs without an error, at the upper edge."""
    how = {"linestyle": "none", "marker": "x", "markersize": 5, "markeredgewidth": 1.2, "gid": style.FAILURE}
    for p in (p for p in runs if p.error is None):
        across = axis.get_xaxis_transform()
        axis.plot([p.cost], [0.96], transform=across, color=style.look(p.formulation).color, **how)


def _drawn(scene: dict, cost: str, names: tuple[str, ...], ranked: bool) -> list[Point]:
    return [p for p in points(scene, cost, ranked) if p.formulation in names and 0 < p.cost < math.inf]


def _panel(axis, scene: dict, cost: str, names: tuple[str, ...]) -> None:
    """Runs that are not ranked are faint."""
    band, drawn = band_of(scene), [_drawn(scene, cost, names, ranked) for ranked in (True, False)]
    for name in names:
        for runs, opacity in zip(drawn, (0.45, 0.15)):
            _mark_runs(axis, name, runs, opacity)
        _draw_front(axis, name, points(scene, cost))
    axis.set_xscale("log")
    axis.set_yscale("log")
    _cross_failures(axis, [*drawn[0], *drawn[1]])
    if band > 0:
        axis.axhspan(band / 1e6, band, color="#bbbbbb", alpha=0.5, linewidth=0, zorder=0, gid=style.REFERENCE)
    axis.set_xlabel(COSTS[cost][1])


def _numbers(scene: dict, names: tuple[str, ...]) -> pd.DataFrame:
    """Every run of these formulations against every cost, drawn or not."""
    rows = [
        {"against": cost, **p.__dict__, "ranked": ranked}
        for cost in COSTS
        for ranked in (True, False)
        for p in _drawn(scene, cost, names, ranked)
    ]
    return pd.DataFrame(rows, columns=["against", *Point.__dataclass_fields__, "ranked"])


def _limits(scene: dict) -> tuple[float, float]:
    """Of the errors, with room above for the crosses of failed runs and below for the band."""
    found = [r for r in scene["rows"] if r["error"] is not None]
    errors = [max(r["error"], band_of(scene, r), 1e-300) for r in found] or [1.0]
    room = max(max(errors) / min(errors), 10.0)
    above = 0.2 if len(found) < len(scene["rows"]) else 0.05
    return min(*errors, band_of(scene) or math.inf) / room**0.1, max(errors) * room**above


def _solvers(costs: list[str]) -> str:
    """Which panels are of which solver."""
    found = []
    for solver, words in SOLVERS.items():
        if letters := [f"({letter})" for letter, cost in zip("abcd", costs) if COSTS[cost][0] == solver]:
            found.append(f"{', '.join(letters)}: {words}")
    return "; ".join(found)


def _shown(scene: dict, costs: list[str], names: tuple[str, ...]) -> str:
    rows, band = [r for r in scene["rows"] if r["formulation"] in names], band_of(scene)
    of = {solver: [r for r in rows if r["solver"] == solver] for solver in SOLVERS}
    bad = {solver: sum(r["error"] is None for r in mine) for solver, mine in of.items()}
    counts = [f"{n} of {len(of[s])} with the {SOLVERS[s].split(',')[0]}" for s, n in bad.items() if n]
    aside = any(p.formulation in names for p in points(scene, "newton", ranked=False))
    return SHOWN.format(
        scene=scene["name"],
        error=scene["error"],
        n=len(of["direct"]) // len(names),
        reference=scene["references"][0]["name"],
        band=BAND.format(band=band) if band else "",
        aside=ASIDE if aside else "",
        failed=CROSSES.format(counts=", ".join(counts)) if counts else "",
        solvers=_solvers(costs),
    )


def draw(scene: dict, stem: Path, ranks: list[str] | None = None) -> list[Path]:
    """The figure of one scene, and its supplement. ranks: by_rank of all scenes, so that their figures have
    the same formulations.
    """
    paths, about = [], scene["about"]
    made = f"{about['unknowns']} unknowns; {about['machine']}; commit {about['commit']}; {about['date']}."
    for part in series.parts(formulations(scene), ranks or by_rank([scene]), stem.name):
        costs, left_out = _chosen([scene], tuple(COSTS), part.names)
        fig, axes = panels.grid(len(costs), style.WIDE_IN, 2.4, most=2 if len(costs) != 3 else 3, sharey=True)
        for axis, cost in zip(axes, costs):
            _panel(axis, scene, cost, part.names)
            if axis.get_subplotspec().is_first_col():
                axis.set_ylabel(ERRORS[scene["error"]])
        axes[0].set_ylim(*_limits(scene))
        style.letter_panels(axes)
        style.legend_below(fig, axes[0])
        shown = " ".join(filter(None, [_shown(scene, costs, part.names), left_out, part.says, made]))
        paths += style.save(fig, stem.with_name(stem.name + part.suffix), _numbers(scene, part.names), shown)
    return paths


def _profile_panel(
    axis, scenes: list[dict], cost: str, level: int, names: tuple[str, ...], most: float
) -> list[dict]:
    """A line goes on from its last solved problem to the edge of the figure, so that one which ends low is
    seen to stay there.
    """
    rows = []
    for name in names:
        costs, total = profile(scenes, cost, name, level)
        look, share = style.look(name), np.arange(len(costs) + 1) / total
        how = {"color": look.color, "linestyle": look.dash, "marker": look.marker, "markevery": [len(costs)]}
        axis.plot([*costs, most], [*share[1:], share[-1]], drawstyle="steps-post", label=name, **how)
        both = {"level": level, "cost": cost, "formulation": name}
        rows += [{**both, "budget": c, "share": s} for c, s in zip(costs, share[1:])]
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
    names, paths, rows_of_panels = formulations(scenes[0]), [], levels(scenes)
    problems = profile(scenes, "newton", names[0], 0)[1]
    for part in series.parts(names, by_rank(scenes), stem.name):
        costs, left_out = _chosen(scenes, ("newton", "factorizations", "products"), part.names)
        size = (style.WIDE_IN, 0.8 + 1.7 * len(rows_of_panels))
        how = {"sharex": "col", "sharey": "row", "layout": "constrained", "squeeze": False}
        fig, axes = plt.subplots(len(rows_of_panels), len(costs), figsize=size, **how)
        rows = []
        for level in rows_of_panels:
            for axis, cost in zip(axes[level], costs):
                rows += _profile_panel(axis, scenes, cost, level, part.names, _largest(scenes, cost))
            axes[level, 0].set_ylabel(f"share solved, target {level + 1}")
            axes[level, 0].set_ylim(0, None)
        for axis, cost in zip(axes[-1], costs):
            axis.set_xlabel(f"budget: {COSTS[cost][1]}")
        style.letter_panels(axes)
        style.legend_below(fig, axes[0, 0])
        table = pd.DataFrame(rows, columns=["level", "cost", "formulation", "budget", "share"])
        shown = PROFILE.format(targets=_targets(scenes), n=problems)
        words = " ".join(filter(None, [shown, left_out, part.says]))
        paths += style.save(fig, stem.with_name(stem.name + part.suffix), table, words)
    return paths
