"""The gravity that a run has: of its base config with settings placed in it."""

import math
from pathlib import Path

from barrierbench_analysis.io.json_file import is_number, read_object
from barrierbench_analysis.io.spec_file import refused

KEY, STANDARD = "gravity_m_per_s2", 9.81  # of a scene, and m/s^2 without it


def gravity_of(base: Path, settings: dict, file: Path, place: str) -> float:
    """m/s^2, of a config with settings (pointer -> value, at `place` of `file`) placed in it in the order and
    by the rules of the program. Errors: UserError with the file and the place of what cannot be read.
    """
    where, scene = (base, "scene"), read_object(base).get("scene")
    for key in ("", *sorted(settings)):
        value, here = (settings[key], (file, place + key)) if key else (scene, where)
        index = key.removeprefix(f"/scene/{KEY}/")
        if key in ("", "/scene"):
            if not isinstance(value, dict):
                raise refused(*here, value, "an object")
            name, gravity, where = value.get("name"), value.get(KEY, STANDARD), (here[0], f"{here[1]}/{KEY}")
        elif key == "/scene/name" and value != name:
            name, gravity = value, STANDARD  # a scene named anew starts anew
        elif key == f"/scene/{KEY}":
            gravity, where = value, here
        elif index != key:
            if not isinstance(gravity, list) or index not in map(str, range(len(gravity))):
                raise refused(*here, value, f"a place in {gravity}")
            gravity, where = [value if str(k) == index else g for k, g in enumerate(gravity)], here
    parts = gravity if isinstance(gravity, list) else [gravity]
    if not all(map(is_number, parts)) or (len(parts) != 3 if isinstance(gravity, list) else gravity < 0):
        raise refused(*where, gravity, "a number >= 0 or an array of three numbers")
    return math.hypot(*parts)
