"""Whole runs with an obstacle that moves: audit, frames, time limits, retries, and what is refused."""

import copy
import json

import numpy as np
import pytest
from test_cli import bench, write

from barrierbench_analysis.io.frames import frame_of, frame_paths, read_scene, scene_at
from barrierbench_analysis.io.record_file import read_record
from tests.falling_cloth import CLOTH_ON_BALL

UP = [0.1, 0, 0.6]  # m/s


def rising(**settings) -> dict:
    """The cloth and the rod, with the ball coming up to meet them."""
    config = copy.deepcopy(CLOTH_ON_BALL)
    config["scene"]["obstacles"][0]["motion"] = {"velocity_m_per_s": UP}
    return {**config, "output": {"frames_every": 2}, **settings}


def run(program, folder, config, *more):
    done = bench(program, "run", write(folder / "config.json", config), "--out", folder / "out", *more)
    assert done.returncode == 0, done.stderr
    return json.loads((folder / "out/run.json").read_text())


def test_it_pushes_what_it_meets_and_the_audit_follows_it(program, tmp_path):
    record = run(program, tmp_path, rising())
    assert record["status"]["outcome"] == "ok", record["status"]
    assert record["audit"]["judged"] > 0 and record["audit"]["obstacle_triangles"] > 50 * 5
    assert record["steps"][-1]["gap_min_m"] > 0
    assert "ball|cloth" in record["summary"]["contact_gaps"]
    folder = tmp_path / "out"
    read, scene = read_record(folder / "run.json"), read_scene(record, folder)
    assert scene["bodies"] == ["cloth", "rod"] and scene["obstacles"][0]["vertex"] == 40
    for step in frame_paths(read, folder):
        frame = frame_of(read, folder, step)
        there = scene_at(scene, frame)["obstacles"][0]
        np.testing.assert_allclose(there["point_m"], np.array(UP) * 0.01 * (step + 1), atol=1e-15)
        assert np.linalg.norm(frame.vertices[:40] - there["point_m"], axis=1).min() > there["radius_m"]


def test_a_run_that_is_cut_goes_on_to_the_same_end(program, tmp_path):
    config = write(tmp_path / "config.json", rising(output={"checkpoint_every": 1}))
    whole = bench(program, "run", config, "--out", tmp_path / "whole")
    assert whole.returncode == 0, whole.stderr
    cut = bench(program, "run", config, "--out", tmp_path / "cut", "--step-limit", 2)
    assert cut.returncode == 0, cut.stderr
    assert json.loads((tmp_path / "cut/run.json").read_text())["status"]["outcome"] == "timeout"
    done = bench(program, "run", config, "--out", tmp_path / "cut", "--resume")
    assert done.returncode == 0, done.stderr
    record = json.loads((tmp_path / "cut/run.json").read_text())
    expected = json.loads((tmp_path / "whole/run.json").read_text())
    assert record["summary"]["state_hash"] == expected["summary"]["state_hash"]


def test_one_that_is_driven_into_a_pin_is_refused_before_the_first_step(program, tmp_path):
    config = rising()
    config["scene"]["bodies"][0]["pins"] = [{"indices": [14]}]
    config["time"]["steps"] = 20
    record = run(program, tmp_path, config)
    assert record["status"]["outcome"] == "given_parts_cross"
    for word in ("cloth[14]", "ball", "both are prescribed: in step"):
        assert word in record["status"]["detail"]
    assert record["steps"] == []


@pytest.mark.parametrize("kind", ["plane", "cylinder"])
def test_planes_and_cylinders_move_too(program, tmp_path, kind):
    config = rising()
    ball = config["scene"]["obstacles"][0]
    ball.update(kind=kind, axis=[0, 1, 0] if kind == "cylinder" else [0, 0, 1])
    if kind == "plane":
        del ball["radius_m"]
        ball["point_m"] = [0, 0, 0.1]
    record = run(program, tmp_path, config)
    assert record["status"]["outcome"] == "ok", record["status"]
    assert "ball|cloth" in record["summary"]["contact_gaps"]
