"""Scenes for engines: the file that `bench export-scene` writes of a config, and what the judge reads of
it."""

import json
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.spec_file import checked, refused
from barrierbench_analysis.program.start import started

# Two squares that fall on a sphere in three frames, one corner held: whatever a scene may need.
SMALLEST = ROOT / "configs" / "engines" / "smallest.json"


def exported(config: Path, sets: list[str] = ()) -> dict:
    """The scene of a config as the program builds it. Errors: UserError with what the program says."""
    done = started("export-scene", str(config), *(word for one in sets for word in ("--set", one)))
    if done.returncode != 0:
        raise UserError(f"{config}: {(done.stderr.strip() or 'no scene').splitlines()[-1]}")
    return json.loads(done.stdout)


def _check(scene: dict, path: Path) -> None:
    """What no schema says: counts that agree, vertices that are there."""
    n = len(scene["positions_m"])
    for key in ("rest_m", "velocities_m_s", "mass_kg"):
        if len(scene[key]) != n:
            raise refused(path, key, len(scene[key]), f"one for each of {n} vertices")
    if sum(body["vertices"] for body in scene["bodies"]) != n:
        raise refused(path, "bodies", [b["vertices"] for b in scene["bodies"]], f"a sum of {n} vertices")
    first = 0
    for k, body in enumerate(scene["bodies"]):
        if body["first_vertex"] != first:
            raise refused(path, f"bodies/{k}/first_vertex", body["first_vertex"], f"{first}, in order,")
        first += body["vertices"]
    given = scene["given"]
    named = [*given["vertices"], *(v for t in scene["triangles"] for v in t)]
    if named and max(named) >= n:
        raise refused(path, "triangles or given/vertices", max(named), f"numbers below {n}")
    for k, frame in enumerate(given["positions_m"]):
        if len(frame) != len(given["vertices"]):
            raise refused(path, f"given/positions_m/{k}", len(frame), f"{len(given['vertices'])} points")
    if len(given["positions_m"]) not in (1, scene["steps"] + 1):
        wanted = f"1, or one more than {scene['steps']} steps,"
        raise refused(path, "given/positions_m", len(given["positions_m"]), wanted)


def made(scene: dict, path: Path) -> dict:
    """A scene that is whole. Errors: UserError with the place in the file."""
    checked(scene, path, "engine_scene")
    _check(scene, path)
    return scene


def read(path: Path, sets: list[str] = ()) -> dict:
    """A scene from its own file, or of a config. Errors: UserError."""
    scene = read_object(path)
    if not str(scene.get("schema", "")).startswith("barrierbench.engine_scene/"):
        return exported(path, sets)
    if sets:
        raise UserError(f"--set: {path} is a scene, not a config")
    return made(scene, path)


def about(scene: dict) -> dict:
    """barrierbench.judge/1 (./bench judge --about): bodies, obstacles, given vertices, densities."""
    rest, mass = np.array(scene["rest_m"]), np.array(scene["mass_kg"])
    triangles = np.array(scene["triangles"], int).reshape(-1, 3)
    a, b = (rest[triangles[:, k]] - rest[triangles[:, 0]] for k in (1, 2))
    area = np.linalg.norm(np.cross(a, b), axis=1) / 2
    density = {}
    for body in scene["bodies"]:
        first, last = body["first_vertex"], body["first_vertex"] + body["vertices"]
        share = np.zeros(len(rest))
        own = (triangles[:, 0] >= first) & (triangles[:, 0] < last)
        np.add.at(share, triangles[own].ravel(), np.repeat(area[own] / 3, 3))
        free = np.flatnonzero(mass[first:last] > 0) + first  # given vertices have no mass in the scene
        if len(free) and share[free].sum() > 0:
            density[body["name"]] = float(mass[free].sum() / share[free].sum())
    keys = ("kind", "point_m", "axis", "radius_m", "inside", "name")
    return {
        "schema": "barrierbench.judge/1",
        "bodies": [{"name": body["name"], "vertices": body["vertices"]} for body in scene["bodies"]],
        "given_vertices": scene["given"]["vertices"],
        "obstacles": [{key: o[key] for key in keys if key in o} for o in scene["obstacles"]],
        "dt_s": scene["dt_s"],
        "gravity_m_s2": scene["gravity_m_s2"],
        **({"density": density} if density else {}),
    }
