"""Meshes of a config as numpy arrays: what the program reads is what was given, and the record finds it again."""

import json
import subprocess

import numpy as np
import pytest

SQUARE = {"vertices": np.array([[0, 0, 0.5], [1, 0, 0.5], [1, 1, 0.5], [0, 1, 0.5]]), "triangles": np.array([[0, 1, 2], [0, 2, 3]], np.int32)}


def config(mesh: dict, **more) -> dict:
    body = {"name": "sheet", "mesh": mesh, "material": {"density_kg_per_m2": 0.2, "youngs_Pa": 1e5, "thickness_m": 1e-3, "poisson": 0.3}, **more}
    return {
        "scene": {"name": "bodies", "bodies": [body]}, "formulation": {"name": "log", "d_hat_m": 0.01}, "time": {"dt_s": 0.01, "steps": 2},
        "matching": {"rule": "as_given"},
    }


def test_a_mesh_of_arrays_is_the_scene_s(bb, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene = bb.build_scene(config(SQUARE))
    np.testing.assert_array_equal(scene.x0, SQUARE["vertices"])
    np.testing.assert_array_equal(np.sort(scene.faces, axis=1), np.sort(SQUARE["triangles"], axis=1))
    assert list(tmp_path.iterdir()) == []
    lists = {key: value.tolist() for key, value in SQUARE.items()}
    np.testing.assert_array_equal(bb.build_scene(config(lists)).x0, scene.x0)


def test_rods_and_tetrahedra(bb, tmp_path):
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    rod = {"vertices": corners[:3], "segments": [[0, 1], [1, 2]]}
    scene = bb.build_scene(config(rod) | {"scene": {"name": "bodies", "bodies": [{"name": "rod", "mesh": rod, "material": {"line_density_kg_per_m": 0.1, "rod_stretching_N": 10.0}}]}})
    assert scene.edges.shape == (2, 2)
    solid = {"vertices": corners, "tetrahedra": np.array([[0, 1, 2, 3]])}
    body = {"name": "solid", "mesh": solid, "material": {"solid_density_kg_per_m3": 1000.0, "solid_youngs_Pa": 1e5, "solid_poisson": 0.3}}
    assert bb.build_scene(config(solid) | {"scene": {"name": "bodies", "bodies": [body]}}).faces.shape == (4, 3)


def test_the_mesh_lies_beside_the_record_which_repeats_itself(bb, tmp_path, program):
    record = bb.run(config(SQUARE), {"/passes/time": False}, out=tmp_path / "run")
    (file,) = (tmp_path / "run/inputs").iterdir()
    assert record["config"]["scene"]["bodies"][0]["mesh"]["file"] == f"inputs/{file.name}"
    moved = (tmp_path / "run").rename(tmp_path / "moved")
    done = subprocess.run([program, "run", moved / "run.json", "--out", tmp_path / "again"], capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stderr
    assert json.loads((tmp_path / "again/run.json").read_text())["summary"]["state_hash"] == record["summary"]["state_hash"]


@pytest.mark.parametrize("change, place, found", [
    ({"vertices": np.zeros((4, 2))}, "/mesh/vertices", "shape (4, 2)"),
    ({"vertices": np.array([["a"] * 3])}, "/mesh/vertices", "<U1"),
    ({"triangles": np.zeros((2, 3))}, "/mesh/triangles", "float64"),
    ({"triangles": [[0, 1, 4]]}, "/mesh/triangles", "0 to 4"),
    ({"triangles": [[0, -1, 2]]}, "/mesh/triangles", "-1 to 2"),
    ({"vertices": [[0, 0, 0], [1, 0]]}, "/mesh/vertices", "shape ()"),
])
def test_arrays_that_are_no_mesh_are_refused_with_their_place(bb, tmp_path, change, place, found):
    with pytest.raises(bb.ConfigError) as message:
        bb.run(config({**SQUARE, **change}), out=tmp_path / "run")
    assert place in str(message.value) and found in str(message.value)
    assert not (tmp_path / "run").exists()
