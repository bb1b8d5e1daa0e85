"""`bench data frames`: each format read back by a reader that is not ours, and what is refused."""

import json
import struct
import subprocess
import xml.etree.ElementTree as ElementTree

import meshio
import numpy as np
import pytest

from barrierbench_analysis.io.frames import frame_paths, read_frame
from barrierbench_analysis.figures.frames_out import formats, verb
from barrierbench_analysis.io.record_file import read_record
from tests.falling_cloth import CLOTH_ON_BALL


@pytest.fixture(scope="module")
def run(program, tmp_path_factory):
    """A cloth, a rod and a solid above a ball that stands and a floor that moves; frames of the start and of 0, 2, 3."""
    folder = tmp_path_factory.mktemp("frames_out")
    scene = CLOTH_ON_BALL["scene"]
    solid = {"name": "block", "mesh": {"generator": "solid_box", "n_x": 2, "n_y": 2, "n_z": 2, "size_x_m": 0.1, "size_y_m": 0.1, "size_z_m": 0.1},
             "transform": {"translate_m": [0.6, 0, 0.2]}, "limited": False, "material": {"solid_youngs_Pa": 1e5, "solid_poisson": 0.3, "solid_density_kg_per_m3": 1000}}
    floor = {"name": "floor", "kind": "plane", "point_m": [0, 0, -0.3], "motion": {"velocity_m_per_s": [0, 0, 0.5]}}
    config = {**CLOTH_ON_BALL, "scene": {**scene, "bodies": [*scene["bodies"], solid], "obstacles": [*scene["obstacles"], floor]},
              "time": {"dt_s": 0.01, "steps": 4}, "output": {"frames_every": 2}}
    (folder / "config.json").write_text(json.dumps(config))
    done = subprocess.run([program, "run", folder / "config.json", "--out", folder / "out"], capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, done.stderr
    return folder / "out"


@pytest.fixture(scope="module")
def frames(run):
    return [read_frame(path) for path in frame_paths(read_record(run / "run.json"), run).values()]


def export(run, out, kind, *words):
    assert verb.main([str(run), str(out), "--format", kind, *words]) == 0
    assert [path.name for path in out.parent.iterdir()] == [out.name]  # nothing is left beside it
    return out


def drawn(frame):
    """Vertices of a frame that are of a surface or a rod: all but the middle of the solid and the floor's point."""
    return np.unique(np.concatenate([frame.triangles.ravel(), frame.edges.ravel()]))


def test_the_frames_have_what_the_tests_need(frames):
    first = frames[0]
    assert len(frames) == 4 and len(first.vertices) == 40 + 27 + 1 and len(drawn(first)) == 40 + 26
    assert "gap_rel" not in first.of_vertices and (frames[-1].of_vertices["gap_rel"] < 1).any()


def test_obj_has_every_bit_and_an_object_a_body(run, frames, tmp_path):
    out = export(run, tmp_path / "obj", "obj")
    assert sorted(p.name for p in out.iterdir()) == sorted([*(f"{s}_{k:06}.obj" for s in ("frame", "obstacles") for k in range(4)), "times.csv"])
    for k, frame in enumerate(frames):
        lines = [line.split() for line in (out / f"frame_{k:06}.obj").read_text().splitlines()]
        points = np.array([[float(w) for w in line[1:]] for line in lines if line[0] == "v"])
        np.testing.assert_array_equal(points, frame.vertices[drawn(frame)])
        assert [line[1] for line in lines if line[0] == "o"] == ["cloth", "rod", "block"]
        read = meshio.read(out / f"frame_{k:06}.obj")
        np.testing.assert_array_equal(drawn(frame)[read.cells_dict["triangle"]], frame.triangles)
        rods = np.array([[int(w) for w in line[1:]] for line in lines if line[0] == "l"])
        np.testing.assert_array_equal(drawn(frame)[rods - 1], frame.edges)
    assert (out / "times.csv").read_text() == "frame,step,time_s\n0,-1,0.0\n1,0,0.01\n2,2,0.03\n3,3,0.04\n"


def test_ply_has_the_fields_of_the_frame(run, frames, tmp_path):
    out = export(run, tmp_path / "ply", "ply")
    frame, read = frames[-1], read_frame(out / "frame_000003.ply")
    of = drawn(frame)
    np.testing.assert_array_equal(read.vertices, frame.vertices[of])
    np.testing.assert_array_equal(of[read.triangles], frame.triangles)
    np.testing.assert_array_equal(of[read.edges], frame.edges)
    for name in ("body", "gap_rel", "load_N"):
        np.testing.assert_array_equal(read.of_vertices[name], frame.of_vertices[name][of])
    np.testing.assert_array_equal(read.of_triangles["stretch"], frame.of_triangles["stretch"])
    header = (out / "frame_000003.ply").read_bytes().partition(b"end_header\n")[0].decode().splitlines()
    assert header[:3] == ["ply", "format binary_little_endian 1.0", "element vertex 66"] and "element edge 3" in header
    assert b"element edge" not in (out / "obstacles_000003.ply").read_bytes()  # some readers know no edges
    assert np.isnan(read_frame(out / "frame_000000.ply").of_vertices["gap_rel"]).all()


def test_pc2_by_hand(run, frames, tmp_path):
    out = export(run, tmp_path / "pc2", "pc2")
    data = (out / "frame.pc2").read_bytes()
    assert data[:32] == b"POINTCACHE2\0" + bytes([1, 0, 0, 0, 66, 0, 0, 0]) + bytes(4) + bytes([0, 0, 128, 63]) + bytes([4, 0, 0, 0])
    assert len(data) == 32 + 4 * 66 * 12
    for k, frame in enumerate(frames):
        of = drawn(frame)
        for number in (0, 41, 65):
            assert struct.unpack_from("<3f", data, 32 + (k * 66 + number) * 12) == tuple(np.float32(frame.vertices[of[number]]))
    points = [line for line in (out / "frame.obj").read_text().splitlines() if line.startswith("v ")]
    assert len(points) == 66 and [float(w) for w in points[41].split()[1:]] == frames[0].vertices[drawn(frames[0])[41]].tolist()
    assert {p.name for p in out.iterdir()} == {"frame.pc2", "frame.obj", "obstacles.pc2", "obstacles.obj", "times.csv"}


def test_vtu_and_pvd_through_other_readers(run, frames, tmp_path):
    out = export(run, tmp_path / "vtu", "vtu")
    parts = ElementTree.parse(out / "frames.pvd").getroot().findall("Collection/DataSet")
    assert [(p.get("timestep"), p.get("part"), p.get("file")) for p in parts[:3]] == [
        ("0.0", "0", "frame_000000.vtu"), ("0.0", "1", "obstacles_000000.vtu"), ("0.01", "0", "frame_000001.vtu")]
    assert len(parts) == 8 and all((out / p.get("file")).is_file() for p in parts)
    for k in (0, 3):
        read, frame = meshio.read(out / f"frame_{k:06}.vtu"), frames[k]
        of = drawn(frame)
        np.testing.assert_array_equal(read.points, frame.vertices[of])
        np.testing.assert_array_equal(of[read.cells_dict["triangle"]], frame.triangles)
        np.testing.assert_array_equal(of[read.cells_dict["line"]], frame.edges)
        np.testing.assert_array_equal(read.point_data["body"], frame.of_vertices["body"][of])
        np.testing.assert_array_equal(read.point_data["gap_rel"], frame.of_vertices["gap_rel"][of] if k else np.full(66, np.nan))
        np.testing.assert_array_equal(read.cell_data_dict["body"]["line"], [1, 1, 1])


def test_obstacles_are_where_they_are_then(run, frames, tmp_path):
    out = export(run, tmp_path / "obj", "obj")
    heights = []
    for k in range(4):
        lines = [line.split() for line in (out / f"obstacles_{k:06}.obj").read_text().splitlines()]
        points = np.array([[float(w) for w in line[1:]] for line in lines if line[0] == "v"])
        assert [line[1] for line in lines if line[0] == "o"] == ["ball", "floor"]
        np.testing.assert_allclose(np.linalg.norm(points[:-4], axis=1), 0.1, atol=1e-12)
        heights.append(points[-4:, 2])
    np.testing.assert_allclose(np.array(heights), -0.3 + 0.5 * np.array([[0], [0.01], [0.03], [0.04]]) + np.zeros((4, 4)), atol=1e-9)


def test_what_stands_is_one_file(run, tmp_path):
    sequence = formats.Sequence("obstacles", formats.Mesh(["a"], np.zeros(3, int), np.zeros(1, int), np.array([[0, 1, 2]]), np.zeros((0, 2), int)), False, [-1], [0.0],
                                lambda: iter([formats.State(np.eye(3), {}, {})]))
    for kind in formats.WRITERS:
        (tmp_path / kind).mkdir()
        formats.WRITERS[kind](sequence, tmp_path / kind)
        assert [p.name for p in (tmp_path / kind).iterdir()] == [f"obstacles.{'obj' if kind == 'pc2' else kind}"]


# --- finer


def test_a_render_mesh_takes_the_place_of_its_body(run, frames, tmp_path, capsys):
    x, triangles = frames[0].vertices[:36], frames[0].triangles[:50]
    middles = x[triangles].mean(axis=1) + [0, 0, 0.001]
    corners = np.concatenate([np.stack([triangles[:, k], triangles[:, (k + 1) % 3], 36 + np.arange(50)], 1) for k in range(3)])
    meshio.Mesh(np.concatenate([x, middles]), [("triangle", corners)]).write(tmp_path / "fine.obj")
    (tmp_path / "made").mkdir()
    capsys.readouterr()
    out = export(run, tmp_path / "made/ply", "ply", "--render-mesh", str(tmp_path / "fine.obj"), "--body", "cloth")
    said = capsys.readouterr().out
    assert "86 vertices and 150 triangles bound to cloth" in said and "largest distance 0.001 m" in said
    read, frame = read_frame(out / "frame_000003.ply"), frames[3]
    assert len(read.vertices) == 86 + 4 + 26 and len(read.edges) == 3
    np.testing.assert_allclose(read.vertices[:36], frame.vertices[:36], atol=1e-12)
    a, b, c = frame.vertices[triangles].transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    np.testing.assert_allclose(read.vertices[36:86], (a + b + c) / 3 + 0.001 * normal / np.linalg.norm(normal, axis=1)[:, None], atol=1e-9)
    np.testing.assert_allclose(read.of_vertices["gap_rel"][36:86], frame.of_vertices["gap_rel"][triangles].mean(axis=1), atol=1e-6)


def test_all_bodies_or_one_are_subdivided(run, tmp_path):
    for k, (words, count) in enumerate([((), 4 * 98), (("--body", "cloth"), 4 * 50 + 48), (("--smooth",), 4 * 98)]):
        (tmp_path / str(k)).mkdir()
        read = read_frame(export(run, tmp_path / f"{k}/ply", "ply", "--subdivide", "1", *words) / "frame_000000.ply")
        assert len(read.triangles) == count and len(read.edges) == 3


@pytest.mark.parametrize("words, said", [
    (["--format", "fbx"], "fbx"),
    (["--format", "obj", "--render-mesh", "fine.obj"], "--body"),
    (["--format", "obj", "--body", "cloth"], "--body: nothing is drawn finer"),
    (["--format", "obj", "--smooth"], "--smooth: nothing is drawn finer"),
    (["--format", "obj", "--subdivide", "9"], "from 1 to 6"),
    (["--format", "obj", "--subdivide", "1", "--body", "cloht"], "'cloht'; allowed: cloth, rod, block"),
    (["--format", "obj", "--subdivide", "1", "--body", "rod"], "rod has no triangles"),
    (["--format", "obj", "--subdivide", "1", "--reach", "1"], "--reach"),
    (["--format", "obj", "--render-mesh", "none.obj", "--body", "cloth"], "none.obj: found No such file"),
    (["--format", "obj", "--render-mesh", "pytest.ini", "--body", "cloth"], 'extension ".ini"; allowed: one of .obj, .ply'),
])
def test_wrong_words_are_refused_by_name(run, tmp_path, capsys, words, said):
    assert verb.main([str(run), str(tmp_path / "out"), *words]) == 2
    assert said in capsys.readouterr().err and list(tmp_path.iterdir()) == []


def test_a_vertex_far_from_the_surface_is_named(run, frames, tmp_path, capsys):
    x = np.concatenate([frames[0].vertices[:36], [[0.03, 0.01, 0.156]]])
    meshio.Mesh(x, [("triangle", np.concatenate([frames[0].triangles[:50], [[0, 1, 36]]]))]).write(tmp_path / "fine.ply")
    words = [str(run), str(tmp_path / "out"), "--format", "obj", "--render-mesh", str(tmp_path / "fine.ply"), "--body", "cloth"]
    assert verb.main(words) == 2
    assert f"vertex 36 is 0.05 m from the surface of cloth at the start; allowed: {0.05 * 0.4 * 2**0.5:.6g} m" in capsys.readouterr().err
    assert verb.main([*words, "--reach", "0.06"]) == 0


def test_a_frame_of_the_program_is_a_render_mesh(run, frames, tmp_path, capsys):
    assert verb.main([str(run), str(tmp_path / "out"), "--format", "obj", "--render-mesh", str(run / "frames/start.ply"), "--body", "block", "--reach", "9"]) == 0
    assert f"{len(frames[0].vertices)} vertices and 98 triangles bound to block" in capsys.readouterr().out


def test_what_is_there_stays_and_a_run_without_frames_is_none(run, tmp_path, capsys):
    (tmp_path / "out").mkdir()
    assert verb.main([str(run), str(tmp_path / "out"), "--format", "obj"]) == 2
    assert "out: there already" in capsys.readouterr().err and list((tmp_path / "out").iterdir()) == []
    assert verb.main([str(tmp_path), str(tmp_path / "new"), "--format", "obj"]) == 2
    assert "no run.json" in capsys.readouterr().err
    record = json.loads((run / "run.json").read_text())
    (tmp_path / "run.json").write_text(json.dumps(record | {"artifacts": []}))
    assert verb.main([str(tmp_path), str(tmp_path / "new"), "--format", "obj"]) == 2
    assert "names no frames" in capsys.readouterr().err and not (tmp_path / "new").exists()


def test_a_writer_that_fails_leaves_nothing(run, tmp_path, monkeypatch, capsys):
    def full(sequence, folder):
        (folder / "half.obj").write_text("v 0")
        raise OSError(28, "No space left on device")

    monkeypatch.setitem(formats.WRITERS, "obj", full)
    assert verb.main([str(run), str(tmp_path / "out"), "--format", "obj"]) == 75
    assert f"{tmp_path}/out: No space left on device" in capsys.readouterr().err and list(tmp_path.iterdir()) == []
