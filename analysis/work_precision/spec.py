"""A work-precision spec (configs/work_precision/NAME.json) and the runs that it asks for.

Every scene has an anchor: time step, d_hat, tolerance. One of these, or the factor on every kappa, is varied
at a time, by factors of the anchor. The tolerance of Newton's method is given in units of min(d_hat, |g|
dt^2/2)/dt, since what a step may leave out depends on both; the program takes at most 0.1.
"""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from ..accuracy.errors import NAMES
from ..accuracy.reference import CLOSED_FORMS
from ..errors import UserError
from ..json_file import read_json

NAME = "barrierbench.work_precision/1"
AXES = ("tolerance", "dt_s", "d_hat_m", "kappa")
ANCHOR = AXES[:3]
GRAVITY, STANDARD_GRAVITY = "gravity_m_per_s2", 9.81  # key of a scene, and m/s^2 without it
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


class _Reader:
    """Values of a JSON object with a message that names file, pointer, what was found and what is allowed."""

    def __init__(self, file: Path):
        self.file = file

    def fail(self, pointer: str, found, allowed: str):
        raise UserError(f"{self.file}: {pointer}: found {json.dumps(found)}; allowed: {allowed}")

    def keys(self, data, pointer: str, required: tuple[str, ...], optional: tuple[str, ...] = ()) -> dict:
        if not isinstance(data, dict):
            self.fail(pointer or "/", data, "an object")
        for key in data:
            if key not in (*required, *optional):
                self.fail(
                    f"{pointer}/{key}", data[key], f"one of the keys {', '.join((*required, *optional))}"
                )
        for key in required:
            if key not in data:
                self.fail(f"{pointer}/{key}", None, "this key is needed")
        return data

    def number(self, value, pointer: str) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not (0 < value < math.inf):
            self.fail(pointer, value, "a number > 0")
        return float(value)

    def numbers(self, value, pointer: str) -> tuple[float, ...]:
        if not isinstance(value, list) or not value:
            self.fail(pointer, value, "an array of at least one number > 0")
        return tuple(self.number(v, f"{pointer}/{k}") for k, v in enumerate(value))

    def text(self, value, pointer: str, allowed: tuple[str, ...] = ()) -> str:
        if not isinstance(value, str) or not value or (allowed and value not in allowed):
            self.fail(
                pointer, value, f"one of {', '.join(allowed)}" if allowed else "a string that is not empty"
            )
        return value

    def settings(self, value, pointer: str) -> dict:
        if not isinstance(value, dict) or not all(key.startswith("/") for key in value):
            self.fail(pointer, value, "an object of JSON pointers into a config and values")
        return value


def _formulation(reader: _Reader, data, pointer: str) -> Formulation:
    if isinstance(data, str):
        return Formulation(data, data)
    reader.keys(data, pointer, ("name",), ("label", "set"))
    name = reader.text(data["name"], f"{pointer}/name")
    return Formulation(
        reader.text(data.get("label", name), f"{pointer}/label"),
        name,
        reader.settings(data.get("set", {}), f"{pointer}/set"),
    )


def _reference(reader: _Reader, data, pointer: str) -> dict:
    reader.keys(data, pointer, (), ("closed_form", "refined"))
    if len(data) != 1:
        reader.fail(pointer, data, "either closed_form or refined")
    if "closed_form" in data:
        reader.text(data["closed_form"], f"{pointer}/closed_form", tuple(CLOSED_FORMS))
    elif (
        not isinstance(data["refined"], list)
        or len(set(map(str, data["refined"]))) != 2
        or len(data["refined"]) != 2
    ):
        reader.fail(
            f"{pointer}/refined",
            data["refined"],
            "two formulations, so that their distance says how far the reference is to be trusted",
        )
    return data


def _gravity(base: Path, settings: dict, reader: _Reader, pointer: str) -> float:
    """Of a config with the settings of a scene placed in it, in the order and by the rules of the program;
    9.81 where neither says.
    """
    own = _Reader(base)
    config = read_json(base)
    if not isinstance(config, dict):
        own.fail("/", config, "an object: a config with a scene")
    if not isinstance(scene := config.get("scene"), dict):
        own.fail("/scene", scene, "an object")
    name, given, fail, place = (
        scene.get("name"),
        scene.get(GRAVITY, STANDARD_GRAVITY),
        own.fail,
        f"/scene/{GRAVITY}",
    )
    for key in sorted(settings):
        value = settings[key]
        if key == "/scene":
            if not isinstance(value, dict):
                reader.fail(pointer + key, value, "an object")
            name, given, fail, place = (
                value.get("name"),
                value.get(GRAVITY, STANDARD_GRAVITY),
                reader.fail,
                f"{pointer}{key}/{GRAVITY}",
            )
        elif key == "/scene/name" and value != name:
            name, given = value, STANDARD_GRAVITY  # a scene named anew starts anew
        elif key == f"/scene/{GRAVITY}":
            given, fail, place = value, reader.fail, pointer + key
        elif key.startswith(f"/scene/{GRAVITY}/"):
            index = key.rpartition("/")[2]
            if not isinstance(given, list) or index not in map(str, range(len(given))):
                reader.fail(pointer + key, value, f"a place in {json.dumps(given)}")
            given, fail, place = (
                [value if str(k) == index else old for k, old in enumerate(given)],
                reader.fail,
                pointer + key,
            )
    parts = given if isinstance(given, list) else [given]
    if not all(
        isinstance(g, (int, float)) and not isinstance(g, bool) and math.isfinite(g) for g in parts
    ) or (len(parts) != 3 if isinstance(given, list) else given < 0):
        fail(place, given, "a number >= 0 or an array of three numbers")
    return math.hypot(*parts)


