"""Bodies with a material as a config of this program, which computes their elastic energies of the frames."""

import json
from pathlib import Path

import numpy as np

from barrierbench_analysis.program.mesh_arrays import MeshArrays
from barrierbench_analysis.program.mesh_file import ply_bytes
from barrierbench_analysis.program.trajectories.trajectory import Topology, Trajectory, no_cells

from .about import About

CONFIG = "materials.json"  # of the folder of a call
CELLS = ("triangles", "segments", "tetrahedra")


def _cells(topology: Topology, body: int) -> dict[str, np.ndarray]:
    """Of a body, by kind. The skin of a solid is no sheet."""
    of = topology.body_of_vertices()
    cells = {key: getattr(topology, key)[of[getattr(topology, key)[:, 0]] == body] for key in CELLS}
    return cells | ({"triangles": no_cells(3)} if len(cells["tetrahedra"]) else {})


def _body(name: str, material: dict, mesh: str, has_rods: bool, density: float) -> dict:
    """A lone edge without a mass is refused in a config; its mass is of no account here."""
    mass = {"line_density_kg_per_m": density} if has_rods else {}
    return {"name": name, "mesh": {"file": mesh}, "material": mass | material}


def written(trajectory: Trajectory, about: About, folder: Path) -> dict | None:
    """Files of the config below the folder; `elastic` of barrierbench.subject/1. None without any material,
    and where the rest shape is not finite.
    """
    rest = next(trajectory.frames()) if about.rest_m is None else about.rest_m
    if not about.materials or not np.isfinite(rest).all():
        return None
    bodies, vertices, t = [], [], trajectory.topology
    for name, material in about.materials.items():
        k = t.names.index(name)
        cells = _cells(t, k)
        used = np.unique(np.concatenate([c.ravel() for c in cells.values()]))
        local = {key: np.searchsorted(used, c) for key, c in cells.items()}
        mesh = MeshArrays(rest[used], local["triangles"], local["segments"], local["tetrahedra"])
        (folder / f"{k}.ply").write_bytes(ply_bytes(mesh))
        has_rods = len(cells["segments"]) > 0
        bodies.append(_body(name, material, f"{k}.ply", has_rods, about.density.get(name, 1.0)))
        vertices += used.tolist()
    config = {
        "schema": "barrierbench.config/1",
        "name": "materials",
        "scene": {"name": "bodies", "bodies": bodies},
        "formulation": {"name": "log", "d_hat_m": 1e-3},  # no contact is computed
        "strain_limit": {"enabled": False},
        "time": {"dt_s": 1.0, "steps": 1},
    }
    (folder / CONFIG).write_text(json.dumps(config, allow_nan=False))
    return {"config": str(folder / CONFIG), "vertices": vertices}
