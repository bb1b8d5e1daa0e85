"""Whole runs with weight groups: pulls whose influence grows, inputs that are kept and repeat the run, devices, and a file that
is refused by its line.
"""

import numpy as np
import pytest
from test_cli import bench, refused, write

from barrierbench_analysis.io.frames import frame_of, frame_paths
from barrierbench_analysis.io.record_file import read_record

SHEET = {"generator": "grid", "n_x": 3, "n_y": 3, "size_x_m": 0.2, "size_y_m": 0.2}


def config(folder, **more) -> dict:
    """A sheet without gravity whose left side is pulled to the right one after the other: its weights are 0, 0.5 and 1 along y, and
    their influence begins at 0.05 s.
    """
    (folder / "side.txt").write_text("\n".join("0 0 0 0.5 0 0 1 0 0".split()) + "\n")
    (folder / "balls.txt").write_text("\n".join(["0.25"] * 42))
    pin = {"pull_N_per_m": 2, "motion": {"velocity_m_per_s": [0.1, 0, 0]},
           "mix": [{"group": "side", "influence_schedule": [{"time_s": 0.05, "influence": 0}, {"time_s": 0.1, "influence": 1}]}]}  # fmt: skip
    sheet = {"name": "sheet", "mesh": SHEET, "material": {"model": "none", "springs_N_per_m": 1e-6, "density_kg_per_m2": 1, "plasticity": 0},
             "weights": [{"name": "side", "file": "side.txt"}], "pins": [pin]}  # fmt: skip
    ball = {"name": "ball", "mesh": {"generator": "icosphere", "level": 1, "radius_m": 0.1}, "transform": {"translate_m": [0, 0, 5]},
            "material": {"model": "none", "springs_N_per_m": 1e-6, "lumping": "mixed_voronoi"}, "pressure_Pa": 0.5,
            "weights": [{"name": "all", "file": "balls.txt"}], "pressure_mix": [{"group": "all"}]}  # fmt: skip
    return {"schema": "barrierbench.config/1", "scene": {"gravity_m_per_s2": [0, 0, 0], "bodies": [sheet, ball]},
            "formulation": {"name": "log", "d_hat_m": 0.001}, "time": {"dt_s": 0.005, "steps": 20},
            "passes": {"time": False}, "output": {"frames_every": 1}, **more}  # fmt: skip


def run(program, folder, made, *more):
    folder.mkdir(exist_ok=True)
    done = bench(program, "run", write(folder / "config.json", made), "--out", folder / "out", *more)
    assert done.returncode == 0, done.stderr
    return read_record(folder / "out/run.json")


def positions(record, folder) -> np.ndarray:
    return np.array([frame_of(record, folder, step).vertices for step in frame_paths(record, folder)])


def test_a_pull_grows_with_its_influence(program, tmp_path):
    record = run(program, tmp_path, config(tmp_path))
    x = positions(record, tmp_path / "out")
    way = x[:, :9, 0] - x[0, :9, 0]
    assert len(x) == 21 and not way[10].any()  # 0.05 s: nothing has acted so far
    assert way[20, 6] > 1.3 * way[20, 3] > 1e-4
    assert np.abs(np.delete(way, [3, 6], axis=1)).max() < 1e-6
    out = np.linalg.norm(x[:, 9:] - [0, 0, 5], axis=2)
    assert (out[20] - out[0]).min() > 1e-4
    named = record["scene"]["mesh_sha256"]
    assert len(named) == 2 and all("side" in name or "balls" in name for name in named)


def test_kept_inputs_repeat_the_run(program, tmp_path):
    first = run(program, tmp_path, config(tmp_path), "--keep-inputs")
    (tmp_path / "side.txt").write_text("1\n" * 9)
    done = bench(program, "run", tmp_path / "out/run.json", "--out", tmp_path / "again")
    assert done.returncode == 0, done.stderr
    again = read_record(tmp_path / "again/run.json")
    np.testing.assert_array_equal(positions(first, tmp_path / "out"), positions(again, tmp_path / "again"))


def test_threads_of_the_device_executor_go_the_same_way(program, tmp_path):
    (tmp_path / "cpu").mkdir(), (tmp_path / "host").mkdir()
    here = positions(run(program, tmp_path / "cpu", config(tmp_path / "cpu")), tmp_path / "cpu/out")
    there = positions(run(program, tmp_path / "host", config(tmp_path / "host", device="host")), tmp_path / "host/out")
    assert np.abs(there[-1] - there[0]).max() > 1e-3
    np.testing.assert_allclose(there, here, rtol=0, atol=1e-9)


@pytest.mark.parametrize("text, message", [
    ("0\n1\n2\n" + "0\n" * 6, "side.txt:3: found 2; allowed: one number from 0 to 1 in a line"),
    ("0\n" * 8, "side.txt: found 8 numbers; allowed: 9, one a vertex of the body"),
])
def test_a_wrong_file_is_refused_before_the_first_step(program, tmp_path, text, message):
    made = config(tmp_path)
    (tmp_path / "side.txt").write_text(text)
    refused(bench(program, "run", write(tmp_path / "config.json", made), "--out", tmp_path / "out"), message)
    assert not (tmp_path / "out").exists()


def test_a_group_that_is_none_is_named(program, tmp_path):
    made = config(tmp_path)
    made["scene"]["bodies"][0]["pins"][0]["mix"][0]["group"] = "sides"
    done = bench(program, "run", write(tmp_path / "config.json", made), "--out", tmp_path / "out")
    refused(done, 'found the weight group "sides"; allowed: a group of the body: side')
