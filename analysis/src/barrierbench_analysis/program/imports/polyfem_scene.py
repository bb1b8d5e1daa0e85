"""A scene of PolyFEM as it is read: its JSON over the file that it names, units, numbers and conditions.

The meaning of keys is that of json-specs/input-spec.json of polyfem/polyfem at 661588e8d9.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import is_number, read_object

from .card import Card, leaves
from .config import SceneConfig
from .polyfem_geometry import LENGTHS

MASSES = {"kg": 1.0, "g": 1e-3, "mg": 1e-6, "t": 1e3, "lb": 0.45359237}
ROUNDING = 1e-9  # of a quotient of two times, of which the source takes the whole number above
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, "h": 3600.0}


def merged(path: Path, seen: tuple[Path, ...] = ()) -> dict:
    """A scene over the file that `common` names, object by object. Errors: UserError."""
    if path.resolve() in seen:
        raise UserError(f"{path}#/common: found a file that names itself; allowed: another file")
    data = read_object(path)
    name = data.get("common")
    if not name:
        return data
    if not isinstance(name, str):
        raise UserError(f"{path}#/common: found {name!r}; allowed: the path of a JSON file")
    return _patched(merged(path.parent / name, (*seen, path.resolve())), data)


def _patched(below: dict, above: dict) -> dict:
    """RFC 7396."""
    made = dict(below)
    for key, value in above.items():
        if value is None:
            made.pop(key, None)
        elif isinstance(value, dict):
            made[key] = _patched(made[key] if isinstance(made.get(key), dict) else {}, value)
        else:
            made[key] = value
    return made


@dataclass
class Units:
    """What one unit of the source is in SI."""

    length: float
    mass: float
    time: float
    length_name: str

    @property
    def pressure(self) -> float:
        return self.mass / (self.length * self.time**2)

    @property
    def density(self) -> float:
        return self.mass / self.length**3


class Scene:
    """One scene as it is read."""

    def __init__(self, path: Path, out: Path, steps: int | None) -> None:
        self.path, self.data = path, merged(path)
        self.card = Card(path, "polyfem", leaves(self.data))
        self.card.mapped("/common", "the whole config", "laid underneath this file")
        self.units = self._units()
        self.shortest_edge = math.inf  # of the surfaces of all bodies, in the unit of the scene
        dt, count = self._time()
        if steps:
            keys = [f"/time/{key}" for key in ("tend", "time_steps")]
            self.card.changed(keys, f"{count} steps", f"{steps} steps", "--steps")
        self.card.mapped(
            [f"/time/{key}" for key in ("dt", "tend", "time_steps")], "/time/dt_s and /time/steps"
        )
        self.config = SceneConfig(out, dt, steps or count)

    def section(self, key: str) -> dict:
        found = self.data.get(key) or {}
        if not isinstance(found, dict):
            raise self.card.refuse(f"/{key}", found, "an object")
        return found

    def conditions(self, section: str, key: str) -> list[tuple[str, dict]]:
        """The conditions of a kind with their places."""
        found = self.section(section).get(key) or []
        at = f"/{section}/{key}"
        listed = (
            [(f"{at}/{k}", one) for k, one in enumerate(found)] if isinstance(found, list) else [(at, found)]
        )
        for place, one in listed:
            if not isinstance(one, dict):
                raise self.card.refuse(place, one, "an object with id and value")
        return listed

    def number(self, pointer: str, value, low: float = -np.inf) -> float:
        """A number, also one with a unit of this scene. Errors: UserError."""
        if isinstance(value, dict) and "value" in value:
            raise self.card.refuse(pointer, value, "a number in the units of the scene")
        if not is_number(value) or value < low:
            raise self.card.refuse(pointer, value, "a number" + (f" >= {low:g}" if low > -np.inf else ""))
        return float(value)

    def _units(self) -> Units:
        given, made = self.section("units"), {}
        for key, table, usual in (("length", LENGTHS, "m"), ("mass", MASSES, "kg"), ("time", TIMES, "s")):
            made[key] = given.get(key, usual)
            if not isinstance(made[key], str) or made[key] not in table:
                raise self.card.refuse(f"/units/{key}", made[key], ", ".join(table))
            self.card.mapped(f"/units/{key}", "every number of the config", "converted to SI")
        return Units(LENGTHS[made["length"]], MASSES[made["mass"]], TIMES[made["time"]], made["length"])

    def _time(self) -> tuple[float, int]:
        """dt in s and the number of steps."""
        time, at = self.section("time"), "/time"
        if not time:
            self.card.default("/time", "one step of 1 s", "the source is static: one quasi-static load step")
            return 1.0, 1
        known = {
            key: self.number(f"{at}/{key}", time[key], 0)
            for key in ("dt", "tend", "time_steps")
            if key in time
        }
        if len(known) < 2:
            raise self.card.refuse(at, sorted(time), "two of dt, tend and time_steps")
        start = self.number(f"{at}/t0", time.get("t0", 0.0))
        dt = known["dt"] if "dt" in known else (known["tend"] - start) / known["time_steps"]
        count = known.get("time_steps") or (known["tend"] - start) / dt if dt > 0 else 0
        if dt <= 0 or count <= 0:
            raise self.card.refuse(at, known, "a step above 0 and an end behind the start")
        return dt * self.units.time, math.ceil(count * (1 - ROUNDING))
