"""The config that an importer makes: bodies with mesh files beside it, obstacles, settings."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np

from barrierbench_analysis.io import digests
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.whole_file import write_whole, write_whole_bytes
from barrierbench_analysis.program.mesh_arrays import MeshArrays
from barrierbench_analysis.program.mesh_file import ply_bytes

from .motions import NotAtRest, motion_of

MOST_FRAMES = 2000  # of a film that a motion becomes
NO_TRIANGLES, NO_SEGMENTS, NO_TETRAHEDRA = (np.zeros((0, n), np.int64) for n in (3, 2, 4))


def cells_of(points, triangles=NO_TRIANGLES, segments=NO_SEGMENTS, tetrahedra=NO_TETRAHEDRA) -> MeshArrays:
    """A mesh whose other cells are none."""
    return MeshArrays(np.asarray(points, float), triangles, segments, tetrahedra)


def oriented(cells: MeshArrays) -> MeshArrays:
    """The same mesh, where no tetrahedron has a negative volume: two of its corners change places."""
    p, t = cells.points, cells.tetrahedra.copy()
    if len(t):
        sides = np.stack([p[t[:, k]] - p[t[:, 0]] for k in (1, 2, 3)], axis=1)
        wrong = np.linalg.det(sides) < 0
        t[wrong] = t[wrong][:, [0, 1, 3, 2]]
    return MeshArrays(p, cells.triangles, cells.segments, t)


class SceneConfig:
    """A config in the making. Meshes are written at once; `write` writes the config."""

    def __init__(self, out: Path, dt_s: float, steps: int) -> None:
        self.out, self.dt_s, self.steps = out, dt_s, steps
        self.folder = out.with_name(f"{out.stem}_meshes")
        self.bodies: list[dict] = []
        self.obstacles: list[dict] = []
        self.settings: dict = {}
        self.scene: dict = {}
        self.apart: set[frozenset[str]] = set()  # names of pairs whose contact is off
        self.vertices = 0

    def times(self) -> np.ndarray:
        """Ends of all steps, s, with the start before them."""
        return self.dt_s * np.arange(self.steps + 1)

    def name_for(self, wish: str) -> str:
        """A name that no body and no obstacle has yet, of characters that a file may have."""
        name = re.sub(r"[^A-Za-z0-9_-]+", "_", wish) or "body"
        taken = {one["name"] for one in (*self.bodies, *self.obstacles)}
        number = 1
        while (made := name if number == 1 else f"{name}_{number}") in taken:
            number += 1
        return made

    def mesh_file(self, name: str, cells: MeshArrays) -> dict:
        """A mesh, m, as a file beside the config: what `mesh` of a body says."""
        path = self.folder / f"{name}.ply"
        write_whole_bytes(path, ply_bytes(oriented(cells)))
        return {"file": f"{self.folder.name}/{path.name}", "sha256": digests.of_file(path)}

    def add_body(self, wish: str, cells: MeshArrays, **keys) -> dict:
        """A body with its mesh. Keys that are None are left out."""
        name = self.name_for(wish)
        body = {"name": name, "mesh": self.mesh_file(name, cells)}
        body |= {key: value for key, value in keys.items() if value is not None}
        self.bodies.append(body)
        self.vertices += len(cells.points)
        return body

    def add_obstacle(self, wish: str, **keys) -> None:
        """An analytic obstacle."""
        made = {key: value for key, value in keys.items() if value is not None}
        self.obstacles.append({"name": self.name_for(wish), **made})

    def motion(
        self, name: str, cells: MeshArrays, moved: np.ndarray, at: Callable
    ) -> tuple[dict | None, str]:
        """The motion of the vertices `moved` of a mesh, which are at(t) at the time t, and in words what it
        is. Errors: UserError for a film that would be too long; NotAtRest of motion_of.
        """
        found, words = motion_of(cells.points[moved], at, self.times())
        if found is not None or not words:
            return found, words or "held"
        if self.steps > MOST_FRAMES:
            raise UserError(
                f"--steps: found {self.steps} for a motion that becomes a film of one frame a step;"
                f" allowed: at most {MOST_FRAMES}"
            )
        first = oriented(cells)
        for k, time in enumerate(self.times()):
            points = cells.points.copy()
            points[moved] = at(time)
            frame = MeshArrays(points, cells.triangles, cells.segments, first.tetrahedra)
            write_whole_bytes(self.folder / f"{name}_film_{k:06d}.ply", ply_bytes(frame))
        file = f"{self.folder.name}/{name}_film_000000.ply"
        return {"film": {"file": file, "frame_s": self.dt_s}}, words

    def switch_off(self, a: dict, b: dict) -> None:
        """Turns contact off between a body and a body or an obstacle, where one of them can move freely."""
        if not self.can_meet(a, b):
            return
        pair = {"a": a["name"], "b": b["name"], "kind": "off"}
        self.scene.setdefault("collisions", []).append(pair)
        self.apart.add(frozenset((a["name"], b["name"])))

    def can_meet(self, a: dict, b: dict) -> bool:
        """Whether contact acts between a body and a body (itself too) or an obstacle."""
        if a.get("kind") == "rigid" and (b in self.obstacles or b.get("kind") == "rigid"):
            return False
        return frozenset((a["name"], b["name"])) not in self.apart

    def no_contact(self) -> None:
        """Turns contact off between all pairs."""
        for number, one in enumerate(self.bodies):
            for other in [*self.bodies[number:], *self.obstacles]:
                self.switch_off(one, other)

    def write(self, doc: str) -> dict:
        """Writes the config and returns it. Errors: UserError where there is no body that can move."""
        if not any(body.get("kind") != "rigid" for body in self.bodies):
            raise UserError(f"{doc}: found no body that can move; allowed: at least one")
        scene = {"name": "bodies", **self.scene, "bodies": self.bodies, "obstacles": self.obstacles}
        config = {
            "schema": "barrierbench.config/1",
            "name": self.out.stem,
            "doc": doc,
            "scene": scene,
            **self.settings,
            "time": {**self.settings.get("time", {}), "dt_s": self.dt_s, "steps": self.steps},
        }
        config.setdefault("output", {"frames_every": max(1, self.steps // 50)})
        write_whole(self.out, json.dumps(config, indent=2) + "\n")
        return config


__all__ = ["MOST_FRAMES", "NotAtRest", "SceneConfig", "cells_of"]
