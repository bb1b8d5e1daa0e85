"""A render mesh that is bound by texture coordinates: by hand, across a seam, in a run, and what is refused by name."""

import json
import subprocess

import numpy as np
import pytest

from barrierbench_analysis.io.frames import frame_paths, read_frame
from barrierbench_analysis.figures.frames_out import verb
from barrierbench_analysis.figures.surfaces.uv_binding import located, uv_of_triangles, uv_of_vertices
from barrierbench_analysis.program.mesh_arrays import read_frame_file
from barrierbench_analysis.io.record_file import read_record

# A cloth of 2 x 1 quads; its coordinates are (x/2, 1 - y), and those of the right quad lie apart, from u = 2 on.
CLOTH = """v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0
vt 0 1\nvt 0.5 1\nvt 0 0\nvt 0.5 0\nvt 2 1\nvt 2.5 1\nvt 2 0\nvt 2.5 0
f 1/1 2/2 5/4 4/3\nf 2/5 3/6 6/8/1 5/7
"""
# Its vertices stand far off; their coordinates are those of the places below.
RENDER = "v 9 0 0\nv 9 1 0\nv 9 0 2\nv 8 0 0\nvt 0.125 0.75\nvt 0.5 0.5\nvt -1 1\nvt 2.25 0.25\nf 1/-4 2/-3 3/1\nf 1/1 4/4 2/2\n"
PLACES = np.array([[0.25, 0.25, 0], [1, 0.5, 0], [0.25, 0.25, 0], [1.5, 0.75, 0]])


@pytest.fixture
def cloth(tmp_path):
    (tmp_path / "cloth.obj").write_text(CLOTH)
    return tmp_path / "cloth.obj"


def test_corners_have_the_coordinates_of_the_file(cloth, tmp_path):
    cells = read_frame_file(cloth, uvs=True)
    np.testing.assert_array_equal(cells.corner_uvs, [0, 1, 3, 2, 4, 5, 7, 6])
    of = uv_of_triangles(cells, np.array([[5, 1, 2], [0, 4, 3], [0, 1, 5]]))
    np.testing.assert_array_equal(of[0], [[2.5, 0], [2, 1], [2.5, 1]])  # the right quad's own
    np.testing.assert_array_equal(of[1], [[0, 1], [0.5, 0], [0, 0]])
    assert np.isnan(of[2]).all()  # of no face
    assert read_frame_file(cloth).corner_uvs is None
    (tmp_path / "plain.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3//1\n")
    assert read_frame_file(tmp_path / "plain.obj", uvs=True).corner_uvs.tolist() == [-1, -1, -1]
    (tmp_path / "render.obj").write_text(RENDER)
    render = read_frame_file(tmp_path / "render.obj", uvs=True)
    np.testing.assert_array_equal(uv_of_vertices(render, "render.obj"), [[0.125, 0.75], [0.5, 0.5], [0.125, 0.75], [2.25, 0.25]])


def test_a_coordinate_is_where_a_triangle_has_it():
    random = np.random.default_rng(5)
    corners = random.normal(size=(40, 3, 2)) + 5 * np.arange(40)[:, None, None]
    weights = random.dirichlet((1, 1, 1), 40)
    uv = np.einsum("nk,nkc->nc", weights, corners)
    space = np.concatenate([corners, np.zeros((40, 3, 1))], axis=2)
    owner, found = located(uv[::-1], corners, np.zeros((40, 3)), space)
    np.testing.assert_array_equal(owner, np.arange(40)[::-1])
    np.testing.assert_allclose(found, weights[::-1], atol=1e-9)
    owner, _ = located(np.array([[1e3, 0], [np.nan, 0]]), corners, np.zeros((2, 3)), space)
    assert owner.tolist() == [-1, -1]


def test_of_two_triangles_with_the_same_coordinates_the_closer_one_is_taken():
    uv = np.tile(np.array([[[0.0, 0], [1, 0], [0, 1]]]), (2, 1, 1))
    space = np.concatenate([uv, np.array([0.0, 1.0])[:, None, None] * np.ones((2, 3, 1))], axis=2)
    owner, _ = located(np.full((2, 2), 0.25), uv, np.array([[0, 0, 0.4], [0, 0, 0.7]]), space)
    assert owner.tolist() == [0, 1]


