"""The registry of figures: a kind is a function that draws, what it is drawn of, and its options."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from barrierbench_analysis.figures.plots import (
    barrier_shapes,
    friction_slope,
    gap_ridge,
    heat_map,
    matrices,
    one_step,
    over_time,
    pair_forces,
    phase_times,
    precision,
    profiles,
    resolution,
    scaling,
    step_front,
    trend,
)
from barrierbench_analysis.figures.plots.drawing import Drawing

from . import studies


@dataclass(frozen=True)
class Kind:
    """draw(subject, drawing) -> the files that it wrote; it raises UserError where there is nothing to draw.
    source: one of drawing.SOURCES; options: name -> default.
    """

    draw: Callable[[object, Drawing], list[Path]]
    source: str
    options: dict = field(default_factory=dict)


KINDS = {
    "barrier_shapes": Kind(barrier_shapes.of_shapes, "shapes"),
    "condition": Kind(over_time.KINDS["condition"], "sweep"),
    "data_profile": Kind(profiles.data_profile, "sweep", profiles.OPTIONS),
    "eigenvalues": Kind(matrices.eigenvalues, "matrices"),
    "friction_slope": Kind(friction_slope.figure, "sweep"),
    "gap_map": Kind(studies.gap_maps, "study"),
    "gap_ridge": Kind(gap_ridge.figure, "sweep"),
    "gap_size": Kind(studies.gap_sizes, "study"),
    "gaps": Kind(over_time.KINDS["gaps"], "sweep"),
    "heat_map": Kind(heat_map.figure, "sweep", heat_map.OPTIONS),
    "iterations": Kind(over_time.KINDS["iterations"], "sweep"),
    "newton_condition": Kind(one_step.newton_condition, "sweep"),
    "pair_forces": Kind(pair_forces.figure, "sweep"),
    "pareto": Kind(studies.pareto_fronts, "study"),
    "performance_profile": Kind(profiles.performance_profile, "sweep", profiles.OPTIONS),
    "phase_times": Kind(phase_times.figure, "sweep", phase_times.OPTIONS),
    "precision": Kind(precision.figure, "sweep", precision.OPTIONS),
    "preconditioned": Kind(matrices.preconditioned, "sweep"),
    "resolution": Kind(resolution.figure, "sweep"),
    "scaling": Kind(scaling.figure, "sweep"),
    "step_front": Kind(step_front.figure, "sweep"),
    "step_lengths": Kind(one_step.step_lengths, "sweep"),
    "success_frontier": Kind(heat_map.success_frontier, "sweep", heat_map.OPTIONS),
    "trend": Kind(trend.figure, "baselines", trend.OPTIONS),
    "work_precision": Kind(studies.work_precisions, "study"),
}
