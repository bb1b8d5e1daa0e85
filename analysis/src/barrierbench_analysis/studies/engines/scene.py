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
    cells = [*scene["triangles"], *scene.get("segments", [])]
    named = [*given["vertices"], *(v for cell in cells for v in cell)]
    if named and max(named) >= n:
        raise refused(path, "triangles, segments or given/vertices", max(named), f"numbers below {n}")
    for k, frame in enumerate(given["positions_m"]):
        if len(frame) != len(given["vertices"]):
            raise refused(path, f"given/positions_m/{k}", len(frame), f"{len(given['vertices'])} points")
    if len(given["positions_m"]) not in (1, scene["steps"] + 1):
        wanted = f"1, or one more than {scene['steps']} steps,"
        raise refused(path, "given/positions_m", len(given["positions_m"]), wanted)
    for k, o in enumerate(scene["obstacles"]):
        if "points_m" in o and len(o["points_m"]) != scene["steps"] + 1:
            wanted = f"one more than {scene['steps']} steps,"
            raise refused(path, f"obstacles/{k}/points_m", len(o["points_m"]), wanted)


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


def _weights(rest: np.ndarray, scene: dict) -> np.ndarray:
    """[n] area (m^2) or length (m) of the cells of a vertex, a share of each at each corner."""
    triangles = np.array(scene["triangles"], int).reshape(-1, 3)
    segments = np.array(scene.get("segments", []), int).reshape(-1, 2)
    a, b = (rest[triangles[:, k]] - rest[triangles[:, 0]] for k in (1, 2))
    sizes = (
        (triangles, np.linalg.norm(np.cross(a, b), axis=1) / 2),
        (segments, np.linalg.norm(rest[segments[:, 1]] - rest[segments[:, 0]], axis=1)),
    )
    share = np.zeros(len(rest))
    for cells, size in sizes:
        np.add.at(share, cells, (size / cells.shape[1])[:, None])
    return share


def _material(body: dict, density: float) -> dict:
    """Of a body as a config has it: what `bench judge` computes elastic energies of."""
    out = {"bending_J": body["hinge_J"]} if body["hinge_J"] > 0 else {}
    if membrane := body.get("membrane"):
        mu, lam = membrane["lame_mu_N_per_m"], membrane["lame_lambda_N_per_m"]
        poisson = lam / (lam + 2 * mu)  # plane stress
        out |= {"model": membrane["model"], "youngs_N_per_m": 2 * mu * (1 + poisson), "poisson": poisson}
        out |= {"density_kg_per_m2": density}
    if rod := body.get("rod"):
        out |= {"rod_stretching_N": rod["stretching_N"], "rod_bending_N_m2": rod["bending_N_m2"]}
        out |= {"rod_rest": "straight" if rod.get("straight") else "shape", "line_density_kg_per_m": density}
    return out


def about(scene: dict) -> dict:
    """barrierbench.judge/1 (./bench judge --about): bodies, materials, obstacles, given vertices."""
    rest, mass = np.array(scene["rest_m"]), np.array(scene["mass_kg"])
    share = _weights(rest, scene)
    density, materials = {}, {}
    for body in scene["bodies"]:
        first, last = body["first_vertex"], body["first_vertex"] + body["vertices"]
        free = np.flatnonzero(mass[first:last] > 0) + first  # given vertices have no mass in the scene
        if len(free) and share[free].sum() > 0:
            mean = float(mass[free].sum() / share[free].sum())
            if "membrane" in body or "rod" in body:
                materials[body["name"]] = _material(body, mean)
            else:
                density[body["name"]] = mean
    moving = ("kind", "points_m", "axis", "radius_m", "inside", "name")
    resting = ("kind", "point_m", "axis", "radius_m", "inside", "name")
    return {
        "schema": "barrierbench.judge/1",
        "bodies": [{"name": body["name"], "vertices": body["vertices"]} for body in scene["bodies"]],
        "given_vertices": scene["given"]["vertices"],
        "rest_m": scene["rest_m"],
        "obstacles": [
            {key: o[key] for key in (moving if "points_m" in o else resting) if key in o}
            for o in scene["obstacles"]
        ],
        "dt_s": scene["dt_s"],
        "gravity_m_s2": scene["gravity_m_s2"],
        **({"density": density} if density else {}),
        **({"materials": materials} if materials else {}),
    }
