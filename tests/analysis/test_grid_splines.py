"""Grids drawn with more points: splines through their vertices, what follows them, and what is refused."""

import json

import meshio
import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from barrierbench_analysis.figures.pictures import render
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.frames import Frame
from barrierbench_analysis.figures.frames_out import verb
from barrierbench_analysis.figures.surfaces.grid_splines import GridSplines
from barrierbench_analysis.figures.pictures.film import filmed, opened
from tests.falling_cloth import CLOTH_ON_BALL
from tests.play.play_runs import run_of

ROWS, COLUMNS = 4, 6
SCENE = {"bodies": ["net", "tetrahedron"], "obstacles": [{"kind": "plane", "vertex": 28}], "planar": False}
MESHES = {"net": {"generator": "grid", "n_x": COLUMNS, "n_y": ROWS}, "tetrahedron": {"file": "four.obj"}}
RECORD = {"labels": {"scene": "bodies"}, "config": {"scene": {"bodies": [{"name": n, "mesh": m} for n, m in MESHES.items()]}}}


def surface(u, v):
    return np.stack([u, v, 0.1 * np.cos(np.pi * u) * np.cos(2 * np.pi * v)], axis=-1)


def state() -> Frame:
    """The net, four more vertices, and one of an obstacle; whose triangles say their number as their stretch."""
    v, u = np.meshgrid(np.linspace(0, 1, ROWS), np.linspace(0, 1, COLUMNS), indexing="ij")
    number = np.arange(ROWS * COLUMNS).reshape(ROWS, COLUMNS)
    cells = [(a, b, d, a, d, c) for a, b, c, d in zip(*(number[i : ROWS - 1 + i, j : COLUMNS - 1 + j].ravel() for i in (0, 1) for j in (0, 1)))]
    triangles = np.array(cells).reshape(-1, 3)
    more = np.array([[24, 25, 26], [24, 26, 27]])
    points = np.concatenate([surface(u, v).reshape(-1, 3), np.eye(3), [[0, 0, 0]], [[0, 0, -5]]])
    body = np.array([0] * 24 + [1] * 4 + [2])
    return Frame(points, np.concatenate([triangles, more]), np.array([[24, 27]]), {"body": body, "gap_rel": points[:, 0]},
                 {"body": np.array([0] * len(triangles) + [1, 1]), "stretch": np.arange(len(triangles) + 2.0)})  # fmt: skip


def test_vertices_stay_where_they_are_and_the_rest_is_between():
    frame = state()
    made = GridSplines(RECORD, SCENE, frame, (COLUMNS, ROWS), ("tetrahedron",)).finer(frame)
    np.testing.assert_allclose(made.vertices, frame.vertices, atol=1e-12)
    np.testing.assert_array_equal(made.triangles, frame.triangles)
    np.testing.assert_array_equal(made.of_triangles["stretch"], frame.of_triangles["stretch"])
    fine = GridSplines(RECORD, SCENE, frame, (2 * COLUMNS - 1, 2 * ROWS - 1), ("tetrahedron",)).finer(frame)
    net = fine.vertices[: (2 * ROWS - 1) * (2 * COLUMNS - 1)].reshape(2 * ROWS - 1, 2 * COLUMNS - 1, 3)
    np.testing.assert_allclose(net[::2, ::2].reshape(-1, 3), frame.vertices[:24], atol=1e-12)
    between = net[1::2, 1::2, 2]
    assert np.abs(between).max() > 0.02  # curved: the mean of four vertices is elsewhere
    corners = frame.vertices[:24, 2].reshape(ROWS, COLUMNS)
    flat = (corners[1:, 1:] + corners[1:, :-1] + corners[:-1, 1:] + corners[:-1, :-1]) / 4
    assert np.abs(between - flat).max() > 0.01


def test_between_two_vertices_of_a_line_it_is_the_cubic_spline_with_level_ends():
    """Heights that are level across the ends, as those of the cosine are: the spline of SciPy's other module, along the line."""
    frame = state()
    fine = GridSplines(RECORD, SCENE, frame, (45, ROWS), ("tetrahedron",)).finer(frame).vertices[: 45 * ROWS].reshape(ROWS, 45, 3)
    heights = frame.vertices[:24, 2].reshape(ROWS, COLUMNS)
    known = CubicSpline(np.arange(COLUMNS), heights, axis=1, bc_type="clamped")(np.linspace(0, COLUMNS - 1, 45))
    np.testing.assert_allclose(fine[..., 2], known, atol=1e-10)


