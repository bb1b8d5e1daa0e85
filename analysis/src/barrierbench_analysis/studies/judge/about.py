"""What the frames of another program do not say: --about FILE (configs/schema/judge.schema.json)."""

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.spec_file import read_spec, refused
from barrierbench_analysis.program.trajectories.trajectory import Topology, Trajectory, checked


@dataclass(frozen=True)
class About:
    """Densities of a body: kg/m^3 of tetrahedra, kg/m^2 of triangles, kg/m of segments."""

    given: np.ndarray  # vertices that the scene moves
    half_thickness_m: np.ndarray | None  # [n_vertices]
    density: dict[str, float] = field(default_factory=dict)
    materials: dict[str, dict] = field(default_factory=dict)  # of a body: keys of a config's material
    rest_m: np.ndarray | None = None  # [n_vertices, 3]; None: the first frame
    paths_m: dict[int, np.ndarray] = field(
        default_factory=dict
    )  # number of an obstacle that moves: [frames, 3]
    dt_s: float | None = None
    gravity_m_s2: tuple[float, float, float] = (0.0, 0.0, 0.0)


def _cells(data: dict, path: Path, key: str, topology: Topology) -> np.ndarray:
    """Those of the frames, and those of the file."""
    own, n, rows = getattr(topology, key), topology.n_vertices, data.get(key, [])
    for k, row in enumerate(rows):
        if max(row) >= n or len(set(row)) < len(row):
            raise refused(path, f"{key}/{k}", row, f"a list of different numbers from 0 to {n - 1}")
    return np.concatenate([own, np.array(rows, np.int64).reshape(-1, own.shape[1])])


def _check_whole_cells(path: Path, topology: Topology) -> None:
    """Errors: UserError with the first cell that has vertices of two bodies."""
    body = topology.body_of_vertices()
    for key in ("triangles", "segments", "tetrahedra"):
        cells = getattr(topology, key)
        split = np.flatnonzero((body[cells] != body[cells[:, :1]]).any(axis=1))
        if len(split):
            cell = cells[split[0]]
            first, other = (topology.names[k] for k in np.unique(body[cell])[:2])
            raise refused(
                path,
                "bodies",
                f"the cell {cell.tolist()} of `{key}` (one of {len(split)}) with vertices of {first!r} and"
                f" of {other!r}",
                "a list of bodies of which each has all vertices of its cells",
            )


def _with_bodies(data: dict, path: Path, trajectory: Trajectory) -> Trajectory:
    """Bodies by their numbers of vertices, in order."""
    if "bodies" not in data:
        return trajectory
    counts = [body["vertices"] for body in data["bodies"]]
    names = [body["name"] for body in data["bodies"]]
    n = trajectory.topology.n_vertices
    if sum(counts) != n:
        raise refused(path, "bodies", sum(counts), f"a sum of {n} vertices")
    if len(set(names)) != len(names):
        raise refused(path, "bodies", names, "a name for each body")
    first = tuple(np.cumsum([0, *counts[:-1]]).tolist())
    topology = replace(trajectory.topology, names=tuple(names), first_vertex=first)
    _check_whole_cells(path, topology)
    return replace(trajectory, topology=topology)


def _body(name: str, path: Path, place: str, trajectory: Trajectory) -> np.ndarray:
    """Its vertices."""
    t = trajectory.topology
    if name not in t.names:
        raise refused(path, place, name, f"one of {', '.join(t.names)}")
    return np.flatnonzero(t.body_of_vertices() == t.names.index(name))


def with_cells(trajectory: Trajectory, path: Path | None) -> tuple[dict, Trajectory]:
    """The file's keys, and the trajectory with its cells, bodies and obstacles."""
    if path is None:
        return {}, trajectory
    data = read_spec(path, "judge")
    t = trajectory.topology
    topology = replace(
        t,
        **{name: _cells(data, path, name, t) for name in ("triangles", "segments", "tetrahedra")},
    )
    more = replace(
        trajectory,
        topology=topology,
        obstacles=trajectory.obstacles + data.get("obstacles", []),
        planar=data.get("planar", trajectory.planar),
    )
    return data, _with_bodies(data, path, checked(more))


