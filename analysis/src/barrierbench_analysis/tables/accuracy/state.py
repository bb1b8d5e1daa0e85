"""What a run leaves of its motion: sampled positions, masses, bodies, energies."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.frames import Frame, frame_paths, frames_of, read_scene
from barrierbench_analysis.io.record_file import read_record


@dataclass(frozen=True)
class Motion:
    """A run with its frames. Frame 0 is the start, at t = 0."""

    record: dict
    frames: tuple[Frame, ...]
    times: np.ndarray  # [frames] s
    bodies: tuple[str, ...]

    @cached_property
    def x(self) -> np.ndarray:
        """[frames, vertices, 3] m."""
        return np.array([frame.vertices for frame in self.frames])

    @cached_property
    def body_of(self) -> np.ndarray:
        return np.asarray(self.frames[0].of_vertices["body"], int)

    @cached_property
    def masses(self) -> np.ndarray:
        """[vertices] kg, lumped: a third of each triangle, half of each lone edge. The start is the rest
        shape, as in every scene of bodies. Vertices of a procedural scene have the mass of one material, 1
        kg/m^2: its centres of mass are right, its momenta are not known.
        """
        for body in self.record["config"]["scene"].get("bodies", []):
            lumping = body.get("material", {}).get("lumping", "barycentric")
            if body.get("rest_mesh") or body.get("rest_film") or lumping != "barycentric":
                raise UserError(
                    f"{body['name']}: masses are known where mesh is the rest shape, lumping barycentric"
                )
        start = self.frames[0]
        given = [body.get("material", {}) for body in self.record["config"]["scene"].get("bodies", [])] or [
            {"density_kg_per_m2": 1.0}
        ] * len(self.bodies)
        mass = np.zeros(len(start.vertices))
        for corners, measure, key in (
            (start.triangles, _areas, "density_kg_per_m2"),
            (start.edges, _lengths, "line_density_kg_per_m"),
        ):
            if len(corners):
                density = np.array([given[b].get(key, 0.0) for b in self.body_of[corners[:, 0]]])
                np.add.at(
                    mass, corners, (density * measure(start.vertices, corners) / corners.shape[1])[:, None]
                )
        return mass

    @cached_property
    def com(self) -> np.ndarray:
        """[frames, bodies, 3] m."""
        return self.com_of(self.x)

    def com_of(self, x: np.ndarray) -> np.ndarray:
        """Centres of mass of positions [..., vertices, 3] of this scene."""
        weight = np.array([np.where(self.body_of == b, self.masses, 0.0) for b in range(len(self.bodies))])
        total = weight.sum(axis=1)
        if not (total > 0).all():
            raise UserError(
                f"{self.bodies[int(np.argmin(total))]}: a body without mass has no centre of mass"
            )
        return np.einsum("bv,...vk->...bk", weight / total[:, None], x)

    @property
    def size(self) -> float:
        return self.record["scene"]["extent_m"]

    @property
    def up(self) -> np.ndarray | None:
        """Unit vector against gravity; None without gravity."""
        scene = self.record["config"]["scene"]
        planar = scene.get("planar", scene["name"] == "drape2d")
        g = scene.get("gravity_m_per_s2", 9.81)
        vector = -np.asarray(g, float) if isinstance(g, list) else g * np.eye(3)[1 if planar else 2]
        size = np.linalg.norm(vector)
        return vector / size if size > 0 else None

    def momentum(self, first: int, last: int) -> np.ndarray:
        """[3] kg m/s, the mean between two frames: masses times the way over the time. Exact where nothing
        outside acts.
        """
        return self.masses @ (self.x[last] - self.x[first]) / (self.times[last] - self.times[first])

    def energy(self, step: int) -> float:
        """J at the end of a step of the record."""
        row = self.record["steps"][step]
        return sum(row[key] for key in ("kinetic_J", "elastic_J", "limit_J", "contact_J", "gravity_J"))


def _areas(x: np.ndarray, corners: np.ndarray) -> np.ndarray:
    a, b, c = (x[corners[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


def _lengths(x: np.ndarray, corners: np.ndarray) -> np.ndarray:
    return np.linalg.norm(x[corners[:, 1]] - x[corners[:, 0]], axis=1)


def read_motion(folder: Path) -> Motion:
    """The run in a folder with run.json and frames/. Errors: RecordError, UserError (no frames:
    /output/frames_every).
    """
    record = read_record(folder / "run.json")
    paths = frame_paths(record, folder)
    times = [0.0 if step < 0 else record["steps"][step]["t_s"] for step in paths]
    return Motion(
        record,
        tuple(frames_of(record, folder, paths)),
        np.array(times),
        tuple(read_scene(record, folder)["bodies"]),
    )
