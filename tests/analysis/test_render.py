"""Frames read back as they were written, and stills whose pixels are what lies in front."""

import json
import shutil
import subprocess
import sys

import matplotlib.pyplot as plt
import numpy as np
import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.figures.pictures import frame_pixels, render, still_picture
from barrierbench_analysis.io.frames import Frame, frame_paths, read_frame, read_scene, without_bodies
from barrierbench_analysis.figures.surfaces.obstacle_rays import hits, primitive_gaps, signed_gap
from barrierbench_analysis.figures.pictures.picture import picture
from barrierbench_analysis.figures.surfaces.rasterizer import Camera, DepthBuffer
from barrierbench_analysis.io.record_file import read_record
from tests.falling_cloth import CLOTH_ON_BALL

SMALL = (120, 90)


@pytest.fixture(scope="module")
def run(program, tmp_path_factory):
    """A cloth that has fallen onto a sphere, with frames of the start and of steps 0, 2 and 4."""
    folder = tmp_path_factory.mktemp("render")
    (folder / "config.json").write_text(json.dumps({**CLOTH_ON_BALL, "output": {"frames_every": 2}}))
    done = subprocess.run([program, "run", folder / "config.json", "--out", folder / "out"],
                          capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, done.stderr
    return folder / "out"


def opened(run):
    """Record, scene and places of the frames."""
    record = read_record(run / "run.json")
    return record, read_scene(record, run), frame_paths(record, run)


# --- what the program leaves


def test_frames_carry_bodies_rods_obstacles_and_the_start(run):
    record, scene, paths = opened(run)
    assert record["status"]["outcome"] == "ok"
    assert list(paths) == [-1, 0, 2, 4]
    assert scene["bodies"] == ["cloth", "rod"] and scene["planar"] is False
    assert scene["obstacles"] == [{"name": "ball", "kind": "sphere", "point_m": [0, 0, 0], "radius_m": 0.1, "inside": False}]
    start = read_frame(paths[-1])
    assert start.vertices.shape == (40, 3) and start.triangles.shape == (50, 3)
    assert [list(e) for e in start.edges] == [[36, 37], [37, 38], [38, 39]]
    assert list(start.of_vertices["body"]) == [0] * 36 + [1] * 4 and set(start.of_triangles["body"]) == {0}
    np.testing.assert_array_equal(start.vertices[:36, 2], 0.106)
    assert set(start.of_vertices) == {"body"} and abs(start.of_triangles["stretch"]).max() < 1e-14
    named = {a["path"]: a for a in record["artifacts"]}
    assert {"frames/scene.json", "frames/start.ply", "frames/step_000004.ply"} <= set(named)


def test_fields_of_the_last_frame_are_those_of_its_step(run):
    record, frame = opened(run)[0], read_frame(opened(run)[2][4])
    step = record["steps"][4]
    gap, load, stretch = frame.of_vertices["gap_rel"], frame.of_vertices["load_N"], frame.of_triangles["stretch"]
    assert step["contacts"]["obstacle"] > 0
    touched = gap < 1
    assert 0 < touched.sum() < 36
    of_triangles = primitive_gaps(opened(run)[1]["obstacles"][0], frame.vertices[frame.triangles])
    nearest = np.full(40, np.inf)  # a vertex in contact has the gap of the nearest triangle round it
    np.minimum.at(nearest, frame.triangles, of_triangles[:, None])
    assert (nearest[:36] < np.linalg.norm(frame.vertices[:36], axis=1) - 0.101).any() and len(np.unique(gap[touched].round(6))) > 2
    np.testing.assert_allclose(gap[touched], nearest[touched] / 0.005, rtol=1e-9)
    assert touched[frame.triangles[of_triangles < 0.005]].any(axis=1).all() and (gap[~touched] == 1).all()
    assert (load[touched] > 0).all() and (load[~touched] == 0).all()
    most = step["contact_load_max_N"]  # of one contact; a vertex has its parts of all contacts round it
    assert most / 4 < load.max() < step["contact_load_sum_N"] and most > step["contact_load_sum_N"] / step["contacts"]["obstacle"]
    assert load.sum() == pytest.approx(step["contact_load_sum_N"], rel=1e-9)
    assert stretch.max() == pytest.approx(step["max_stretch"], rel=1e-9) and stretch.max() > 1e-6


def test_a_frame_is_a_mesh_that_a_config_can_name(program, run, tmp_path):
    config = {"schema": "barrierbench.config/1", "formulation": {"name": "log", "d_hat_m": 0.005}, "time": {"dt_s": 0.01, "steps": 1},
              "scene": {"bodies": [{"name": "again", "mesh": {"file": str(run / "frames/step_000004.ply")},
                                    "material": {"line_density_kg_per_m": 0.1, "springs_N_per_m": 10}}]}}
    (tmp_path / "config.json").write_text(json.dumps(config))
    done = subprocess.run([program, "check", tmp_path / "config.json"], capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0 and "40 vertices" in done.stdout, done.stderr


# --- pixels


def test_the_nearer_triangle_owns_the_pixel():
    camera = Camera(np.array([0.0, 0, 5]), np.zeros(3), np.array([0.0, 1, 0]), 100, (50.0, 50.0))
    far = np.array([[-1.0, -1, 0], [1, -1, 0], [0, 2, 0]])
    near = np.array([[-0.2, -0.2, 1], [0.2, -0.2, 1], [0, 0.4, 1]])
    for order in ([0, 1], [1, 0]):
        buffer = DepthBuffer(100, 100)
        both = np.concatenate([far, near])
        buffer.draw(camera.project(both), np.array([[0, 1, 2], [3, 4, 5]])[order])
        assert order[buffer.owner[50, 50]] == 1  # the near one, in whatever order they come
        assert order[buffer.owner[66, 50]] == 0  # below it
        assert buffer.owner[0, 0] == -1


@pytest.mark.parametrize("obstacle", [
    {"kind": "sphere", "point_m": [1, 2, 3], "radius_m": 0.5},
    {"kind": "cylinder", "point_m": [1, 2, 3], "axis": [0, 0.6, 0.8], "radius_m": 0.5},
    {"kind": "plane", "point_m": [1, 2, 3], "axis": [0, 0.28, 0.96]},
])
@pytest.mark.parametrize("perspective", [True, False])
def test_rays_meet_an_obstacle_on_its_surface_and_as_deep_as_its_points_are(obstacle, perspective):
    center = np.array([1.0, 2, 3.2])
    camera = Camera(center + np.array([3.0, -4, 2]), center, np.array([0.0, 0, 1]), 60.0, (50.0, 40.0), perspective)
    seen = hits(obstacle, camera, camera.rays(100, 80), center, 2.0)
    hit = seen.mask
    assert 60 < hit.sum() < 8000
    x = seen.points
    np.testing.assert_allclose(signed_gap(obstacle, x), 0, atol=1e-12)
    pixel = camera.project(x)
    row, column = np.nonzero(hit)
    np.testing.assert_allclose(pixel[:, :2], np.stack([column + 0.5, row + 0.5], 1), atol=1e-6)
    np.testing.assert_allclose(pixel[:, 2], seen.depth, rtol=1e-9)
    np.testing.assert_array_equal(seen.depth_image()[hit], seen.depth)
    np.testing.assert_allclose(np.linalg.norm(seen.normals, axis=1), 1)
    behind = x - 1e-3 * (x - camera.eye) if perspective else x - 1e-3 * (center - camera.eye)  # nothing in front of it
    if obstacle["kind"] != "plane":
        assert (signed_gap(obstacle, behind) > 0).all()


@pytest.mark.parametrize("perspective", [True, False])
def test_a_plane_is_not_seen_from_behind(perspective):
    camera = Camera(np.array([0.0, -4, 2]), np.zeros(3), np.array([0.0, 0, 1]), 60.0, (50.0, 40.0), perspective)
    for side, seen in ((1, True), (-1, False)):  # the wall y = -1 between the camera and the centre, and turned round
        wall = {"kind": "plane", "point_m": [0, -1, 0], "axis": [0, -side, 0]}
        assert hits(wall, camera, camera.rays(100, 80), np.zeros(3), 2.0).mask.any() == seen


def test_gaps_of_triangles_and_edges_agree_with_samples():
    random = np.random.default_rng(3)
    share = np.array([(i / 30, j / 30) for i in range(31) for j in range(31 - i)])
    hidden = 0
    for obstacle in [{"kind": "sphere", "point_m": [0, 0, 0], "radius_m": 0.3},
                     {"kind": "cylinder", "point_m": [0, 0, 0], "axis": [0, 0.6, 0.8], "radius_m": 0.2},
                     {"kind": "sphere", "point_m": [0, 0, 0], "radius_m": 0.9, "inside": True},
                     {"kind": "plane", "point_m": [0, 0, 0], "axis": [0, 0, 1]}]:
        corners = random.uniform(-1, 1, (200, 3, 3))
        sampled = signed_gap(obstacle, corners[:, None, 0] + share[:, :1] * (corners[:, None, 1] - corners[:, None, 0])
                             + share[:, 1:] * (corners[:, None, 2] - corners[:, None, 0])).min(axis=1)
        gaps = primitive_gaps(obstacle, corners)
        assert (gaps <= sampled + 1e-12).all() and (gaps > sampled - 0.06).all()
        hidden += ((gaps < 0) & (signed_gap(obstacle, corners).min(axis=1) > 0.05)).sum()
        edges = primitive_gaps(obstacle, corners[:, :2])
        assert (edges >= gaps - 1e-12).all() and (edges <= signed_gap(obstacle, corners[:, :2]).min(axis=1) + 1e-12).all()
    assert hidden > 20  # vertices outside, the triangle inside


def _triangle_over_a_ball(z):
    vertices = np.array([[-4.0, -4, z], [4, -4, z], [0, 6, z]])
    frame = Frame(vertices, np.array([[0, 1, 2]]), np.zeros((0, 2), int), {"body": np.zeros(3, int)}, {"body": np.zeros(1, int)})
    return frame, {"bodies": ["sheet"], "planar": False, "obstacles": [{"name": "ball", "kind": "sphere", "point_m": [0, 0, 0], "radius_m": 1.0, "inside": False}]}


@pytest.mark.parametrize("z, shows", [(0.999, True), (1.001, False)])
def test_an_obstacle_that_a_triangle_cuts_shows_through_it_and_no_other(z, shows):
    """Seen from above, a millimetre decides: the obstacle is neither shrunk nor moved nor made of facets."""
    frame, scene = _triangle_over_a_ball(z)
    camera = Camera(np.array([0.0, 0, 9]), np.zeros(3), np.array([0.0, 1, 0]), 3000.0, (60.0, 60.0))
    surfaces, _ = frame_pixels._assemble(frame, scene, "body", 4.0)
    surfaces.corner_colors[:] = (0, 0, 1)
    image = picture(surfaces, camera, (60, 60), False, np.zeros(3), 4.0)
    grey = np.ptp(image, axis=-1) < 0.05
    assert grey[30, 30] == shows and not grey[2, 2]


def test_a_caption_says_how_far_a_surface_enters_an_obstacle():
    assert "sheet in ball by 1 mm" in still_picture._at_obstacles(*_triangle_over_a_ball(0.999))
    assert "closest is 1 mm away (sheet from ball" in still_picture._at_obstacles(*_triangle_over_a_ball(1.001))
    frame, scene = _triangle_over_a_ball(1.5)
    assert still_picture._at_obstacles(frame, scene | {"obstacles": []}) == ""


def test_planar_stills_show_bodies_over_what_obstacles_forbid():
    frame, scene = _triangle_over_a_ball(0.0)
    scene["planar"] = True
    camera = Camera(np.array([0.0, 0, 9]), np.zeros(3), np.array([0.0, 1, 0]), 10.0, (60.0, 60.0), False)
    surfaces, _ = frame_pixels._assemble(frame, scene, "body", 4.0)
    surfaces.triangles = surfaces.triangles[:0]
    image = picture(surfaces, camera, (60, 60), True, np.zeros(3), 4.0)
    assert image[30, 30].max() < 0.9 and image[2, 2].min() == 1  # the disk
    full = picture(frame_pixels._assemble(frame, scene, "body", 4.0)[0], camera, (60, 60), True, np.zeros(3), 4.0)
    assert np.ptp(full[30, 30]) > 0.2  # the sheet is drawn over it


@pytest.mark.parametrize("color", ["body", "gap", "load", "stretch"])
def test_a_still_is_written_with_its_caption_and_is_the_same_twice(run, tmp_path, color):
    look = frame_pixels.Look(color=color, size=SMALL)
    one = still_picture.render(run, out=tmp_path / "one.png", look=look)
    two = still_picture.render(run / "run.json", step=4, out=tmp_path / "two.png", look=look)
    assert one.read_bytes() == two.read_bytes()
    caption = one.with_suffix(".txt").read_text()
    assert "inside an obstacle" in " ".join(caption.split()).lower() and "end of step 4, t = 0.05 s" in caption and "d_hat_m 0.005" in caption and "Machine:" in caption
    image = plt.imread(one)[..., :3]
    assert image.std() > 0.05  # not one colour


def test_a_body_that_is_hidden_is_not_drawn_and_the_caption_says_so(run, tmp_path):
    record, scene, paths = opened(run)
    name = scene["bodies"][0]
    drawn = still_picture.render(run, out=tmp_path / "drawn.png", look=frame_pixels.Look(size=SMALL))
    hidden = still_picture.render(run, out=tmp_path / "hidden.png", look=frame_pixels.Look(size=SMALL, hidden=(name,)))
    frame = read_frame(paths[-1])
    left = without_bodies(frame, scene, (name,))
    assert len(frame.triangles) > 0 and len(left.triangles) == 0 and len(left.vertices) == len(frame.vertices)
    assert np.abs(plt.imread(drawn) - plt.imread(hidden)).max() > 0.2
    assert f"not drawn: {name}" in " ".join(hidden.with_suffix(".txt").read_text().split())
    with pytest.raises(UserError, match=f"body 'nobody': one of {name}"):
        still_picture.render(run, out=tmp_path / "no.png", look=frame_pixels.Look(size=SMALL, hidden=("nobody",)))


def test_colours_follow_the_field(run):
    record, scene, paths = opened(run)
    frame = read_frame(paths[4])
    surfaces, scale = frame_pixels._assemble(frame, scene, "gap", 0.3)
    touched = (frame.of_vertices["gap_rel"] < 1)[frame.triangles]
    colors = surfaces.corner_colors[:50]
    assert scale.vmax == 1 and touched.any() and not touched.all()
    away = colors[~touched]
    assert np.ptp(away, axis=0).max() == 0  # one colour without contact
    assert np.abs(colors[touched] - away[0]).max(axis=1).min() > 0


def test_a_finer_still_is_the_picture_alone_and_says_that_it_is_finer(run, tmp_path):
    finer = still_picture.render(run, out=tmp_path / "a.png", look=frame_pixels.Look(size=SMALL, subdivide=2, bare=True), title="a cloth")
    assert plt.imread(finer).shape[:2] == SMALL[::-1]
    said = " ".join(finer.with_suffix(".txt").read_text().split())
    assert said.startswith("a cloth, end of step 4, t = 0.05 s.") and "cut 2 times, curved between" in said and "thin lines" not in said


def test_rods_are_as_thick_as_their_contact_says(run):
    record, scene, paths = opened(run)
    frame = read_frame(paths[4])
    record["config"]["scene"]["bodies"][1]["offset_m"] = 0.004
    assert list(frame_pixels._rod_radii(record, scene, frame)) == [0.0] * 36 + [0.004] * 4
    thin, thick = (frame_pixels._assemble(frame, scene, "body", 0.3, radii)[0] for radii in (None, frame_pixels._rod_radii(record, scene, frame)))
    for surfaces, radius in ((thin, 0.006 * 0.3), (thick, 0.004)):
        ring = surfaces.points[40:52]
        np.testing.assert_allclose(np.linalg.norm(ring - frame.vertices[36], axis=1), radius, rtol=1e-9)


def test_a_plane_fades_into_the_white_round_it():
    frame, scene = _triangle_over_a_ball(3.0)
    scene["obstacles"] = [{"name": "floor", "kind": "plane", "point_m": [0, 0, 0], "axis": [0, 0, 1]}]
    surfaces, _ = frame_pixels._assemble(frame, scene, "body", 4.0)
    surfaces.triangles, surfaces.corner_colors = surfaces.triangles[:0], surfaces.corner_colors[:0]
    camera = Camera(np.array([0.0, 0, 30]), np.zeros(3), np.array([0.0, 1, 0]), 130.0, (60.0, 60.0))
    image = picture(surfaces, camera, (60, 60), False, np.zeros(3), 4.0).mean(axis=2)
    assert image[30, 30] < 0.88 and image[30, 58] > 0.99 and (np.diff(image[30, 30:]) >= -1e-9).all()


def test_what_cannot_be_drawn_is_said(run, tmp_path, capsys):
    assert render.main([str(tmp_path)]) == 2
    assert "run.json" in capsys.readouterr().err
    assert render.main([str(run), "--step", "3"]) == 2
    assert "there are -1, 0, 2, 4" in capsys.readouterr().err
    assert render.main([str(run), "--step", "-1", "--color", "gap"]) == 2
    assert "no gap_rel" in capsys.readouterr().err
    record = json.loads((run / "run.json").read_text())
    (tmp_path / "run.json").write_text(json.dumps(record | {"artifacts": []}))
    with pytest.raises(UserError, match="frames_every=1"):
        still_picture.render(tmp_path)


@pytest.mark.parametrize("damage", ["another frame", "cut", "gone", "another scene", "not named"])
def test_frames_that_are_not_those_of_the_record_are_not_drawn(run, tmp_path, capsys, damage):
    copy = tmp_path / "run"
    shutil.copytree(run, copy)
    assert render.main([str(copy), "--size", "60", "40"]) == 0
    last, scene = copy / "frames/step_000004.ply", copy / "frames/scene.json"
    if damage == "another frame":
        shutil.copyfile(copy / "frames/step_000002.ply", last)  # a whole frame of the same bodies
    if damage == "cut":
        last.write_bytes(last.read_bytes()[:-8])
    if damage == "gone":
        last.unlink()
    if damage == "another scene":
        scene.write_text(scene.read_text().replace("ball", "bowl"))
    if damage == "not named":
        record = json.loads((copy / "run.json").read_text())
        record["artifacts"] = [a for a in record["artifacts"] if a["kind"] == "trace"]
        (copy / "run.json").write_text(json.dumps(record))
    capsys.readouterr()
    assert render.main([str(copy)]) == 2
    said = capsys.readouterr().err
    assert ("scene.json" if damage == "another scene" else str(copy)) in said
    assert {"not named": "names no frames", "gone": "a file that can be read is needed"}.get(damage, "allowed: ") in said


@pytest.mark.parametrize("bare", [[], ["--bare"]])
def test_the_path_that_is_said_is_the_file_that_is_written(run, tmp_path, capsys, bare):
    (tmp_path / "there").mkdir()
    for out, file in (("pic", "pic.png"), ("there", "there/step_000004_body.png"), ("a.png", "a.png")):
        assert render.main([str(run), "--out", str(tmp_path / out), "--size", "60", "40", *bare]) == 0
        assert capsys.readouterr().out.strip() == str(tmp_path / file)
        assert (tmp_path / file).read_bytes().startswith(b"\x89PNG") and (tmp_path / file).with_suffix(".txt").is_file()


def test_another_ending_is_refused_before_anything_is_drawn(run, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(still_picture, "drawn_of_run", None)
    assert render.main([str(run), "--out", str(tmp_path / "README.md")]) == 2
    assert f"bench draw still: --out {tmp_path / 'README.md'}: found the ending .md; allowed: a file that ends in .png" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("content", [b"", b"ply\nend_header\n", b"not a mesh", b"ply\nformat ascii 1.0\nend_header\n"])
def test_files_that_are_no_frames(tmp_path, content):
    (tmp_path / "a.ply").write_bytes(content)
    with pytest.raises(UserError, match="a.ply"):
        read_frame(tmp_path / "a.ply")


def test_the_package_needs_no_paths(tmp_path):
    """What README shows, from another folder and without PYTHONPATH."""
    done = subprocess.run([sys.executable, "-c", "from barrierbench_analysis import load; load('.')"], cwd=tmp_path,
                          env={"PATH": "/usr/bin:/bin"}, capture_output=True, text=True, check=False, timeout=60)
    if "No module named 'barrierbench_analysis'" in done.stderr:
        pytest.skip("barrierbench_analysis is not installed (./bench setup)")
    assert "no run.json below this folder" in done.stderr


def test_a_still_by_vtk_has_its_bodies_where_ours_has_them(run, tmp_path):
    pytest.importorskip("vtk", reason="vtk is not installed: analysis/requirements-render.txt")
    own, vtk = (plt.imread(still_picture.render(run, out=tmp_path / f"{name}.png", look=frame_pixels.Look(size=SMALL, bare=True, renderer=name))) for name in ("own", "vtk"))
    drawn = [(image[..., :3] < 0.98).any(axis=2) for image in (own, vtk)]

    assert drawn[0].sum() > 1000 and (drawn[0] != drawn[1]).mean() < 0.02
    assert "drawn by VTK" in (tmp_path / "vtk.txt").read_text().replace("\n", " ")


def test_without_vtk_the_command_that_installs_it_is_said(run, tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "vtkmodules", None)
    monkeypatch.setitem(sys.modules, "vtkmodules.all", None)

    assert render.main([str(run), "--out", str(tmp_path / "a.png"), "--renderer", "vtk"]) == 2
    assert "the package vtk is not installed: .venv/bin/python -m pip install --requirement analysis/requirements-render.txt" in capsys.readouterr().err