def test_fields_bodies_rods_and_obstacles_follow():
    frame, counts = state(), (45, 30)
    splines = GridSplines(RECORD, SCENE, frame, counts, ("tetrahedron",))
    made, own = splines.finer(frame), 45 * 30
    assert len(made.vertices) == own + 4 + 1 and splines.added == own - 24
    assert len(made.triangles) == 2 * 44 * 29 + 2
    np.testing.assert_array_equal(made.vertices[own:], frame.vertices[24:])
    np.testing.assert_array_equal(made.edges, [[own, own + 3]])
    np.testing.assert_array_equal(np.asarray(made.of_vertices["body"])[[0, own - 1, own, own + 4]], [0, 0, 1, 2])
    assert splines.scene(SCENE)["obstacles"][0]["vertex"] == own + 4
    u = np.tile(np.linspace(0, 1, 45), 30)
    np.testing.assert_allclose(made.of_vertices["gap_rel"][:own], u, atol=1e-12)  # straight between vertices
    middles = made.vertices[made.triangles[:-2]].mean(axis=1)
    corners = frame.vertices[frame.triangles[made.of_triangles["stretch"][:-2].astype(int)], :2]
    low, high = corners.min(axis=1) - 0.02, corners.max(axis=1) + 0.02
    assert ((middles[:, :2] > low) & (middles[:, :2] < high)).all(), "each of them is of the triangle that it lies in"
    normals = np.cross(*(made.vertices[made.triangles[:-2]][:, k] - made.vertices[made.triangles[:-2]][:, 0] for k in (1, 2)))
    assert (normals[:, 2] > 0).all()


def test_what_is_no_grid_is_refused_by_name():
    frame = state()
    with pytest.raises(UserError, match="--bicubic: body tetrahedron: its mesh is no grid but four.obj; allowed"):
        GridSplines(RECORD, SCENE, frame, (45, 45))
    with pytest.raises(UserError, match="--bicubic: found 5 45; allowed: 6 4, as many as net has, or more"):
        GridSplines(RECORD, SCENE, frame, (5, 45), ("tetrahedron",))
    procedural = {"labels": {"scene": "drape"}, "config": {"scene": {"name": "drape"}}}
    with pytest.raises(UserError, match="body net: its mesh is no grid but made by the scene drape"):
        GridSplines(procedural, SCENE, frame, (45, 45))


def test_stills_and_films_of_a_run_have_the_points(program, tmp_path):
    run = run_of(program, tmp_path / "run")
    words = [str(run), "--size", "120", "90", "--hide", "rod", "--bicubic", "45", "45"]
    assert render.main([*words, "--out", str(tmp_path / "fine.png")]) == 0
    assert "grids with 45 x 45 points on cubic splines" in (tmp_path / "fine.txt").read_text()
    with pytest.raises(UserError, match="body rod: its mesh is no grid but rod"):
        opened(run, (45, 45))
    with pytest.raises(UserError, match="--bicubic: found beside --subdivide"):
        render.written(render.parse([*words, "--subdivide", "1"]))


def test_a_film_of_a_net_alone_has_the_points(program, tmp_path):
    cloth = json.dumps(CLOTH_ON_BALL["scene"]["bodies"][:1])
    film = filmed(opened(run_of(program, tmp_path / "net", f"/scene/bodies={cloth}"), (20, 11)))
    assert film.positions.shape[1:] == (220, 3) and len(film.start.triangles) == 2 * 19 * 10
    assert film.stretch.shape == (len(film.steps), 2 * 19 * 10)


def test_files_of_frames_of_a_net_alone_have_the_points(program, tmp_path, capsys):
    cloth = json.dumps(CLOTH_ON_BALL["scene"]["bodies"][:1])
    run = run_of(program, tmp_path / "net", f"/scene/bodies={cloth}")
    assert verb.main([str(run), str(tmp_path / "out"), "--format", "obj", "--bicubic", "20", "11"]) == 0
    made = [meshio.read(path) for path in sorted((tmp_path / "out").glob("frame_*.obj"))]
    film = filmed(opened(run, (20, 11)))
    assert len(made) == len(film.steps) > 1
    for mesh, positions in zip(made, film.positions):
        assert mesh.points.shape == (220, 3)
        np.testing.assert_allclose(mesh.points, positions, atol=1e-6)
    assert verb.main([str(run), str(tmp_path / "none"), "--format", "obj", "--bicubic", "5", "45"]) == 2
    assert "--bicubic: found 5 45; allowed" in capsys.readouterr().err and not (tmp_path / "none").exists()
