"""One run, judged as a run and frame by frame from what is exported of it: every field that a reader takes from either says the same,
and the same as the run's own audit and the formula of the obstacle.
"""

import copy
import json
import subprocess

import numpy as np
import pytest

from barrierbench_analysis.io.frames import frame_paths, frames_of
from barrierbench_analysis.figures.frames_out import verb as frames_out
from barrierbench_analysis.studies.judge import verb
from barrierbench_analysis.io.record_file import read_record

AXIS = [0.6, 0.0, 0.8]
CASES = {
    "a tilted plane": {"kind": "plane", "point_m": [0, 0, -0.02], "axis": [0.28, 0, 0.96]},
    "a ball": {"kind": "sphere", "point_m": [0.01, 0.02, -0.22], "radius_m": 0.2},
    "within a ball": {"kind": "sphere", "point_m": [0.03, 0.0, 0.1], "radius_m": 0.14, "inside": True},
    "a bar": {"kind": "cylinder", "point_m": [0, 0, -0.23], "axis": [0.96, 0.28, 0], "radius_m": 0.21},
    "within a tube": {"kind": "cylinder", "point_m": [0, 0.01, 0.08], "axis": [0.96, 0.28, 0], "radius_m": 0.13, "inside": True},
    "a plane that rises": {"kind": "plane", "point_m": [0, 0, -0.03], "axis": [0, 0, 1], "motion": {"velocity_m_per_s": [0, 0, 0.4]}},
    "a ball that comes": {"kind": "sphere", "point_m": [0.01, 0.02, -0.25], "radius_m": 0.2, "motion": {"velocity_m_per_s": [0, 0, 0.8]}},
}  # fmt: skip
HALF_M, DT = 0.002, 0.013


def config_of(obstacle: dict, thick: bool) -> dict:
    sheets = [
        {"name": f"sheet{k}", "mesh": {"generator": "grid", "n_x": 4, "n_y": 4, "size_x_m": 0.1, "size_y_m": 0.1},
         "transform": {"translate_m": [0.004 * k, 0, 0.012 * k]}, "velocity_m_per_s": [0, 0, -0.3], **({"offset_m": HALF_M} if thick else {})}
        for k in range(2)
    ]  # fmt: skip
    return {
        "schema": "barrierbench.config/1",
        "scene": {"bodies": sheets, "obstacles": [{"name": "it", **obstacle}]},
        "formulation": {"name": "log", "d_hat_m": 0.005},
        "strain_limit": {"enabled": False},
        "time": {"dt_s": DT, "steps": 3},
        "passes": {"time": False},
        "output": {"frames_every": 1},
    }


