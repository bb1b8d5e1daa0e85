"""The shortest engine that takes part: springs along edges, explicit steps, obstacles that push back. Copy
this folder for the next one.
"""

import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve()
sys.path.insert(0, str(HERE.parents[1]))
import common  # noqa: E402

ROOT_3 = 3**0.5


def springs_of(scene, factor):
    """[e, 2] edges, [e] rest lengths (m) and [e] stiffnesses (N/m) of every body."""
    edges, stiffness = [], []
    for body in scene.bodies:
        if "rod" in body:
            edges.append(rod_edges(scene, body))
            along = scene.rest[edges[-1][:, 1]] - scene.rest[edges[-1][:, 0]]
            stiffness.append(body["rod"]["stretching_N"] / np.linalg.norm(along, axis=1) * factor)
        if "membrane" not in body:
            continue
        found, _ = common.edges_of(scene.triangles_of(body))
        youngs, _ = common.plane_stress(body["membrane"])
        edges.append(found + body["first_vertex"])
        stiffness.append(np.full(len(found), youngs * ROOT_3 / 2 * factor))
    edges = np.concatenate(edges)
    length = np.linalg.norm(scene.rest[edges[:, 1]] - scene.rest[edges[:, 0]], axis=1)
    return edges, length, np.concatenate(stiffness)


def rod_edges(scene, body):
    """Its segments. A bending that is not 0 has no counterpart here."""
    if body["rod"]["bending_N_m2"] > 0:
        raise common.Refused(f"body {body['name']}: bending of rods is not mapped")
    return scene.segments_of(body) + body["first_vertex"]


def obstacle_force(scene, x, frame, stiffness):
    """[n, 3] N of a penalty on the depth in each obstacle, at a time in frames."""
    force = np.zeros_like(x)
    for o in scene.obstacles:
        away = x - scene.point_of(o, frame)
        if o["kind"] == "plane":
            normal = np.broadcast_to(np.array(o["axis"]), x.shape)
            gap = away @ np.array(o["axis"])
        elif o["kind"] == "sphere" and not o["inside"]:
            distance = np.linalg.norm(away, axis=1)
            normal, gap = away / np.maximum(distance, 1e-12)[:, None], distance - o["radius_m"]
        else:
            raise common.Refused(f"obstacle {o['name']}: {o['kind']} is not mapped; planes and spheres are")
        force += np.maximum(-gap, 0)[:, None] * normal * stiffness
    return force


def simulate(scene, settings, frames, notes):
    common.require(scene, motion=True, rods=True)
    edges, length, stiffness = springs_of(scene, settings["stretch_factor"])
    mass = scene.mass.copy()
    free = np.setdiff1d(np.flatnonzero(mass > 0), scene.given)
    x, v = scene.x.copy(), scene.v.copy()
    frames.add(x)
    for k in range(scene.steps):
        with frames.stepping():
            for sub in range(frames.substeps):
                along = x[edges[:, 1]] - x[edges[:, 0]]
                now = np.linalg.norm(along, axis=1)
                pull = (stiffness * (now - length) / now)[:, None] * along
                force = obstacle_force(scene, x, k + sub / frames.substeps, settings["obstacle_N_per_m"])
                np.add.at(force, edges[:, 0], pull)
                np.add.at(force, edges[:, 1], -pull)
                v[free] += frames.dt_s * (scene.gravity + force[free] / mass[free, None])
                v *= 1 - settings["damping_per_s"] * frames.dt_s
                x[free] += frames.dt_s * v[free]
                x[scene.given] = scene.given_at(k + (sub + 1) / frames.substeps)
        if not frames.add(x):
            return


if __name__ == "__main__":
    common.run(HERE, simulate)
