"""What the frames of another program do not say: --about FILE (configs/schema/judge.schema.json)."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ..errors import UserError
from ..spec_file import read_spec, refused
from .trajectory import Trajectory, checked


@dataclass(frozen=True)
class About:
    """Densities of a body: kg/m^3 of tetrahedra, kg/m^2 of triangles, kg/m of segments."""

    given: np.ndarray  # vertices that the scene moves
    half_thickness_m: np.ndarray | None  # [n_vertices]
    density: dict[str, float] = field(default_factory=dict)
    dt_s: float | None = None
    gravity_m_s2: tuple[float, float, float] = (0.0, 0.0, 0.0)


def _cells(data: dict, key: str, n: int, own: np.ndarray) -> np.ndarray:
    more = np.array(data.get(key, []), np.int64).reshape(-1, n)
    return np.concatenate([own, more])


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
    return replace(trajectory, topology=replace(trajectory.topology, names=tuple(names), first_vertex=first))


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
        triangles=_cells(data, "triangles", 3, t.triangles),
        segments=_cells(data, "segments", 2, t.segments),
        tetrahedra=_cells(data, "tetrahedra", 4, t.tetrahedra),
    )
    more = replace(
        trajectory,
        topology=topology,
        obstacles=trajectory.obstacles + data.get("obstacles", []),
        planar=data.get("planar", trajectory.planar),
    )
    return data, _with_bodies(data, path, checked(more))


def about_of(data: dict, path: Path | None, trajectory: Trajectory) -> About:
    """What refers to bodies by name. Errors: UserError with the place in the file."""
    n = trajectory.topology.n_vertices
    given = [_body(name, path, f"given/{k}", trajectory) for k, name in enumerate(data.get("given", []))]
    vertices = np.array(data.get("given_vertices", []), int)
    if len(vertices) and vertices.max() >= n:
        raise refused(path, "given_vertices", int(vertices.max()), f"numbers below {n}")
    thickness = None
    if "thickness_m" in data:
        said = data["thickness_m"]
        thickness = np.full(n, said / 2 if not isinstance(said, dict) else 0.0)
        for name, value in said.items() if isinstance(said, dict) else ():
            thickness[_body(name, path, f"thickness_m/{name}", trajectory)] = value / 2
    for name in data.get("density", {}):
        _body(name, path, f"density/{name}", trajectory)
    if "density" in data and data.get("dt_s") is None and trajectory.times_s is None:
        raise UserError(f"{path}#/density: needs times of the frames for velocities: dt_s")
    return About(
        np.unique(np.concatenate([*given, vertices]).astype(int)),
        thickness,
        data.get("density", {}),
        data.get("dt_s"),
        tuple(data.get("gravity_m_s2", (0.0, 0.0, 0.0))),
    )
