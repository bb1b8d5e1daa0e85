"""What a sweep file asks of a run: its base with the settings of every axis, as far as claims have to know."""

from __future__ import annotations

import copy
import json
from functools import cache
from pathlib import Path

PRESETS = Path(__file__).resolve().parents[2] / "configs" / "formulations"


def put(config: dict, pointer: str, value) -> None:
    """config[pointer] = value. A formulation given by its name becomes an object where something of it is set."""
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


@cache
def _file(path: Path) -> str:
    return path.read_text()


def base_of(data: dict, path: Path) -> dict:
    return json.loads(_file((path.parent / data["base"]).resolve()))


def merged(data: dict, path: Path, *sets: dict) -> dict:
    config = base_of(data, path)
    for pointers in (data.get("set", {}), *sets):
        for pointer, value in pointers.items():
            put(config, pointer, value)
    return config


def _preset(formulation) -> dict:
    given = {"name": formulation} if isinstance(formulation, str) else dict(formulation or {})
    file = PRESETS / f"{given.get('name', '')}.json"
    made = json.loads(_file(file)).get("formulation", {}) if file.is_file() else {}
    return {**made, **given}


def theta_of(config: dict) -> float | None:
    """Where forces are matched: gap over d_hat. None for a stiffness as given."""
    matching = config.get("matching", {})
    return None if matching.get("rule", "equal_force") != "equal_force" else float(matching.get("theta", 0.1))


def limit_of(config: dict) -> str:
    """`off`, or the shape of the strain limit; where a scene has none and none is asked for, nothing is limited whatever this says."""
    limit = config.get("strain_limit", {})
    if limit.get("enabled") is False or (config["scene"].get("name") == "bodies" and not {"limit", "onset"} & limit.keys()):
        return "off"
    return limit.get("shape") or _preset(config.get("formulation")).get("shape", "as contact")
