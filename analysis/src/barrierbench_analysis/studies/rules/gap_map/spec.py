"""The runs that the key `about` of a spec asks for: every shape in every scene, resolution and limit mode at
every target theta.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from barrierbench_analysis.io.spec_file import refused
from barrierbench_analysis.program.start import evaluated
from barrierbench_analysis.studies.kit.study.spec import Case, Study
from barrierbench_analysis.tables.accuracy.shapes import SHAPES, barrier

LIMITS = {
    "on": "contact and strain limit take shape and theta",
    "contact": "contact alone takes them; the limit is a log matched at theta 0.1, the same in every run",
    "off": "no strain limit",
}
REFERENCE = "log"
LIMIT_THETA = 0.1
NEAR = 1e-6  # relative step towards contact


class Run(NamedTuple):
    """One run of the map. Its fields are the axes."""

    scene: str
    resolution: str
    shape: str
    limit: str
    theta: float

    @property
    def place(self) -> dict[str, str]:
        return {**self._asdict(), "theta": f"{self.theta:g}"}


def run_of(place: dict[str, str]) -> Run:
    return Run(**{**place, "theta": float(place["theta"])})


def check(about: dict, file: Path) -> None:
    """What no schema can say. Errors: UserError with the place, what was found and what is allowed."""

    def some(values: list, allowed: Iterable[str], place: str) -> None:
        if not set(values) <= set(allowed):
            raise refused(
                file, f"about/{place}", values, f"a list of some of {', '.join(allowed)}, each once,"
            )

    labels = [shape["label"] for shape in about["shapes"]]
    some(about["main"], labels, "main")
    for place, values in (("shapes", labels), ("main", about["main"])):
        if REFERENCE not in values or len(set(values)) < len(values):
            raise refused(file, f"about/{place}", values, f"labels, each once, {REFERENCE!r} among them,")
    if sorted(about["gaps"], reverse=True) != about["gaps"]:
        raise refused(file, "about/gaps", about["gaps"], "a falling list of gaps in (0, 1), each once,")
    scenes = [scene["label"] for scene in about["scenes"]]
    if len(set(scenes)) < len(scenes):
        raise refused(file, "about/scenes", scenes, "labels, each once,")
    for scene in about["scenes"]:
        some(scene.get("limits", []), about["limits"], f"scenes/{scene['label']}/limits")


def runs(about: dict) -> list[Run]:
    """All runs of a map in the order of its spec, with those whose target no contact can reach."""
    return [
        Run(scene["label"], resolution, shape["label"], limit, theta)
        for scene in about["scenes"]
        for resolution in scene["resolutions"]
        for limit in scene.get("limits", about["limits"])
        for shape in about["shapes"]
        for theta in about["gaps"]
    ]


def reachable(about: dict) -> set[tuple[str, float]]:
    """(label of a shape, theta) where the force grows towards contact. Where it falls, what equal force would
    give rests at another gap, on the far side of the peak.
    """
    return {
        (shape["label"], theta)
        for shape in about["shapes"]
        for theta in about["gaps"]
        if _grows(shape["shape"], shape["argument"], theta)
    }


def _grows(shape: str, argument: str, theta: float) -> bool:
    """By the closed form, so that a page needs no program; by the program for a shape without one."""
    if shape not in SHAPES:
        query = {"kind": "shape", "shape": shape, "argument": argument, "d": theta, "d_hat": 1}
        return evaluated([query])[0]["d2b"] > 0
    nearer, here = (barrier(shape, argument, u, 1.0)[1] for u in (theta * (1 - NEAR), theta))
    return nearer < here


def _log_slope(u: float) -> float:
    return -barrier("log", "gap", u, 1.0)[1]


def limit_settings(limit: str, shape: str, argument: str, theta: float) -> dict:
    """Of the strain limit. Matching has one theta for contact and limit; where contact alone varies, the
    scale undoes what theta does to the limit.
    """
    if limit == "off":
        return {"/strain_limit/enabled": False}
    policy: dict = {"name": "fixed"}
    if limit == "contact":
        shape, argument = "log", "gap"
        policy["scale"] = _log_slope(theta) / _log_slope(LIMIT_THETA)
    return {
        "/strain_limit/shape": shape,
        "/strain_limit/argument": argument,
        "/strain_limit/stiffness_policy": policy,
    }


def settings(scene: dict, resolution: str, formulation: dict, theta: float) -> dict:
    """Overrides of the base config, pointer -> value, without those of the strain limit."""
    found = {**scene["set"], **scene["resolutions"][resolution]["set"]}
    if "/formulation/d_hat_m" in found:
        formulation = {**formulation, "d_hat_m": found.pop("/formulation/d_hat_m")}
    return found | {"/formulation": formulation, "/matching/theta": theta}


def cells(study: Study) -> list[Case]:
    """The runs of the map that can reach their target, the fewest unknowns and the largest targets first,
    since a run may decide those of smaller targets. Errors: UserError for what no schema can say.
    """
    about = study.about
    check(about, study.file)
    shapes = {shape.pop("label"): shape for shape in map(dict, about["shapes"])}
    scenes, there = {scene["label"]: scene for scene in about["scenes"]}, reachable(about)

    def case(run: Run) -> Case:
        scene, shape = scenes[run.scene], shapes[run.shape]
        formulation = {"name": run.shape, **shape, "stiffness_policy": {"name": "fixed"}}
        limit = limit_settings(run.limit, **shape, theta=run.theta)
        return Case(
            run.place,
            settings(scene, run.resolution, formulation, run.theta) | limit,
            unknowns=scene["resolutions"][run.resolution]["unknowns"],
        )

    found = [case(run) for run in runs(about) if (run.shape, run.theta) in there]
    axes = ("scene", "resolution", "limit")
    return sorted(found, key=lambda c: (c.unknowns, *(c.place[a] for a in axes), -float(c.place["theta"])))
