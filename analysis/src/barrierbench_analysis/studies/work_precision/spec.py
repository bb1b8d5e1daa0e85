"""A work-precision spec (configs/work_precision/NAME.json) and the runs that it asks for.

Every scene has an anchor: time step, d_hat, tolerance. One of these, or the factor on every kappa, is varied
at a time, by factors of the anchor. The tolerance of Newton's method is given in units of min(d_hat, |g|
dt^2/2)/dt, since what a step may leave out depends on both; the program takes at most 0.1.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from barrierbench_analysis.io.digests import of_file
from barrierbench_analysis.io.spec_file import read_spec as read_json_spec
from barrierbench_analysis.io.spec_file import refused, require_base

from .gravity import gravity_of

AXES = ("tolerance", "dt_s", "d_hat_m", "kappa")
ANCHOR = AXES[:3]
REFERENCE_D_HAT, REFERENCE_TOLERANCE = 1 / 16, 1e-3  # of a refined reference, in units of the anchor
# A direct solver has factorisations and no products; the same run by conjugate gradients has products.
SOLVERS = {
    "direct": {"/linear_solver/name": "cholmod"},
    "pcg": {"/linear_solver/name": "pcg", "/linear_solver/preconditioner": "block_jacobi"},
}


@dataclass(frozen=True)
class Formulation:
    label: str
    name: str  # preset
    set: dict = field(hash=False, default_factory=dict)


@dataclass(frozen=True)
class Variation:
    """One problem of a scene: the anchor with one axis multiplied by a factor."""

    axis: str  # one of AXES, or "anchor"
    factor: float

    @property
    def label(self) -> str:
        return "anchor" if self.axis == "anchor" else f"{self.axis} x{self.factor:g}"

    def of(self, axis: str) -> float:
        return self.factor if axis == self.axis else 1.0


@dataclass(frozen=True)
class Scene:
    name: str
    base: Path
    gravity: float  # m/s^2, of the base with `set` over it; 0: none
    set: dict = field(hash=False)
    duration_s: float
    samples: int
    anchor: dict = field(hash=False)
    vary: dict = field(hash=False)
    reference: dict = field(hash=False)
    error: str
    targets: tuple[float, ...]

    @cached_property
    def variations(self) -> list[Variation]:
        return [
            Variation("anchor", 1.0),
            *(Variation(axis, f) for axis in AXES for f in self.vary.get(axis, ())),
        ]

    def steps(self, dt_factor: float) -> int:
        return round(self.duration_s / (self.anchor["dt_s"] * dt_factor))

    def _time(self, dt_factor: float) -> dict:
        """One step more than the duration: frames are of the steps 0, n, 2 n and so on, and the last of them
        has to be the end of the run.
        """
        steps = self.steps(dt_factor)
        return {
            "/time/dt_s": self.duration_s / steps,
            "/time/steps": steps + 1,
            "/output/frames_every": steps // self.samples,
        }

    def tolerance(self, relative: float, d_hat: float, dt: float) -> float:
        """m/s."""
        fall = 0.5 * self.gravity * dt * dt
        return relative * (min(d_hat, fall) if fall > 0 else d_hat) / dt

    def case(self, formulation: Formulation, variation: Variation, solver: str) -> dict:
        relative, dt, d_hat = (self.anchor[axis] * variation.of(axis) for axis in ANCHOR)
        return {
            "label": f"{formulation.label} {variation.label} {solver}",
            "set": {
                **self.set,
                "/formulation": {
                    "name": formulation.name,
                    "d_hat_m": d_hat,
                    "stiffness_policy": {"scale": variation.of("kappa")},
                },
                **formulation.set,
                **self._time(variation.of("dt_s")),
                "/step_solver/tol_velocity_m_per_s": self.tolerance(relative, d_hat, dt),
                **SOLVERS[solver],
            },
        }

    def reference_case(self, name: str, dt_factor: float) -> dict:
        """The same mesh and time step, a smaller d_hat and tolerance, the direct solver."""
        relative, dt, d_hat = (self.anchor[axis] for axis in ANCHOR)
        return {
            "label": f"reference {name} dt_s x{dt_factor:g}",
            "set": {
                **self.set,
                "/formulation": {"name": name, "d_hat_m": d_hat * REFERENCE_D_HAT},
                **self._time(dt_factor),
                "/step_solver/tol_velocity_m_per_s": REFERENCE_TOLERANCE
                * self.tolerance(relative, d_hat, dt * dt_factor),
                **SOLVERS["direct"],
            },
        }

    @property
    def dt_factors(self) -> list[float]:
        """Of all runs: each has its own refined reference."""
        return list(dict.fromkeys([1.0, *self.vary.get("dt_s", ())]))


@dataclass(frozen=True)
class Spec:
    name: str
    doc: str
    file: Path
    sha256: str  # of the file
    formulations: tuple[Formulation, ...]
    scenes: tuple[Scene, ...]

    def cases(self, scene: Scene) -> list[dict]:
        cases = [scene.case(f, v, s) for f in self.formulations for v in scene.variations for s in SOLVERS]
        return cases + [
            scene.reference_case(n, k) for n in scene.reference.get("refined", ()) for k in scene.dt_factors
        ]


def _formulation(data: str | dict) -> Formulation:
    if isinstance(data, str):
        return Formulation(data, data)
    return Formulation(data.get("label", data["name"]), data["name"], data.get("set", {}))


def _check_steps(scene: Scene, file: Path, place: str) -> None:
    """Refuses samples that are not at the ends of steps, with any time step."""
    for factor in scene.dt_factors:
        exact, steps = scene.duration_s / (scene.anchor["dt_s"] * factor), scene.steps(factor)
        if steps < 1 or abs(exact - steps) > 1e-6 * steps or steps % scene.samples:
            needed = f"an integer that divides the steps of every time step (dt x{factor:g} has {exact:g})"
            raise refused(file, f"{place}/samples", scene.samples, needed)


def _scene(data: dict, file: Path, place: str) -> Scene:
    base = require_base(data, file, f"{place}/").resolve()
    d_hat = min(data["vary"].get("d_hat_m", (1.0,)))
    if "refined" in data["reference"] and d_hat < 2 * REFERENCE_D_HAT:
        needed = f"at least {2 * REFERENCE_D_HAT:g} (the reference has d_hat x{REFERENCE_D_HAT:g})"
        raise refused(file, f"{place}/vary/d_hat_m", d_hat, needed)
    settings = data.get("set", {})
    scene = Scene(
        data["name"],
        base,
        gravity_of(base, settings, file, f"{place}/set"),
        settings,
        float(data["duration_s"]),
        data["samples"],
        {axis: float(value) for axis, value in data["anchor"].items()},
        {axis: tuple(map(float, factors)) for axis, factors in data["vary"].items()},
        data["reference"],
        data["error"],
        tuple(sorted(map(float, data["targets"]), reverse=True)),
    )
    _check_steps(scene, file, place)
    return scene


def read_spec(file: Path) -> Spec:
    """Errors: UserError with file, place, what was found and what is allowed."""
    data = read_json_spec(file, "work_precision")
    spec = Spec(
        data["name"],
        data.get("doc", ""),
        file,
        of_file(file),
        tuple(map(_formulation, data["formulations"])),
        tuple(_scene(scene, file, f"scenes/{k}") for k, scene in enumerate(data["scenes"])),
    )
    for key, names in (
        ("formulations", [f.label for f in spec.formulations]),
        ("scenes", [s.name for s in spec.scenes]),
    ):
        if len(set(names)) != len(names):
            raise refused(file, key, names, "every name once")
    return spec
