"""The gravity that a run has: of its base config with settings placed in it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

from barrierbench_analysis.io.json_file import is_number, read_object
from barrierbench_analysis.io.spec_file import refused

KEY, STANDARD = "gravity_m_per_s2", 9.81  # of a scene, and m/s^2 without it


@dataclass(frozen=True)
class _Given:
    """What config and settings say so far, and where it was said last."""

    scene: object  # its name
    gravity: object
    file: Path
    place: str


def _of_base(base: Path) -> _Given:
    scene = read_object(base).get("scene")
    if not isinstance(scene, dict):
        raise refused(base, "scene", scene, "an object")
    return _Given(scene.get("name"), scene.get(KEY, STANDARD), base, f"scene/{KEY}")


def _placed(given: _Given, key: str, value, file: Path, place: str) -> _Given:
    """After the setting key = value, which stands at `place` of `file`."""
    if key == "/scene":
        if not isinstance(value, dict):
            raise refused(file, place, value, "an object")
        return _Given(value.get("name"), value.get(KEY, STANDARD), file, f"{place}/{KEY}")
    if key == "/scene/name" and value != given.scene:
        return replace(given, scene=value, gravity=STANDARD)  # a scene named anew starts anew
    if key == f"/scene/{KEY}":
        return _Given(given.scene, value, file, place)
    if key.startswith(f"/scene/{KEY}/"):
        index, old = key.rpartition("/")[2], given.gravity
        if not isinstance(old, list) or index not in map(str, range(len(old))):
            raise refused(file, place, value, f"a place in {old}")
        return _Given(given.scene, [value if str(k) == index else g for k, g in enumerate(old)], file, place)
    return given


def gravity_of(base: Path, settings: dict, file: Path, place: str) -> float:
    """m/s^2, of a config with settings (pointer -> value, at `place` of `file`) placed in it in the order and
    by the rules of the program. Errors: UserError with the file and the place that said it.
    """
    given = _of_base(base)
    for key in sorted(settings):
        given = _placed(given, key, settings[key], file, place + key)
    found = given.gravity
    parts = found if isinstance(found, list) else [found]
    if not all(map(is_number, parts)) or (len(parts) != 3 if isinstance(found, list) else found < 0):
        raise refused(given.file, given.place, found, "a number >= 0 or an array of three numbers")
    return math.hypot(*parts)
