"""Sweeps over stiffness as data: configs/pareto/NAME.json."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from barrierbench_analysis.io.digests import of_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.spec_file import read_spec as read_json_spec
from barrierbench_analysis.io.spec_file import refused, require_base
from barrierbench_analysis.studies.kit.formulations import preset, settings
from barrierbench_analysis.studies.kit.runs import Sweep, sweep

DECADES = 4.0  # a sweep over stiffness spans at least these
GAPS = {"min": "gap_min", "median": "gap_median"}  # word of a spec -> metric
OPTIONAL = {"doc": "", "vary": "both", "gap": "min", "set": {}}


@dataclass(frozen=True)
class Spec:
    """A sweep over stiffness. scales: factors on the matched stiffness; starts: how many values of
    /seeds/main; gaps: d/d_hat of the tables.
    """

    path: Path
    sha256: str
    name: str
    doc: str
    base: Path
    formulations: tuple[str, ...]
    vary: str
    scales: tuple[float, ...]
    starts: int
    jitter_m: float
    gap: str
    gaps: tuple[float, ...]
    common: dict
    scenes: dict[str, dict]  # label -> overrides

    @property
    def gap_metric(self) -> str:
        return GAPS[self.gap]


def _growing(values: list, path: Path, key: str) -> tuple[float, ...]:
    if values != sorted(values):
        raise refused(path, key, values, "a list of growing numbers, each once,")
    return tuple(map(float, values))


def _scales(data: dict, path: Path) -> tuple[float, ...]:
    scales = _growing(data["scales"], path, "scales")
    decades = math.log10(scales[-1] / scales[0])
    if decades < DECADES - 1e-9 or not scales[0] < 1 < scales[-1]:
        raise UserError(
            f"{path}#/scales: found {scales[0]:g} to {scales[-1]:g}, {decades:.2g} decades; at least"
            f" {DECADES:g} decades round 1 are needed"
        )
    return scales


def _formulations(names: list, path: Path) -> tuple[str, ...]:
    for k, name in enumerate(names):
        try:
            preset(name)
        except UserError as error:
            raise UserError(f"{path}#/formulations/{k}: {error}") from None
    return tuple(names)


def _overrides(found: dict, place: str) -> dict:
    """Settings that are not the sweep's own; d_hat is the scene's."""
    for pointer in found:
        if (
            pointer.startswith(("/matching", "/passes", "/seeds", "/formulation"))
            and pointer != "/formulation/d_hat_m"
        ):
            raise UserError(
                f"{place}: found {pointer!r}; the sweep sets formulation, matching, passes and seeds itself;"
                " of these only /formulation/d_hat_m is allowed"
            )
    return found


def _scenes(scenes: list, path: Path) -> dict[str, dict]:
    if len({s["label"] for s in scenes}) < len(scenes):
        raise refused(path, "scenes", [s["label"] for s in scenes], "labels, each once,")
    return {s["label"]: _overrides(s["set"], f"{path}#/scenes/{s['label']}/set") for s in scenes}


def read_spec(path: Path) -> Spec:
    """Errors: UserError with file, place, what was found and what is allowed."""
    data = OPTIONAL | read_json_spec(path, "pareto")
    base = require_base(data, path)
    return Spec(
        path,
        of_file(path),
        data["name"],
        data["doc"],
        base,
        _formulations(data["formulations"], path),
        data["vary"],
        _scales(data, path),
        data["starts"],
        float(data["jitter_m"]),
        data["gap"],
        _growing(data["gaps"], path, "gaps"),
        _overrides(data["set"], f"{path}#/set"),
        _scenes(data["scenes"], path),
    )


def label(scene: str, formulation: str, scale: float) -> str:
    return f"{scene} {formulation} x{scale:g}"


def make_sweep(spec: Spec) -> Sweep:
    """One case a scene, formulation and scale; every one from the same starts."""
    cases = []
    for scene, overrides in spec.scenes.items():
        d_hat = overrides.get("/formulation/d_hat_m", spec.common.get("/formulation/d_hat_m"))
        kept = {pointer: value for pointer, value in overrides.items() if pointer != "/formulation/d_hat_m"}
        cases += [
            {"label": label(scene, name, scale), "set": kept | settings(name, spec.vary, d_hat, scale)}
            for name in spec.formulations
            for scale in spec.scales
        ]
    common = {
        "/threads": 1,
        "/matching/rule": "equal_force",
        "/seeds/jitter_m": spec.jitter_m,
        "/passes": {"time": True, "diagnose": True, "audit": True},
        "/diagnose/scalings": ["none", "block_jacobi"],
        "/diagnose/stages": ["full", "without_contact", "without_contact_and_limit"],
    } | spec.common
    return sweep(f"pareto_{spec.name}", spec.base, common, cases, list(range(1, spec.starts + 1)))
