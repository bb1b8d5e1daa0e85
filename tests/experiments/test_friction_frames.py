"""Forces of friction in frames: what a block that slides loses of its momentum, and what two bodies give each other."""

import json
import math

import numpy as np
import pytest
from test_cli import bench
from test_friction import ANGLE, G, MASS, SLOPE

from barrierbench_analysis.io.frames import frame_paths, read_frame

DT, STEPS = 0.005, 60
DOWN = np.array([2, 0, -1]) / math.sqrt(5)  # along the slope
FIELDS = ("friction_x_N", "friction_y_N", "friction_z_N")


def run(program, out, scene, *settings):
    words = [w for s in ("/output/frames_every=1", *settings) for w in ("--set", s)]
    done = bench(program, "run", scene, "--out", out, "--progress", "none", *words)
    assert done.returncode == 0, done.stderr
    record = json.loads((out / "run.json").read_text())
    return record, [read_frame(path) for path in frame_paths(record, out).values()]


def forces(frame):
    return np.stack([frame.of_vertices[name] for name in FIELDS], axis=1)


@pytest.mark.parametrize("form", [[], ["/friction/law=static_kinetic"], ["/friction/refresh=per_iteration"]])
def test_their_sum_is_what_the_momentum_of_a_sliding_patch_changes_by(program, tmp_path, form):
    settings = ("/output/friction_forces=true", "/friction/mu=0.2", *form)
    record, frames = run(program, tmp_path, SLOPE, *settings)
    ways = [DOWN @ frame.vertices.mean(axis=0) for frame in frames]
    assert ways[-1] - ways[0] > 0.1
    judged = 0
    for n in range(STEPS // 2, STEPS):
        step, force = record["steps"][n], forces(frames[n + 1])
        assert (step["friction_sliding"], step["contacts"]["total"]) == (9, 9)
        change = (ways[n + 1] - 2 * ways[n] + ways[n - 1]) / DT**2 * MASS
        along = DOWN @ force.sum(axis=0)
        assert along == pytest.approx(change - MASS * G * math.sin(ANGLE), rel=1e-3)
        assert along == pytest.approx(-0.2 * MASS * G * math.cos(ANGLE), rel=5e-3)
        across = force - np.outer(force @ DOWN, DOWN)
        assert np.abs(across).max() < 1e-4 * abs(along) and (force @ DOWN < 0).all()
        judged += 1
    assert judged == 30


def test_they_are_there_when_they_are_asked_for_alone(program, tmp_path):
    _, plain = run(program, tmp_path / "plain", SLOPE, "/time/steps=5")
    assert not set(FIELDS) & set(plain[-1].of_vertices) and "load_N" in plain[-1].of_vertices
    _, requested = run(program, tmp_path / "asked", SLOPE, "/time/steps=5", "/output/friction_forces=true")
    assert set(FIELDS) <= set(requested[-1].of_vertices) and (requested[-1].vertices == plain[-1].vertices).all()
    _, none = run(program, tmp_path / "none", SLOPE, "/time/steps=5", "/output/friction_forces=true", "/friction/mu=0")
    assert not forces(none[-1]).any() and forces(requested[-1]).any()


def test_two_bodies_give_each_other_opposite_ones(program, tmp_path):
    """A patch that is thrown along a free plate; the floor beneath has no friction."""
    config = json.loads(SLOPE.read_text())
    grid = {"generator": "grid", "n_x": 4, "n_y": 4}
    plate = {"name": "plate", "mesh": {**grid, "size_x_m": 0.4, "size_y_m": 0.4}, "transform": {"translate_m": [0, 0, 6e-4]},
             "material": {"youngs_N_per_m": 1000, "density_kg_per_m2": 1, "bending_J": 0.1}, "friction": 0.3}  # fmt: skip
    patch = {"name": "patch", "mesh": {**grid, "size_x_m": 0.2, "size_y_m": 0.2}, "transform": {"translate_m": [0, 0, 1.2e-3]},
             "material": {"youngs_N_per_m": 1000, "density_kg_per_m2": 1, "bending_J": 0.1},
             "velocity_m_per_s": [0.5, 0, 0], "friction": 0.3}  # fmt: skip
    floor = {"name": "floor", "kind": "plane", "friction": 0}
    config["scene"] |= {"bodies": [plate, patch], "obstacles": [floor]}
    config["time"]["steps"] = 20
    scene = tmp_path / "two.json"
    scene.write_text(json.dumps(config))
    for device in ("cpu", "host"):
        _, frames = run(program, tmp_path / device, scene, "/output/friction_forces=true", f"/device={device}")
        largest = 0
        for frame in frames[1:]:
            of_bodies = [forces(frame)[frame.of_vertices["body"] == b].sum(axis=0) for b in (0, 1)]
            largest = max(largest, np.abs(of_bodies[1]).max())
            assert np.abs(of_bodies[0] + of_bodies[1]).max() < 1e-9
            assert of_bodies[1][0] <= 1e-3
        assert largest > 0.03
