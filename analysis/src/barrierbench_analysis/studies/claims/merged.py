"""What a sweep file asks of a run: its base with the settings of every axis, as far as claims have to
know."""

import copy
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object

from .entry import METHOD, ROOT, method_set

PRESETS = ROOT / "configs" / "formulations"
WITHOUT_LIMIT = ("bodies", "resting_block_1d")  # scenes without a limit of their own (experiments/scenes)


def put(config: dict, pointer: str, value) -> None:
    """config[pointer] = value. A formulation given by its name becomes an object where something of it is
    set.
    """
    *way, last = pointer.strip("/").split("/")
    at = config
    for word in way:
        if isinstance(at, list):
            at = at[int(word)]
            continue
        if isinstance(at.get(word), str):
            at[word] = {"name": at[word]}
        at = at.setdefault(word, {})
    if isinstance(at, list):
        at[int(last)] = copy.deepcopy(value)
    else:
        at[last] = copy.deepcopy(value)


def base_path(data: dict, path: Path) -> Path:
    return (path.parent / data["base"]).resolve()


def base_of(data: dict, path: Path) -> dict:
    """Errors: UserError for a base that extends another config: nothing here lays one over the other."""
    base = read_object(base_path(data, path))
    if "extends" in base:
        raise UserError(f"{base_path(data, path)}: /extends: a config that stands alone is needed here")
    return base


def _length(config: dict, pointer: str) -> None:
    """steps and duration_s replace each other, as in the program; a new dt leaves the duration."""
    time = config.get("time")
    if not isinstance(time, dict) or (pointer == "/time/dt_s" and "duration_s" not in time):
        return
    for key in {"/time/steps": ["duration_s"], "/time/duration_s": ["steps"], "/time/dt_s": ["steps"]}.get(
        pointer, ()
    ):
        time.pop(key, None)


def _keep_duration(config: dict) -> None:
    """Steps below a method with a dt of its own stand for the time that they take. Steps of a scene's own dt
    are left: no sweep of a claim has them.
    """
    time = config.get("time")
    if isinstance(time, dict) and {"steps", "dt_s"} <= time.keys() and "duration_s" not in time:
        time["duration_s"] = time["dt_s"] * time.pop("steps")


def merged(data: dict, path: Path, *sets: dict) -> dict:
    """A method lies over the base and under all settings of the sweep, as in the program."""
    config = base_of(data, path)
    given = [data.get("set", {}), *sets]
    methods = [pointers[METHOD] for pointers in given if METHOD in pointers]
    method = method_set(methods[-1] if methods else None)
    if "/time/dt_s" in method:
        _keep_duration(config)
    for pointers in (method, *given):
        for pointer, value in pointers.items():
            _length(config, pointer)
            put(config, pointer, value)
    return config


def formulation_of(config: dict) -> dict:
    """What a config gives laid over the preset that it names, as in the program; a policy of another name
    replaces the preset's.
    """
    formulation = config.get("formulation")
    given = {"name": formulation} if isinstance(formulation, str) else dict(formulation or {})
    file = PRESETS / f"{given.get('name', '')}.json"
    made = read_object(file).get("formulation", {}) if file.is_file() else {}
    whole, policy = {**made, **given}, given.get("stiffness_policy")
    if isinstance(policy, dict) and policy.get("name") in (
        None,
        made.get("stiffness_policy", {}).get("name"),
    ):
        whole["stiffness_policy"] = {**made.get("stiffness_policy", {}), **policy}
    return whole


def theta_of(config: dict) -> float | None:
    """Where forces are matched: gap over d_hat. None for a stiffness as given."""
    matching = config.get("matching", {})
    return None if matching.get("rule", "equal_force") != "equal_force" else float(matching.get("theta", 0.1))


def limit_of(config: dict) -> str:
    """`off`, or the shape of the strain limit. Off as well where neither scene nor config gives a limit: one
    that is asked for all the same is refused by the program.
    """
    limit = config.get("strain_limit", {})
    if limit.get("enabled") is False or (
        config["scene"].get("name") in WITHOUT_LIMIT and not {"limit", "onset"} & limit.keys()
    ):
        return "off"
    return limit.get("shape") or formulation_of(config).get("shape", "as contact")