def _scene(reader: _Reader, data, pointer: str) -> Scene:
    reader.keys(
        data,
        pointer,
        ("name", "base", "duration_s", "samples", "anchor", "vary", "reference", "error", "targets"),
        ("set",),
    )
    base = (reader.file.parent / reader.text(data["base"], f"{pointer}/base")).resolve()
    if not base.is_file():
        reader.fail(f"{pointer}/base", data["base"], "a config, relative to this file")
    anchor = {
        k: reader.number(v, f"{pointer}/anchor/{k}")
        for k, v in reader.keys(data["anchor"], f"{pointer}/anchor", ANCHOR).items()
    }
    vary = {
        k: reader.numbers(v, f"{pointer}/vary/{k}")
        for k, v in reader.keys(data["vary"], f"{pointer}/vary", (), AXES).items()
    }
    for k, factors in vary.items():
        if 1.0 in factors or len(set(factors)) != len(factors):
            reader.fail(f"{pointer}/vary/{k}", list(factors), "factors of the anchor, each once and none 1")
    if (
        "refined" in _reference(reader, data["reference"], f"{pointer}/reference")
        and min(vary.get("d_hat_m", (1.0,))) < 2 * REFERENCE_D_HAT
    ):
        reader.fail(
            f"{pointer}/vary/d_hat_m",
            min(vary["d_hat_m"]),
            f"at least {2 * REFERENCE_D_HAT:g}: the reference has d_hat x{REFERENCE_D_HAT:g}",
        )
    samples = reader.number(data["samples"], f"{pointer}/samples")
    settings = reader.settings(data.get("set", {}), f"{pointer}/set")
    scene = Scene(
        reader.text(data["name"], f"{pointer}/name"),
        base,
        _gravity(base, settings, reader, f"{pointer}/set"),
        settings,
        reader.number(data["duration_s"], f"{pointer}/duration_s"),
        int(samples),
        anchor,
        vary,
        data["reference"],
        reader.text(data["error"], f"{pointer}/error", NAMES),
        tuple(sorted(reader.numbers(data["targets"], f"{pointer}/targets"), reverse=True)),
    )
    for factor in scene.dt_factors:
        exact, steps = scene.duration_s / (anchor["dt_s"] * factor), scene.steps(factor)
        if samples != int(samples) or steps < 1 or abs(exact - steps) > 1e-6 * steps or steps % int(samples):
            reader.fail(
                f"{pointer}/samples",
                data["samples"],
                f"an integer that divides the steps of every time step; dt x{factor:g} has {exact:g} steps",
            )
    return scene


def read_spec(file: Path) -> Spec:
    """Errors: UserError, which names the first fault."""
    try:
        text = file.read_bytes()
        data = json.loads(text)
    except OSError as error:
        raise UserError(f"{file}: {error.strerror}") from None
    except ValueError as error:
        raise UserError(f"{file}: not JSON: {error}") from None
    reader = _Reader(file)
    reader.keys(data, "", ("schema", "name", "formulations", "scenes"), ("doc",))
    reader.text(data["schema"], "/schema", (NAME,))
    for key in ("formulations", "scenes"):
        if not isinstance(data[key], list) or not data[key]:
            reader.fail(f"/{key}", data[key], "an array that is not empty")
    spec = Spec(
        reader.text(data["name"], "/name"),
        data.get("doc", ""),
        file,
        hashlib.sha256(text).hexdigest(),
        tuple(_formulation(reader, f, f"/formulations/{k}") for k, f in enumerate(data["formulations"])),
        tuple(_scene(reader, s, f"/scenes/{k}") for k, s in enumerate(data["scenes"])),
    )
    for key, names in (
        ("formulations", [f.label for f in spec.formulations]),
        ("scenes", [s.name for s in spec.scenes]),
    ):
        if len(set(names)) != len(names):
            reader.fail(f"/{key}", names, "every name once")
    return spec