@pytest.fixture
def run(program, cloth, tmp_path):
    """The cloth falls, from where it is moved to, behind another body."""
    plain = {"name": "other", "mesh": {"generator": "grid"}, "transform": {"translate_m": [0, 0, 50]}}
    material = {"youngs_N_per_m": 10, "density_kg_per_m2": 1}
    body = {"name": "cloth", "mesh": {"file": "cloth.obj"}, "material": material, "transform": {"translate_m": [0, 0, 3]}, "pins": [{"indices": [0]}]}
    config = {"schema": "barrierbench.config/1", "scene": {"bodies": [plain, body]}, "formulation": {"name": "log", "d_hat_m": 0.01},
              "time": {"dt_s": 0.02, "steps": 5}, "output": {"frames_every": 5}, "passes": {"time": False}}  # fmt: skip
    (tmp_path / "config.json").write_text(json.dumps(config))
    done = subprocess.run([program, "run", tmp_path / "config.json", "--out", tmp_path / "run"], capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stderr
    (tmp_path / "render.obj").write_text(RENDER)
    return tmp_path / "run"


def bind(run, out, *more):
    return verb.main([str(run), str(out), "--format", "ply", "--render-mesh", str(run.parent / "render.obj"), "--body", "cloth", "--bind", "uv", *more])


def test_a_mesh_follows_the_points_with_its_coordinates(run, tmp_path, capsys):
    assert bind(run, tmp_path / "out") == 0
    assert "4 vertices and 2 triangles bound to cloth by texture coordinates" in capsys.readouterr().out
    start, end = (read_frame(tmp_path / f"out/frame_{k:06}.ply").vertices[-4:] for k in (0, 2))
    np.testing.assert_allclose(start, PLACES + [0, 0, 3], atol=1e-12)
    frames = [read_frame(path) for path in frame_paths(read_record(run / "run.json"), run).values()]
    x = frames[-1].vertices[-6:]
    assert np.abs(end - start)[:, 2].min() > 0.01
    inside = {tuple(t) for t in frames[-1].triangles - (len(frames[-1].vertices) - 6)}
    diagonal = (x[0] + x[4]) / 2 if any({0, 4} <= set(t) for t in inside) else (x[1] + x[3]) / 2
    np.testing.assert_allclose(end[0], (x[0] + diagonal) / 2, atol=1e-9)  # (0.25, 0.25) lies between
    np.testing.assert_allclose(end[1], (x[1] + x[4]) / 2, atol=1e-9)


@pytest.mark.parametrize("change, said", [
    (("vt 2.25 0.25", "vt 1.25 0.25"), "vertex 3 has the texture coordinates (1.25, 0.25), which no triangle of cloth covers"),
    (("f 1/1 4/4 2/2", "f 1/1 4 2/2"), "vertex 3 has no texture coordinates"),
    (("f 1/1 4/4 2/2", "f 1/1 4/9 2/2"), "found the texture coordinate 9; allowed: one of the 4"),
])
def test_a_vertex_without_a_place_is_named(run, tmp_path, capsys, change, said):
    (tmp_path / "render.obj").write_text(RENDER.replace(*change))
    assert bind(run, tmp_path / "out") == 2
    assert said in capsys.readouterr().err and not (tmp_path / "out").exists()


def test_what_it_cannot_mean_is_refused(run, tmp_path, capsys):
    for words, said in [(["--smooth"], "--smooth: vertices lie on the surface"), (["--reach", "1"], "--reach: vertices lie"),
                        (["--body", "other"], "the mesh of other is a generator; allowed: the whole of an OBJ file")]:
        assert bind(run, tmp_path / "out", *words) == 2
        assert said in capsys.readouterr().err
    assert verb.main([str(run), str(tmp_path / "out"), "--format", "ply", "--bind", "uv"]) == 2
    assert "--bind uv: nothing to bind" in capsys.readouterr().err