def _half_thickness(data: dict, path: Path, trajectory: Trajectory) -> np.ndarray | None:
    if "thickness_m" not in data:
        return trajectory.half_thickness_m
    thickness, n = data["thickness_m"], trajectory.topology.n_vertices
    by_body = thickness if isinstance(thickness, dict) else {}
    half = np.full(n, 0.0 if isinstance(thickness, dict) else thickness / 2)
    for name, value in by_body.items():
        half[_body(name, path, f"thickness_m/{name}", trajectory)] = value / 2
    return half


DENSITIES = ("density_kg_per_m2", "line_density_kg_per_m", "solid_density_kg_per_m3")  # keys of materials


def _densities(data: dict, path: Path, trajectory: Trajectory) -> dict[str, float]:
    """By name of a body, those that materials state too. Errors: UserError for a body with two."""
    out = dict(data.get("density", {}))
    for name in out:
        _body(name, path, f"density/{name}", trajectory)
    for name, material in data.get("materials", {}).items():
        _body(name, path, f"materials/{name}", trajectory)
        keys = [key for key in DENSITIES if key in material]
        if name in out and keys:
            raise refused(path, f"density/{name}", out[name], f"nothing beside materials/{name}/{keys[0]}")
        if len(keys) > 1:
            raise refused(path, f"materials/{name}/{keys[1]}", material[keys[1]], "one density of a body")
        if keys:
            out[name] = material[keys[0]]
    return out


def _rest(data: dict, path: Path, trajectory: Trajectory) -> np.ndarray | None:
    if "rest_m" not in data:
        return None
    rest, n = np.array(data["rest_m"], float), trajectory.topology.n_vertices
    if len(rest) != n:
        raise refused(path, "rest_m", len(rest), f"a list of {n} points")
    return rest


def _paths(trajectory: Trajectory, path: Path) -> dict[int, np.ndarray]:
    """Of the obstacles with `points_m`."""
    out, frames = {}, len(trajectory.labels)
    for k, obstacle in enumerate(trajectory.obstacles):
        if "points_m" in obstacle:
            if len(obstacle["points_m"]) != frames:
                found, place = len(obstacle["points_m"]), f"obstacles/{obstacle.get('name', k)}/points_m"
                raise refused(path, place, found, f"a list of {frames} points, one for each frame,")
            out[k] = np.array(obstacle["points_m"], float)
    return out


def about_of(data: dict, path: Path | None, trajectory: Trajectory) -> About:
    """What refers to bodies by name. Errors: UserError with the place in the file."""
    n = trajectory.topology.n_vertices
    given = [_body(name, path, f"given/{k}", trajectory) for k, name in enumerate(data.get("given", []))]
    vertices = data.get("given_vertices", [])
    for k, vertex in enumerate(vertices):
        if vertex >= n:
            raise refused(path, f"given_vertices/{k}", vertex, f"a number below {n}")
    density = _densities(data, path, trajectory)
    if density and data.get("dt_s") is None and trajectory.times_s is None:
        place = "density" if "density" in data else "materials"
        raise UserError(f"{path}#/{place}: needs times of the frames for velocities: dt_s")
    if not np.isfinite(data.get("dt_s", 0.0) * len(trajectory.labels)):
        raise refused(path, "dt_s", data["dt_s"], "a step with which all times are finite")
    return About(
        np.unique(np.concatenate([*given, np.array(vertices, int)]).astype(int)),
        _half_thickness(data, path, trajectory),
        density,
        data.get("materials", {}),
        _rest(data, path, trajectory),
        _paths(trajectory, path),
        data.get("dt_s"),
        tuple(data.get("gravity_m_s2", (0.0, 0.0, 0.0))),
    )
