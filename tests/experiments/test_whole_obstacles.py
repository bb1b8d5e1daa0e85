"""Obstacles and whole surfaces as a user meets them: coarse bodies rest on balls and bars, and starts and insides that cannot be are named."""

import json
from pathlib import Path

import pytest
from test_cli import bench

LOG = {"name": "log", "d_hat_m": 0.01, "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 60}}


def config(tmp_path: Path, bodies: list, obstacles: list, steps: int, **more) -> Path:
    scene = {"name": "bodies", "bodies": bodies, "obstacles": obstacles}
    text = {"schema": "barrierbench.config/1", "scene": scene, "formulation": LOG, "time": {"dt_s": 0.01, "steps": steps}, "threads": 1}
    path = tmp_path / "config.json"
    path.write_text(json.dumps({**text, **more}))
    return path


def sheet(height: float, offset: float = 0.0) -> dict:
    return {
        "name": "sheet",
        "mesh": {"generator": "grid", "n_x": 2, "n_y": 2, "size_x_m": 1, "size_y_m": 1},
        "transform": {"translate_m": [0, 0, height]},
        "material": {"youngs_N_per_m": 300, "density_kg_per_m2": 0.2, "bending_J": 0.05},
        "offset_m": offset,
    }


def ball(name: str, x: float, y: float, radius: float = 0.1, **more) -> dict:
    return {"name": name, "kind": "sphere", "point_m": [x, y, 0], "radius_m": radius, **more}


def run(program: str, path: Path) -> dict:
    done = bench(program, "run", path, "--out", path.parent / "out")
    assert (path.parent / "out/run.json").exists(), done.stderr
    return json.loads((path.parent / "out/run.json").read_text())


def test_two_triangles_rest_on_balls_that_their_corners_miss(program, tmp_path):
    balls = [ball(f"ball{i}", x, y) for i, (x, y) in enumerate([(-0.2, -0.25), (-0.2, 0.25), (0.2, -0.25), (0.2, 0.25)])]
    record = run(program, config(tmp_path, [sheet(0.115)], balls, 60))
    assert record["status"]["outcome"] == "ok", record["status"]
    last = record["steps"][-1]
    assert last["contacts"]["obstacle"] > 0
    assert 0 < last["gap_min_m"] < 0.01
    weight = 0.2 * 9.81
    assert last["contact_load_sum_N"] == pytest.approx(weight, rel=0.3)


def test_a_rod_of_one_segment_rests_on_bars_between_its_ends(program, tmp_path):
    rod = {
        "name": "rod",
        "mesh": {"generator": "rod", "n_segments": 1, "length_m": 1},
        "transform": {"translate_m": [0, 0, 0.11]},
        "material": {"springs_N_per_m": 2000, "line_density_kg_per_m": 0.05},
    }
    bars = [{"name": f"bar{i}", "kind": "cylinder", "point_m": [x, 0, 0], "axis": [0, 1, 0], "radius_m": 0.1} for i, x in enumerate((-0.2, 0.2))]
    record = run(program, config(tmp_path, [rod], bars, 60))
    assert record["status"]["outcome"] == "ok", record["status"]
    last = record["steps"][-1]
    assert last["contacts"]["obstacle"] == 2
    assert 0 < last["gap_min_m"] < 0.01
    assert last["contact_load_sum_N"] == pytest.approx(0.05 * 9.81, rel=0.1)


@pytest.mark.parametrize(
    ("obstacle", "named"),
    [
        (ball("ball", 0.2, -0.25), ["obstacle_triangle: ball, sheet[", "gap -"]),
        ({"name": "bar", "kind": "cylinder", "point_m": [0, 0, 0], "axis": [0, 1, 0], "radius_m": 0.1}, ["bar, sheet[", "gap -"]),
        ({"name": "needle", "kind": "cylinder", "point_m": [0.2, -0.25, 0], "axis": [0, 0, 1], "radius_m": 0.001}, ["obstacle_triangle: needle, sheet[", "gap -"]),
    ],
)
def test_an_obstacle_that_touches_at_the_start_is_named(program, tmp_path, obstacle, named):
    record = run(program, config(tmp_path, [sheet(0.1, 0.001)], [obstacle], 3))
    assert record["status"]["outcome"] == "initial_intersection"
    assert all(word in record["status"]["detail"] for word in named), record["status"]["detail"]


def test_an_inside_too_small_and_a_radius_of_zero_are_refused(program, tmp_path):
    done = bench(program, "run", config(tmp_path, [sheet(0)], [ball("shell", 0, 0, 0.6, inside=True)], 3), "--out", tmp_path / "out")
    assert done.returncode == 2 and not (tmp_path / "out").exists()
    assert 'body "sheet" inside obstacle "shell"' in done.stderr and "1.41421 m across" in done.stderr
    for radius in (0, -1):
        done = bench(program, "run", config(tmp_path, [sheet(3)], [ball("ball", 0, 0, radius)], 3), "--out", tmp_path / "out")
        assert done.returncode == 2 and not (tmp_path / "out").exists()
        assert "/scene/obstacles/0/radius_m" in done.stderr
