"""A gap map as data: configs/gap_map/NAME.json, and the sweeps that it asks for."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from barrierbench_analysis.io.digests import of_file
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.spec_file import read_spec as read_json_spec
from barrierbench_analysis.io.spec_file import refused, require_base
from barrierbench_analysis.studies.kit.runs import Sweep, sweep
from barrierbench_analysis.tables.accuracy.shapes import barrier

LIMITS = {
    "on": "contact and strain limit take shape and theta",
    "contact": "contact alone takes them; the limit is a log matched at theta 0.1, the same in every run",
    "off": "no strain limit",
}
REFERENCE = "log"
LIMIT_THETA = 0.1
PARTS = {
    "quick": "minutes, where the whole takes hours",
    "large": "the larger resolutions of few shapes and gaps",
}  # of a spec that may be run alone; quick has to be there


@dataclass(frozen=True)
class Scene:
    label: str
    obstacle: str
    settings: dict
    resolutions: dict[str, dict]  # label -> overrides
    unknowns: dict[str, int]  # label -> free degrees of freedom
    limits: tuple[str, ...]


@dataclass(frozen=True)
class Cell:
    """One run that the map asks for."""

    scene: str
    resolution: str
    shape: str
    limit: str
    theta: float

    @property
    def label(self) -> str:
        return f"{self.scene} {self.resolution} {self.shape} {self.limit} theta{self.theta:g}"

    @property
    def key(self) -> tuple[str, str, str, str, float]:
        return self.scene, self.resolution, self.shape, self.limit, self.theta


@dataclass(frozen=True)
class Spec:
    path: Path
    sha256: str
    name: str
    doc: str
    base: Path
    common: dict
    shapes: dict[str, tuple[str, str]]  # label -> shape, argument
    main: tuple[str, ...]  # of the first figure; the others are in the supplement
    gaps: tuple[float, ...]  # targets, largest first
    limits: tuple[str, ...]
    scenes: tuple[Scene, ...]


def _falling(values: list, path: Path, place: str) -> tuple[float, ...]:
    if sorted(values, reverse=True) != values:
        raise refused(path, place, values, "a falling list of gaps in (0, 1), each once,")
    return tuple(map(float, values))


def _some(values: list, allowed: Iterable[str], path: Path, place: str) -> tuple[str, ...]:
    if any(value not in allowed for value in values):
        raise refused(path, place, values, f"a list of some of {', '.join(allowed)}, each once,")
    return tuple(values)


def _with_reference(values: Sequence[str], path: Path, place: str) -> None:
    """Each label once, the reference among them."""
    if REFERENCE not in values or len(set(values)) < len(values):
        raise refused(path, place, list(values), f"labels, each once, {REFERENCE!r} among them,")


def read_spec(path: Path) -> Spec:
    """Errors: UserError with file, place, what was found and what is allowed."""
    data = read_json_spec(path, "gap_map")
    base = require_base(data, path)
    _with_reference([s["label"] for s in data["shapes"]], path, "shapes")
    shapes = {s["label"]: (s["shape"], s["argument"]) for s in data["shapes"]}
    limits = tuple(data["limits"])
    scenes = tuple(
        Scene(
            s["label"],
            s["obstacle"],
            s["set"],
            {label: r["set"] for label, r in s["resolutions"].items()},
            {label: r["unknowns"] for label, r in s["resolutions"].items()},
            _some(s.get("limits", data["limits"]), limits, path, f"scenes/{s['label']}/limits"),
        )
        for s in data["scenes"]
    )
    if len({s.label for s in scenes}) < len(scenes):
        raise refused(path, "scenes", [s.label for s in scenes], "labels, each once,")
    main = _some(data["main"], shapes, path, "main")
    _with_reference(main, path, "main")
    gaps = _falling(data["gaps"], path, "gaps")
    return Spec(
        path, of_file(path), data["name"], data["doc"], base, data["set"], shapes, main, gaps, limits, scenes
    )


def part(spec: Spec, name: str) -> Spec:
    """A documented part of a spec, one of PARTS. Errors: UserError."""
    path, asked = spec.path, read_object(spec.path).get(name)
    if asked is None:
        raise refused(path, name, asked, "a part: scenes, shapes, gaps, limits")
    limits = _some(asked["limits"], spec.limits, path, f"{name}/limits")
    wholes, scenes = {s.label: s for s in spec.scenes}, []
    for label in _some(list(asked["scenes"]), wholes, path, f"{name}/scenes"):
        whole = wholes[label]
        kept = _some(asked["scenes"][label], whole.resolutions, path, f"{name}/scenes/{label}")
        scenes.append(
            replace(
                whole,
                resolutions={r: whole.resolutions[r] for r in kept},
                unknowns={r: whole.unknowns[r] for r in kept},
                limits=tuple(x for x in whole.limits if x in limits),
            )
        )
    shapes = _some(asked["shapes"], spec.shapes, path, f"{name}/shapes")
    _with_reference(shapes, path, f"{name}/shapes")
    gaps = _falling(asked["gaps"], path, f"{name}/gaps")
    if not set(gaps) <= set(spec.gaps):
        raise refused(path, f"{name}/gaps", list(gaps), f"some of {list(spec.gaps)}")
    return replace(
        spec,
        shapes={s: spec.shapes[s] for s in shapes},
        main=tuple(s for s in spec.main if s in shapes),
        gaps=gaps,
        limits=limits,
        scenes=tuple(scenes),
    )


def cells(spec: Spec) -> list[Cell]:
    return [
        Cell(scene.label, resolution, shape, limit, theta)
        for scene in spec.scenes
        for resolution in scene.resolutions
        for limit in scene.limits
        for shape in spec.shapes
        for theta in spec.gaps
    ]


def _log_slope(u: float) -> float:
    return -barrier("log", "gap", u, 1.0)[1]


def limit_settings(limit: str, shape: str, argument: str, theta: float) -> dict:
    """Of the strain limit. Matching has one theta for contact and limit; where contact alone varies, the
    scale undoes what theta does to the limit.
    """
    if limit == "off":
        return {"/strain_limit/enabled": False}
    if limit == "on":
        return {
            "/strain_limit/shape": shape,
            "/strain_limit/argument": argument,
            "/strain_limit/stiffness_policy": {"name": "fixed"},
        }
    return {
        "/strain_limit/shape": "log",
        "/strain_limit/argument": "gap",
        "/strain_limit/stiffness_policy": {
            "name": "fixed",
            "scale": _log_slope(theta) / _log_slope(LIMIT_THETA),
        },
    }


def settings(spec: Spec, cell: Cell) -> dict:
    """Overrides of the base config: pointer -> value."""
    scene = next(s for s in spec.scenes if s.label == cell.scene)
    shape, argument = spec.shapes[cell.shape]
    formulation = {
        "name": cell.shape,
        "shape": shape,
        "argument": argument,
        "stiffness_policy": {"name": "fixed"},
    }
    kept = {**scene.settings, **scene.resolutions[cell.resolution]}
    if "/formulation/d_hat_m" in kept:
        formulation["d_hat_m"] = kept.pop("/formulation/d_hat_m")
    return (
        kept
        | {"/formulation": formulation, "/matching/theta": cell.theta}
        | limit_settings(cell.limit, shape, argument, cell.theta)
    )


COMMON = {
    "/threads": 1,
    "/matching/rule": "equal_force",
    "/passes": {"time": False, "diagnose": True, "audit": True},
    "/diagnose/tier": 4,
    "/diagnose/scalings": ["none", "block_jacobi"],
    "/diagnose/stages": ["full", "without_contact"],
}


def make_sweep(spec: Spec, wanted: list[Cell]) -> Sweep:
    """The runs of some cells as one sweep file; those of a scene and resolution share calibration runs."""
    name = f"gap_map_{spec.name}"
    return sweep(
        name,
        spec.base,
        COMMON | spec.common,
        [{"label": cell.label, "set": settings(spec, cell)} for cell in wanted],
    )
