"""What is compared: formulations, contact models and tables, each as settings of a run."""

import random
from collections.abc import Iterator
from dataclasses import dataclass

from barrierbench_analysis.io import fields
from barrierbench_analysis.studies.kit import formulations
from barrierbench_analysis.studies.kit.study.spec import Case, Study

ALL_PAIRS, PLANE = "all_pairs", "plane"
FIXED = "fixed"
GRAVITY = 9.81  # m/s^2


@dataclass(frozen=True)
class Arm:
    """A formulation on a surface. model: of contact, or PLANE, the analytic plane with all pairs. level: the
    length of the table's edges, or PLANE.
    """

    formulation: str
    model: str
    level: str

    @property
    def policy(self) -> str:
        return formulations.preset(self.formulation)["stiffness_policy"]["name"]


def compared() -> list[str]:
    """Presets of formulations. Matching replaces a fixed kappa, so of presets that differ in nothing else
    the one with the shortest name stands for all.
    """
    found: dict[tuple, str] = {}
    for name in sorted(formulations.known(), key=lambda name: (len(name), name)):
        preset = formulations.preset(name)
        policy = preset["stiffness_policy"]
        rest = FIXED if policy["name"] == FIXED else str(sorted(policy.items()))
        found.setdefault((preset["shape"], preset["argument"], rest), name)
    return sorted(found.values())


def _values(key: str) -> list[str]:
    """What the program takes for a key of `/contact`."""
    return fields.schema("config")["properties"]["contact"]["properties"][key]["enum"]


def weightings() -> list[str]:
    """Ways to weight pairs, without that of no weights. Their stiffness is that of an area."""
    return [name for name in _values("weighting") if name != "none"]


def models() -> list[str]:
    """Contact models: all pairs without and with weights, and the other sets of pairs."""
    return [ALL_PAIRS, *weightings(), *(name for name in _values("model") if name != ALL_PAIRS)]


def arms(study: Study) -> Iterator[Arm]:
    """Every formulation on the plane and with every model on every table, but for models that the spec runs
    with one formulation (`once`).
    """
    once = study.about["once"]
    for name in compared():
        yield Arm(name, PLANE, PLANE)
        for model in models():
            if once.get(model, name) == name:
                yield from (Arm(name, model, level) for level in study.about["tables"])


def weight(study: Study) -> float:
    """Of the card, N."""
    card = study.about["card"]
    area = card["mesh"]["size_x_m"] * card["mesh"]["size_y_m"]
    return card["material"]["density_kg_per_m2"] * area * GRAVITY


def _stiffness(study: Study, arm: Arm, scale: float) -> dict:
    """scale: factor on a stiffness that would carry the card with too few contacts: one for each vertex, or
    with weights the area of the card.
    """
    about, mesh = study.about, study.about["card"]["mesh"]
    of_policy = "/formulation/stiffness_policy"
    found = {"/formulation": {"name": arm.formulation, "d_hat_m": about["d_hat_m"]}}
    if arm.model in weightings():
        found["/matching/rule"] = "as_given"
        if arm.policy == FIXED:  # others are refused with weights, for the policy
            area = mesh["size_x_m"] * mesh["size_y_m"]
            found[f"{of_policy}/kappa_N_per_m"] = weight(study) / area / about["d_hat_m"]
    else:
        load = weight(study) / (mesh["n_x"] * mesh["n_y"])
        found |= {"/matching/rule": "equal_force", "/matching/load_N": load}
        found["/matching/theta"] = about["theta"]
    return found | {f"{of_policy}/scale": scale}


def _contact(arm: Arm) -> dict:
    if arm.model in (ALL_PAIRS, PLANE):
        return {}
    return {"/contact/weighting" if arm.model in weightings() else "/contact/model": arm.model}


def _scene(study: Study, arm: Arm, placement: int) -> dict:
    """The card above the table, turned and moved at random, the same for all arms."""
    about, draws = study.about, random.Random(f"{study.about['seed']} {placement}")
    angle = draws.uniform(0, 360)
    x, y = (draws.uniform(-about["reach_m"], about["reach_m"]) for _ in range(2))
    transform = {"axis": [0, 0, 1], "angle_deg": angle, "translate_m": [x, y, about["height_m"]]}
    card = {"name": "card", **about["card"], "transform": transform}
    scene = {"name": "bodies", "gravity_m_per_s2": [0, 0, -GRAVITY], "bodies": [card]}
    if arm.model == PLANE:
        return scene | {"obstacles": [{"name": "table", "kind": "plane"}]}
    side, size = about["tables"][arm.level], about["table_m"]
    mesh = {"generator": "grid", "n_x": side, "n_y": side, "size_x_m": size, "size_y_m": size}
    scene["bodies"].append({"name": "table", "kind": "rigid", "mesh": mesh})
    return scene


def case(study: Study, arm: Arm, label: str, placement: int, scale: float) -> Case:
    place = {"formulation": arm.formulation, "model": arm.model, "level": arm.level, "placement": label}
    settings = {"/scene": _scene(study, arm, placement), **_stiffness(study, arm, scale), **_contact(arm)}
    return Case(place, settings)
