"""The region of the study at size: which of its scenes and of their parameters may change, and how far."""

import copy
import functools
import json
import math
from pathlib import Path

from barrierbench_analysis.studies.kit.study.spec import Study, read_study
from barrierbench_analysis.studies.rules.at_size.cells import NO_THETA, TIGHT, settings
from barrierbench_analysis.studies.rules.at_size.loads import changed, of_label
from barrierbench_analysis.studies.rules.at_size.pairs import LOG, THETA

from .region import SEED, Axes, Choice, Point, Range, Region

NAME = "at_size"
LOADS = "Emv"  # factors on elasticity, mass and speed
OFF, ON = "off", "on"
AT = "@"  # between the formulation and the size of an arm


@functools.cache
def study() -> Study:
    """The study at size."""
    return read_study(NAME)


def _spans(about: dict) -> dict[str, Range]:
    """Of theta and of each changed load what the groups of the study span; the factor of no change is 1."""
    thetas = sorted({float(theta) for group in about["groups"] for theta in group["thetas"]})
    spans = {"theta": Range(thetas[0], thetas[-1], log=True)}
    for kind in LOADS:
        changes = [found for group in about["groups"] if (found := of_label(group["setting"]))]
        factors = [1.0, *(factor for what, factor in changes if what == kind)]
        spans[kind] = Range(min(factors), max(factors), log=True, base=1.0)
    return spans


def _between(own: float, other: float, log: bool = False) -> Range:
    return Range(min(own, other), max(own, other), log, base=own)


def axes(of: Study, label: str, size: str, changes: list[str]) -> Axes:
    """What may change in a scene: no value beyond those that some registered run of it has. changes: names of
    the axes that the spec of the adversary allows.
    """
    scene = next(one for one in of.about["scenes"] if one["label"] == label)
    masks = {name: mask for name, mask in of.about["masks"].items() if label in mask.get("scenes", [label])}
    own = settings(of, _place(label, size, LOG, "0.1", "audited"))
    d_hats = [
        one["set"]["/formulation/d_hat_m"]
        for one in scene["sizes"].values()
        if "/formulation/d_hat_m" in one["set"]
    ]
    found = _spans(of.about)
    if "friction" in masks:
        found["friction"] = _between(
            own.get("/friction", {}).get("mu", 0.0), masks["friction"]["set"]["/friction"]["mu"]
        )
    if "dt24" in masks:
        found["dt_s"] = _between(own["/time"]["dt_s"], masks["dt24"]["set"]["/time/dt_s"], log=True)
    if len(set(d_hats)) > 1:
        found["d_hat_m"] = Range(min(d_hats), max(d_hats), True, own["/formulation"]["d_hat_m"])
    found |= {name: Choice((OFF, ON)) for name in ("limit", "clamped") if name in masks}
    return {name: axis for name, axis in found.items() if name in changes} | {"seed": SEED}


def _place(scene: str, size: str, arm: str, theta: str, measure: str) -> dict[str, str]:
    return {"scene": scene, "size": size, "arm": arm, "theta": theta, "setting": "base", "measure": measure}


@functools.cache
def _unchanged(scene: str, size: str, arm: str, theta: str, measure: str) -> str:
    """Settings of a registered run of the study as JSON, which is quick to copy."""
    return json.dumps(settings(study(), _place(scene, size, arm, theta, measure)))


def of_point(of: Study, point: Point, arm: str, measure: str, theta: str = "") -> tuple[Path, dict]:
    """Base config and settings of a run. The stiffness is that which was matched to the unchanged load, as in
    the changed loads of the study. arm: FORMULATION@SIZE. theta: where the point has none."""
    values, theta = point.values, theta or THETA
    name, _, size = arm.partition(AT)
    matched = of.about["arms"][name]["matched"]
    found = json.loads(_unchanged(point.scene, size, name, theta if matched else NO_THETA, measure))
    if matched and "theta" in values:
        found["/matching"]["theta"] = values["theta"]
    masks = of.about["masks"]
    if "friction" in values:
        found["/friction"] = {**found.get("/friction", {}), "mu": values["friction"]}
    if "d_hat_m" in values:
        found["/formulation"]["d_hat_m"] = values["d_hat_m"]
    if "dt_s" in values:
        time = found["/time"]
        steps = math.ceil(round(time["steps"] * time["dt_s"] / values["dt_s"], 9))
        found["/time"] = {**time, "dt_s": values["dt_s"], "steps": steps}
    for name in ("limit", "clamped"):
        if values.get(name) == ON:
            found |= copy.deepcopy(masks[name]["set"])
    for kind in LOADS:
        if values.get(kind, 1.0) != 1.0:
            found = changed(found, f"{kind}{values[kind]}")
    d_hat, dt = found["/formulation"]["d_hat_m"], found["/time"]["dt_s"]
    more = {"/step_solver/tol_velocity_m_per_s": TIGHT * d_hat / dt, "/seeds/main": values["seed"]}
    return of.base, {**of.data["set"], **found, **more}


def region(
    of: Study,
    about: dict,
    measure: str,
    theta: str = "",
    kinds: tuple[str, ...] = (),
    fixed: tuple[str, ...] = (),
) -> Region:
    """theta: of every run, where the statement names one. kinds: of the scenes, all without any. fixed: what
    does not change beside it.
    """
    labels = [one["label"] for one in of.about["scenes"] if not kinds or one["kind"] in kinds]
    changes = [name for name in about["changes"] if name not in (*fixed, *(["theta"] if theta else []))]
    scenes = {label: axes(of, label, about["size"], changes) for label in labels}
    return Region(scenes, lambda point, arm: of_point(of, point, arm, measure, theta))
