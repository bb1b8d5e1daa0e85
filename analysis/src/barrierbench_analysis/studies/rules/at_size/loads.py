"""Ten changed loads of a scene: its elasticity, its mass and its speed times a factor, with the stiffness of
the barriers as it was calibrated before.
"""

import copy
import math
import re

ELASTIC = ("youngs_N_per_m", "youngs_Pa", "bending_J", "solid_youngs_Pa", "rod_stretching_N")
MASS = ("density_kg_per_m2", "solid_density_kg_per_m3", "line_density_kg_per_m")
BY_MASS = "rod_bending_J_per_kg"
SPEEDS = ("velocity_m_per_s", "angular_velocity_rad_per_s")
TIMES = ("time_s", "start_s", "end_s")
LABEL = re.compile(r"([Emv])([\d.]+)")  # of a changed load: what is changed, and the factor on it
FIRST_M_PER_S = 0.5  # downward speed, times the factor, of a scene in which nothing moves at the start


def _scaled(material: dict, kind: str, factor: float) -> dict:
    keys = ELASTIC if kind == "E" else MASS
    found = {key: value * factor if key in keys else value for key, value in material.items()}
    if BY_MASS in found:  # bending is of E alone
        found[BY_MASS] = found[BY_MASS] * (factor if kind == "E" else 1 / factor)
    return found


def _times(value: object, factor: float) -> object:
    return [one * factor for one in value] if isinstance(value, list) else value * factor


def faster(motion: object, factor: float) -> object:
    """A motion so many times as fast: speeds times the factor, times over it."""
    if isinstance(motion, list):
        return [faster(one, factor) for one in motion]
    if not isinstance(motion, dict):
        return motion
    found = {}
    for key, value in motion.items():
        if key in SPEEDS:
            found[key] = _times(value, factor)
        elif key in TIMES:
            found[key] = value / factor
        else:
            found[key] = faster(value, factor)
    return found


def _moves(bodies: list[dict]) -> bool:
    pins = [pin for body in bodies for pin in body.get("pins", [])]
    return any("motion" in one for one in (*bodies, *pins)) or any("velocity_m_per_s" in b for b in bodies)


def _sped(settings: dict, factor: float) -> dict:
    bodies, time = settings["/scene"]["bodies"], settings["/time"]
    still = not _moves(bodies)
    for body in bodies:
        for part in (body, *body.get("pins", [])):
            if "motion" in part:
                part["motion"] = faster(part["motion"], factor)
        if "velocity_m_per_s" in body:
            body["velocity_m_per_s"] = _times(body["velocity_m_per_s"], factor)
        elif still and body.get("kind") != "rigid":
            body["velocity_m_per_s"] = [0, 0, -FIRST_M_PER_S * factor]
    time["steps"] = math.ceil(time["steps"] / factor)
    return settings


def of_label(label: str) -> tuple[str, float] | None:
    """What is changed, E, m or v, and the factor on it: of E0.01, m100, v4. None of a setting that is no
    changed load.
    """
    found = LABEL.fullmatch(label)
    return (found[1], float(found[2])) if found else None


def mass_factor(label: str) -> float:
    """What the mass is multiplied by in a setting."""
    kind, factor = of_label(label) or ("", 1.0)
    return factor if kind == "m" else 1.0


def changed(settings: dict, label: str) -> dict:
    """Settings of a run under a changed load, whose label is one."""
    settings, (kind, factor) = copy.deepcopy(settings), of_label(label)
    if kind == "v":
        return _sped(settings, factor)
    for body in settings["/scene"]["bodies"]:
        if "material" in body:
            body["material"] = _scaled(body["material"], kind, factor)
    return settings