@pytest.fixture(scope="module", params=[(name, thick) for name in CASES for thick in (False, True)], ids=lambda p: f"{p[0]}{', thick' * p[1]}")
def judged(request, program, tmp_path_factory):
    """Obstacle, thickness of a body, folder of the run, its record and its judgement."""
    name, thick = request.param
    folder = tmp_path_factory.mktemp("run")
    (folder / "config.json").write_text(json.dumps(config_of(CASES[name], thick)))
    done = subprocess.run([program, "run", folder / "config.json", "--out", folder / "out"], capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stderr
    code, answer = judge(folder / "out", folder / "as_run")
    assert code == 0, answer
    return CASES[name], HALF_M if thick else 0.0, folder, read_record(folder / "out" / "run.json"), answer


def judge(path, out, about=None, *words):
    if about is not None:
        out.mkdir()
        (out / "about.json").write_text(json.dumps({"schema": "barrierbench.judge/1", **about}))
        words = ("--about", str(out / "about.json"), *words)
    code = verb.main([str(path), "--out", str(out / "judgement"), "--reach", "0.02", *words])
    return code, json.loads((out / "judgement" / "judgement.json").read_text())


def positions(record, folder):
    """[frames, vertices of bodies, 3] and times."""
    paths = frame_paths(record, folder / "out")
    x = np.array([f.vertices[np.asarray(f.of_vertices["body"]) < 2] for f in frames_of(record, folder / "out", paths)])
    times = np.array([0.0 if step < 0 else record["steps"][step]["t_s"] for step in paths])
    assert x.shape[1] == 32
    return x, times


def posed(obstacle: dict, t: float) -> dict:
    given = copy.deepcopy(obstacle)
    v = np.array(given.pop("motion", {}).get("velocity_m_per_s", [0, 0, 0]))
    return given | {"point_m": (np.array(given["point_m"]) + t * v).tolist()}


def gaps_of_vertices(obstacle: dict, x: np.ndarray) -> np.ndarray:
    """By the formula of a plane, a ball or a tube; thickness not taken off."""
    r, axis = x - np.array(obstacle["point_m"]), np.array(obstacle.get("axis", [0, 0, 1]), float)
    axis = axis / np.linalg.norm(axis)
    if obstacle["kind"] == "plane":
        return r @ axis
    across = r - np.outer(r @ axis, axis) if obstacle["kind"] == "cylinder" else r
    distance = np.linalg.norm(across, axis=1) - obstacle["radius_m"]
    return -distance if obstacle.get("inside") else distance


def test_the_run_is_at_its_obstacle(judged):
    """Else nothing below would depend on what a reader takes of the obstacle."""
    obstacle, half, folder, record, answer = judged
    assert len(answer["frames"]) == 4 and answer["trajectory"]["bodies"] == ["sheet0", "sheet1"]
    assert record["status"]["outcome"] == "ok" and 0 < answer["frames"][-1]["gap_obstacles_m"] < 0.05


def test_gaps_are_those_of_the_formula(judged):
    obstacle, half, folder, record, answer = judged
    x, times = positions(record, folder)
    for frame, at, t in zip(answer["frames"], x, times, strict=True):
        least = gaps_of_vertices(posed(obstacle, t), at).min() - half
        if obstacle["kind"] == "plane" or obstacle.get("inside"):
            assert frame["gap_obstacles_m"] == pytest.approx(least, abs=1e-12)
        else:  # of triangles, whose middles may be nearer than their corners
            assert least - 0.02 < frame["gap_obstacles_m"] <= least + 1e-12
        assert frame["obstacle_violations"] == 0


def test_gaps_are_those_that_the_run_recorded(judged):
    _, _, _, record, answer = judged
    for step, frame in zip(record["steps"], answer["frames"][1:], strict=True):
        assert frame["gap_obstacles_m"] == pytest.approx(step["surface_gap_obstacles_m"], abs=1e-12)
        if step["surface_gap_between_m"] is not None and step["surface_gap_between_m"] < 0.02:
            assert frame["gap_between_m"] == pytest.approx(step["surface_gap_between_m"], abs=1e-12)


def test_exported_frames_say_the_same(judged, tmp_path):
    obstacle, half, folder, record, answer = judged
    out = tmp_path / "exported"
    assert frames_out.main([str(folder / "out"), str(out), "--format", "obj"]) == 0
    _, times = positions(record, folder)
    same = ("crossings", "touches", "obstacle_violations", "given_faults", "finite")
    for k in (0, 2, 3):
        frame, t = answer["frames"][k], times[k]
        about = {"obstacles": [{"name": "it", **posed(obstacle, t)}], "thickness_m": 2 * half}
        _, alone = judge(out / f"frame_{k:06}.obj", tmp_path / f"frame{k}", about, "--states-only")
        (one,) = alone["frames"]
        assert one["gap_obstacles_m"] == pytest.approx(frame["gap_obstacles_m"], abs=1e-12)
        assert one["gap_between_m"] == pytest.approx(frame["gap_between_m"], abs=1e-12)
        for key in same:
            assert one[key] == frame[key], key


def test_an_obstacle_in_the_way_is_found_either_way(judged, tmp_path):
    """The same obstacle beside the run's own, moved to the other side of the sheets: both are beyond it in the frames as in the run."""
    obstacle, half, folder, record, answer = judged
    x, times = positions(record, folder)
    inside = obstacle.get("inside", False)
    wall = posed(obstacle, times[-1])
    middle = x[-1].mean(axis=0)
    if obstacle["kind"] == "plane":
        wall["point_m"] = middle.tolist()
    else:
        wall["point_m"] = (middle + np.array([0, 0.5, 0.5]) if inside else middle).tolist()
    code, as_run = judge(folder / "out", tmp_path / "run", {"obstacles": [wall]}, "--states-only")
    expected = (gaps_of_vertices(wall, x[-1]) < 0).sum()
    assert code == 1 and as_run["verdict"] == "penetrates" and expected > 0
    if obstacle["kind"] == "plane" or inside:
        assert as_run["frames"][-1]["obstacle_violations"] == expected
    else:
        assert as_run["frames"][-1]["obstacle_violations"] > 0
