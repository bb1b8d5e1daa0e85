"""The runs of the study: scenes at three sizes under four formulations, with one thing changed at a time."""

import copy
import math
from collections.abc import Iterator
from dataclasses import replace

from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.spec_file import refused
from barrierbench_analysis.studies.catalogue.entry import MINI, read_entry
from barrierbench_analysis.studies.claims.merged import put
from barrierbench_analysis.studies.kit.study.spec import Case, Study

from .loads import changed

NOT_OF_A_SCENE = ("schema", "name", "doc", "matching")
TIGHT = 1e-6  # of d_hat/h: the speed that ends a step, a hundredth of the program's default
BASE, GUESS = "base", "guess"
AXES = ("scene", "size", "arm", "theta", "setting", "measure")
NO_THETA = "-"  # of formulations that follow from mass and elasticity


def sections(study: Study, scene: dict, size: dict) -> dict[str, object]:
    """Settings that make the scene at a size: of the catalogue's mini scene or of a config beside the spec,
    with what the size sets (pointers, as in the catalogue), and without what the study sets itself.
    """
    if "catalogue" in scene:
        entry = read_entry(scene["catalogue"])
        mini = {**entry.data[MINI], "set": entry.data[MINI]["set"] | size["set"]}
        found = replace(entry, data={**entry.data, MINI: mini}).config()
    else:
        found = read_object(study.file.parent / scene["config"])
        for pointer, value in size["set"].items():
            put(found, pointer, value)
    return {f"/{key}": copy.deepcopy(value) for key, value in found.items() if key not in NOT_OF_A_SCENE}


def matching(scene: dict, size: dict, place: dict[str, str]) -> dict:
    """Both barriers carry load_N at theta d_hat. It is the largest load of a contact in the run of the log
    that is matched to a first guess (setting `guess`)."""
    if place["theta"] == NO_THETA:
        return {"rule": "as_given"}
    load = size["guess_N" if place["setting"] == GUESS else "load_N"]
    found = {"rule": "equal_force", "theta": float(place["theta"]), "load_N": load}
    return found | ({"limit_load_N_per_m": scene["limit_N_per_m"]} if "limit_N_per_m" in scene else {})


def sized(study: Study, place: dict[str, str]) -> tuple[dict, dict]:
    """What the spec says of the scene of a place, and of its size."""
    scene = next(one for one in study.about["scenes"] if one["label"] == place["scene"])
    return scene, scene["sizes"][place["size"]]


def settings(study: Study, place: dict[str, str]) -> dict:
    """All of one run. place: the label of every axis."""
    about = study.about
    scene, size = sized(study, place)
    found = sections(study, scene, size)
    found["/strain_limit"] = {"enabled": False}
    d_hat = found["/formulation"]["d_hat_m"]
    found["/formulation"] = {**about["arms"][place["arm"]]["formulation"], "d_hat_m": d_hat}
    found["/matching"] = matching(scene, size, place)
    found |= about["measures"][place["measure"]]
    if place["setting"] in about["masks"]:
        found |= _mask(about["masks"][place["setting"]], found)
    elif place["setting"] not in (BASE, GUESS):
        found = changed(found, place["setting"])
    found |= about["arms"][place["arm"]].get("set", {})
    if "/method" in found:  # its own step length and end of a step, over the same time
        time = found.pop("/time")
        found["/time/steps"] = round(time["steps"] * time["dt_s"] / about["method_dt_s"])
        found["/formulation/d_hat_m"] = found.pop("/formulation")["d_hat_m"]
        del found["/matching"]
        return {k: v for k, v in found.items() if not k.startswith("/linear_solver")}
    found["/step_solver/tol_velocity_m_per_s"] = TIGHT * d_hat / found["/time"]["dt_s"]
    return found


def _mask(mask: dict, found: dict) -> dict:
    """What a mask changes. One with its own step length keeps the time that is simulated."""
    more = dict(mask["set"])
    if dt := more.pop("/time/dt_s", None):
        steps = math.ceil(found["/time"]["steps"] * found["/time"]["dt_s"] / dt)
        more["/time"] = {"dt_s": dt, "steps": steps}
    return more


def cells(study: Study) -> Iterator[Case]:
    """The runs in the order of the key `groups`, which is the order of their importance. Errors: UserError
    for labels that the spec does not define.
    """
    about = study.about
    scenes = {scene["label"]: scene for scene in about["scenes"]}
    for k, group in enumerate(about["groups"]):
        of_mask = about["masks"].get(group["setting"], {}).get("scenes", list(scenes))
        for key, labels, known in (
            ("arms", group["arms"], about["arms"]),
            ("measure", [group["measure"]], about["measures"]),
        ):
            if unknown := set(labels) - set(known):
                raise refused(study.file, f"about/groups/{k}/{key}", sorted(unknown), ", ".join(known))
        for size in group["sizes"]:
            for label in group.get("scenes", of_mask):
                yield from _of_scene(study, group, scenes[label], size)


def _of_scene(study: Study, group: dict, scene: dict, size: str) -> Iterator[Case]:
    needed = "guess_N" if group["setting"] == GUESS else "load_N"
    if needed not in scene["sizes"].get(size, {}):
        return  # a size whose load is not known yet
    for arm in group["arms"]:
        for theta in group["thetas"] if study.about["arms"][arm]["matched"] else [NO_THETA]:
            words = (scene["label"], size, arm, theta, group["setting"], group["measure"])
            place = dict(zip(AXES, words, strict=True))
            yield Case(place, settings(study, place), unknowns=scene["sizes"][size]["unknowns"])
