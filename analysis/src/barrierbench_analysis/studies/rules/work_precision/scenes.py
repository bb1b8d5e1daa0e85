"""The runs that a work-precision study asks for.

Every scene has an anchor: time step, d_hat, tolerance. One of these, or the factor on every kappa, is varied
at a time, by factors of the anchor. The tolerance of Newton's method is in units of min(d_hat, |g|
dt^2/2)/dt, since what a step may leave out depends on both; the program takes at most 0.1. A scene with a
refined reference has two more runs for each time step: the same mesh and time step, a smaller d_hat and
tolerance.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from barrierbench_analysis.io.spec_file import refused, require_base, require_names_once
from barrierbench_analysis.studies.kit.study.spec import Case, Study

from .gravity import gravity_of

AXES = ("tolerance", "dt_s", "d_hat_m", "kappa")
ANCHOR = AXES[:3]
PLACE = ("scene", "formulation", "axis", "factor", "solver")
AT_ANCHOR, REFERENCE = "anchor", "reference"  # on the axis of a cell, beside AXES
REFERENCE_D_HAT, REFERENCE_TOLERANCE = 1 / 16, 1e-3  # of a refined reference, in units of the anchor
# A direct solver has factorisations and no products; the same run by conjugate gradients has products.
SOLVERS = {
    "direct": {"/linear_solver/name": "cholmod"},
    "pcg": {"/linear_solver/name": "pcg", "/linear_solver/preconditioner": "block_jacobi"},
}


@dataclass(frozen=True)
class Scene:
    """Of the spec. gravity: m/s^2, of the base with `set` over it; 0: none."""

    name: str
    base: Path
    gravity: float
    duration_s: float
    samples: int
    anchor: dict
    vary: dict
    reference: dict
    error: str
    targets: list[float]
    set: dict = field(default_factory=dict)

    @property
    def dt_factors(self) -> list[float]:
        """Of all runs: each has its own refined reference."""
        return list(dict.fromkeys([1.0, *self.vary.get("dt_s", ())]))

    def steps(self, dt_factor: float) -> int:
        return round(self.duration_s / (self.anchor["dt_s"] * dt_factor))

    def tolerance(self, relative: float, d_hat: float, dt: float) -> float:
        """m/s."""
        fall = 0.5 * self.gravity * dt * dt
        return relative * (min(d_hat, fall) if fall > 0 else d_hat) / dt

    def _settings(self, formulation: dict, dt_factor: float, tolerance: float, solver: str) -> dict:
        """One step more than the duration: frames are of the steps 0, n, 2 n and so on, and the last of them
        has to be the end of the run. formulation: settings.
        """
        steps = self.steps(dt_factor)
        return {
            **self.set,
            **formulation,
            "/time/dt_s": self.duration_s / steps,
            "/time/steps": steps + 1,
            "/output/frames_every": steps // self.samples,
            "/step_solver/tol_velocity_m_per_s": tolerance,
            **SOLVERS[solver],
        }

    def _case(self, formulation: dict, axis: str, factor: float, solver: str) -> Case:
        """The anchor with one axis multiplied by a factor."""

        def of(name: str) -> float:
            return factor if name == axis else 1.0

        relative, dt, d_hat = (self.anchor[name] * of(name) for name in ANCHOR)
        preset = {"name": formulation["name"], "d_hat_m": d_hat, "stiffness_policy": {"scale": of("kappa")}}
        settings = {"/formulation": preset, **formulation.get("set", {})}
        made = self._settings(settings, of("dt_s"), self.tolerance(relative, d_hat, dt), solver)
        against = {**self.reference, "runs": [run.settings for run in self.references(of("dt_s"))]}
        place = self._place(formulation.get("label", formulation["name"]), axis, factor, solver)
        return Case(place, made, self.base, against=against)

    def _reference(self, name: str, dt_factor: float) -> Case:
        relative, dt, d_hat = (self.anchor[axis] for axis in ANCHOR)
        settings = {"/formulation": {"name": name, "d_hat_m": d_hat * REFERENCE_D_HAT}}
        tolerance = REFERENCE_TOLERANCE * self.tolerance(relative, d_hat, dt * dt_factor)
        made = self._settings(settings, dt_factor, tolerance, "direct")
        return Case(
            self._place(name, REFERENCE, dt_factor, "direct"), made, self.base, against=self.reference
        )

    def _place(self, formulation: str, axis: str, factor: float, solver: str) -> dict[str, str]:
        return dict(zip(PLACE, (self.name, formulation, axis, f"{factor:.12g}", solver)))

    def references(self, dt_factor: float) -> list[Case]:
        """The two runs from which others with this time step are measured; none beside a closed form."""
        return [self._reference(name, dt_factor) for name in self.reference.get("refined", ())]

    def cases(self, formulations: list[dict]) -> Iterator[Case]:
        """References first, since others are measured from them."""
        for factor in self.dt_factors:
            yield from self.references(factor)
        varied = [(axis, float(factor)) for axis in AXES for factor in self.vary.get(axis, ())]
        for formulation in formulations:
            for axis, factor in [(AT_ANCHOR, 1.0), *varied]:
                yield from (self._case(formulation, axis, factor, solver) for solver in SOLVERS)


def _check_steps(scene: Scene, file: Path, place: str) -> None:
    """Refuses samples that are not at the ends of steps, with any time step."""
    for factor in scene.dt_factors:
        exact, steps = scene.duration_s / (scene.anchor["dt_s"] * factor), scene.steps(factor)
        if steps < 1 or abs(exact - steps) > 1e-6 * steps or steps % scene.samples:
            needed = f"an integer that divides the steps of every time step (dt x{factor:g} has {exact:g})"
            raise refused(file, f"{place}/samples", scene.samples, needed)


def _scene(study: Study, data: dict, place: str) -> Scene:
    base = require_base(data, study.file, f"{place}/") if "base" in data else study.base
    d_hat = min(data["vary"].get("d_hat_m", (1.0,)))
    if "refined" in data["reference"] and d_hat < 2 * REFERENCE_D_HAT:
        needed = f"at least {2 * REFERENCE_D_HAT:g} (the reference has d_hat x{REFERENCE_D_HAT:g})"
        raise refused(study.file, f"{place}/vary/d_hat_m", d_hat, needed)
    gravity = gravity_of(base, data.get("set", {}), study.file, f"{place}/set")
    targets = sorted(data["targets"], reverse=True)
    scene = Scene(**{**data, "base": base, "gravity": gravity, "targets": targets})
    _check_steps(scene, study.file, place)
    return scene


def scenes_of(study: Study) -> list[Scene]:
    """Errors: UserError with file, place, what was found and what is allowed."""
    scenes = [_scene(study, one, f"about/scenes/{k}") for k, one in enumerate(study.about["scenes"])]
    labels = [one.get("label", one["name"]) for one in formulations_of(study)]
    require_names_once(study.file, "about/formulations", labels)
    require_names_once(study.file, "about/scenes", [scene.name for scene in scenes])
    return scenes


def formulations_of(study: Study) -> list[dict]:
    """Presets, each with a label and settings of its own where the spec has some."""
    return [one if isinstance(one, dict) else {"name": one} for one in study.about["formulations"]]
