"""`bench judge`: one fall in every format with the same answer, numbers with a closed form, and what is refused."""

import json
import struct

import meshio
import numpy as np
import pytest

from barrierbench_analysis.studies.judge.verdict import meaning
from barrierbench_analysis.studies.judge import verb
from barrierbench_analysis.program.mesh_arrays import SUFFIXES

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
CUBE_TRIANGLES = [[0, 1, 3], [4, 6, 7], [0, 4, 5], [2, 3, 7], [0, 2, 6], [1, 5, 7], [0, 3, 2], [4, 7, 5], [0, 5, 1], [2, 7, 6], [0, 6, 4], [1, 7, 3]]
LEAF = np.array([[0.3, 0.31, 0], [0.5, 0.33, 0], [0.41, 0.6, 0]])
TRIANGLES = np.array([*CUBE_TRIANGLES, [8, 9, 10]])


def fall(heights):
    """Frames of a cube and of a leaf at these heights."""
    return [np.vstack([CUBE, LEAF + [0, 0, z]]) for z in heights]


CLEAN, INTO = fall([3, 2.5, 1.25]), fall([2, 1.5, 0.5])


def write_obj(path, x):
    lines = ["v %.17g %.17g %.17g" % tuple(p) for p in x] + ["f %d//1 %d//2 %d" % tuple(t) for t in (TRIANGLES + 1).tolist()]
    path.write_text("\n".join(lines) + "\n")


def write_mesh(path, x):
    meshio.write(str(path), meshio.Mesh(x, [("triangle", TRIANGLES)]), **({"binary": True} if path.suffix == ".vtu" else {}))


def written(folder, kind, frames):
    """The path of the same frames in a format, and more arguments."""
    folder.mkdir()
    if kind in ("obj", "ply", "vtu", "pvd"):
        suffix = "vtu" if kind == "pvd" else kind
        for k, x in enumerate(frames):
            (write_obj if kind == "obj" else write_mesh)(folder / f"frame_{5 * k:03}.{suffix}", x)
        if kind != "pvd":
            return folder, []
        sets = "".join(f'<DataSet timestep="{0.1 * k}" file="frame_{5 * k:03}.vtu"/>' for k in range(len(frames)))
        (folder / "all.pvd").write_text(f'<VTKFile type="Collection"><Collection>{sets}</Collection></VTKFile>')
        return folder / "all.pvd", []
    if kind == "npz":
        np.savez(folder / "all.npz", positions=np.array(frames), triangles=TRIANGLES, times_s=0.1 * np.arange(len(frames)))
        return folder / "all.npz", []
    header = struct.pack("<12siiffi", b"POINTCACHE2\0", 1, 11, 0.0, 1.0, len(frames))
    (folder / "all.pc2").write_bytes(header + np.array(frames, "<f4").tobytes())
    write_obj(folder / "start.obj", frames[0])
    return folder / "all.pc2", ["--topology", str(folder / "start.obj")]


def judge(tmp_path, path, *words):
    """Exit code and record."""
    out = tmp_path / "judgement"
    code = verb.main([str(path), *map(str, words), "--out", str(out)])
    file = out / "judgement.json"
    return code, json.loads(file.read_text()) if file.exists() else None


def about(tmp_path, **keys):
    path = tmp_path / "about.json"
    path.write_text(json.dumps({"schema": "barrierbench.judge/1", **keys}))
    return ["--about", str(path)]


@pytest.mark.parametrize("kind", ["obj", "ply", "vtu", "pvd", "npz", "pc2"])
def test_every_format_has_the_same_answer(program, tmp_path, kind):
    path, more = written(tmp_path / "clean", kind, CLEAN)
    code, record = judge(tmp_path, path, *more)
    assert (code, record["verdict"]) == (0, "clean")
    assert record["total"]["frames"] == 3 and record["total"]["judged"] > 0 and record["findings"] == []
    assert record["total"]["closed_bodies"] == ["part 0"]
    path, more = written(tmp_path / "into", kind, INTO)
    code, record = judge(tmp_path, path, *more)
    assert (code, record["verdict"]) == (1, "penetrates")
    rows = {row["what"]: row for row in record["findings"]}
    assert rows["changed sides"]["count"] == 3 and rows["changed sides"]["pair"] == "vertex part 1[0] is on the other side of part 0"
    assert rows["changed sides"]["depth_m"] == pytest.approx(0.4, abs=1e-7)
    assert "penetrates" in (tmp_path / "judgement" / "judgement.html").read_text()


def test_what_only_the_straight_line_shows_is_said_apart(program, tmp_path):
    path, _ = written(tmp_path / "through", "npz", fall([2, -1]))
    code, record = judge(tmp_path, path)
    assert (code, record["verdict"]) == (1, "passes_between_frames")
    assert record["total"]["crossings"] == 0 and record["total"]["passages"] > 0
    code, record = judge(tmp_path, path, "--states-only")
    assert (code, record["verdict"], record["findings"]) == (0, "clean", [])
    assert "what happens between frames was not judged" in meaning(record) and "straight line" not in meaning(record)


def test_numbers_that_are_none_are_a_verdict(program, tmp_path):
    frames = [x.copy() for x in CLEAN]
    frames[1][9, 2] = np.nan
    code, record = judge(tmp_path, written(tmp_path / "nan", "npz", frames)[0])
    assert (code, record["verdict"]) == (1, "not_finite")
    assert record["findings"][0]["frame"] == "frame 1"


def test_obstacles_thickness_and_given_parts_come_from_the_file(program, tmp_path):
    path, _ = written(tmp_path / "clean", "npz", CLEAN)
    plane = {"kind": "plane", "name": "ceiling", "point_m": [0, 0, 2.75], "axis": [0, 0, -1]}
    code, record = judge(tmp_path, path, *about(tmp_path, obstacles=[plane]))
    assert (code, record["verdict"]) == (1, "penetrates")
    first = record["findings"][0]
    assert (first["count"], first["pair"]) == (3, "vertex part 1[0] is on the wrong side of obstacle ceiling")
    assert first["depth_m"] == pytest.approx(0.25)
    code, record = judge(tmp_path, path, *about(tmp_path, bodies=[{"name": "box", "vertices": 8}, {"name": "leaf", "vertices": 3}], thickness_m={"leaf": 0.1}), "--reach", "0.5")
    assert code == 0 and record["trajectory"]["bodies"] == ["box", "leaf"]
    assert record["frames"][2]["gap_between_m"] == pytest.approx(0.25 - 0.05)
    into, _ = written(tmp_path / "into", "npz", fall([1.25, 0.9]))
    crossed = fall([1.25, 1.25])
    crossed[1][10, 2] = 0.9
    into, _ = written(tmp_path / "crossed", "npz", crossed)
    code, record = judge(tmp_path, into, *about(tmp_path, given=["part 0", "part 1"]))
    assert record["total"]["crossings"] == 0 and record["total"]["given_faults"] > 0 and code == 1


def test_physics_has_its_closed_form(program, tmp_path):
    g, dt = 9.81, 0.1
    frames = fall([3 - 0.5 * g * (k * dt) ** 2 for k in range(4)])
    path, _ = written(tmp_path / "fall", "npz", frames)
    code, record = judge(tmp_path, path, *about(tmp_path, density={"part 1": 2.0}, gravity_m_s2=[0, 0, -g], dt_s=dt))
    assert code == 0
    mass = 2.0 * np.linalg.norm(np.cross(LEAF[1] - LEAF[0], LEAF[2] - LEAF[0])) / 2
    for k, frame in enumerate(record["frames"]):
        assert frame["stretch_max"] == pytest.approx(1) and frame["stretch_min"] == pytest.approx(1)
        assert frame["volume_rel"] == {"part 0": pytest.approx(1)}
        assert frame["gravity_J"] == pytest.approx(mass * g * frames[k][8, 2])
        if k > 0:
            speed = g * dt * (k - 0.5)
            assert frame["momentum_kg_m_s"] == pytest.approx([0, 0, -mass * speed])
            assert frame["kinetic_J"] == pytest.approx(0.5 * mass * speed**2)
    frames[2][8:, 0] = 0.3 + 2 * (frames[2][8:, 0] - 0.3)
    stretched, _ = written(tmp_path / "stretched", "npz", frames)
    _, record = judge(tmp_path, stretched)
    assert 1.5 < record["frames"][2]["stretch_max"] <= 2 + 1e-12


def test_volume_and_inversion_of_a_solid(program, tmp_path):
    tet = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    frames = [tet, tet * [1, 1, 0.5], tet * [1, 1, -0.25]]
    np.savez(tmp_path / "tet.npz", positions=np.array(frames), tetrahedra=np.array([[0, 1, 2, 3]]))
    _, record = judge(tmp_path, tmp_path / "tet.npz")
    assert record["total"]["triangles"] == 4 and record["total"]["closed_bodies"] == ["surface"]
    assert [f["volume_rel"]["surface"] for f in record["frames"]] == pytest.approx([1, 0.5, -0.25])
    assert [f["tetrahedra_inverted"] for f in record["frames"]] == [0, 0, 1]


def test_distance_from_a_reference(program, tmp_path):
    path, _ = written(tmp_path / "a", "npz", CLEAN)
    other, _ = written(tmp_path / "b", "obj", fall([3, 2.5, 1.5]))
    _, record = judge(tmp_path, path, "--reference", other)
    assert [f["apart_max_m"] for f in record["frames"]] == pytest.approx([0, 0, 0.25])
    assert record["frames"][2]["apart_rms_m"] == pytest.approx(0.25 * np.sqrt(3 / 11))


def test_millimetres_are_asked_about(program, tmp_path):
    path, _ = written(tmp_path / "mm", "npz", [1000 * x for x in CLEAN])
    _, record = judge(tmp_path, path)
    assert any("--scale 0.001" in note for note in record["notes"])
    _, record = judge(tmp_path, path, "--scale", "0.001")
    assert record["notes"] == [] and record["frames"][2]["gap_between_m"] is None or record["frames"][0]["gap_between_m"] is None


def test_quads_are_cut_and_said(program, tmp_path):
    (tmp_path / "q.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 -1\n")
    code, record = judge(tmp_path, tmp_path / "q.obj")
    assert code == 0 and record["total"]["triangles"] == 2
    assert any("1 polygons" in note for note in record["notes"])


def test_a_run_of_this_program_is_judged_by_its_own_names(program, tmp_path):
    import subprocess

    from tests.falling_cloth import CLOTH_ON_BALL

    config = {**CLOTH_ON_BALL, "time": {"dt_s": 0.01, "steps": 4}, "output": {"frames_every": 1}}
    (tmp_path / "config.json").write_text(json.dumps(config))
    done = subprocess.run([program, "run", tmp_path / "config.json", "--out", tmp_path / "run"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    code, record = judge(tmp_path, tmp_path / "run")
    assert code == 0, record["findings"]
    assert record["total"]["obstacles"] == 1 and record["total"]["obstacle_queries"] > 0
    assert len(record["trajectory"]["times_s"]) == record["total"]["frames"] == 5


REFUSED = {
    "no such file": lambda f: [f / "nothing.npz"],
    "found none of them": lambda f: [f],
    "found .obj, .ply": lambda f: [(f / "a.obj").write_text("x") and (f / "b.ply").write_text("x") and f],
    "no frame between f_1.obj and f_3.obj": lambda f: [[write_obj(f / f"f_{k}.obj", CLEAN[0]) for k in (0, 1, 3)] and f],
    "faces are others": lambda f: [[write_obj(f / f"f_{k}.obj", CLEAN[0]) for k in (0, 1)] and (f / "f_1.obj").write_text((f / "f_0.obj").read_text().replace("f 9//1 10//2 11", "f 9//1 11//2 10")) and f],
    "the first frame has 11": lambda f: [[write_obj(f / f"f_{k}.obj", CLEAN[0]) for k in (0, 1)] and (f / "f_1.obj").write_text("v 0 0 0\n") and f],
    "no triangle, rod": lambda f: [np.savez(f / "x.npz", positions=np.zeros((1, 3, 3))) or f / "x.npz"],
    "floats [frames, vertices, 3]": lambda f: [np.savez(f / "x.npz", positions=np.zeros((3, 3))) or f / "x.npz"],
    "different numbers from 0 to 2": lambda f: [np.savez(f / "x.npz", positions=np.zeros((1, 3, 3)), triangles=np.array([[0, 1, 3]])) or f / "x.npz"],
    "not a PC2 file": lambda f: [(f / "x.pc2").write_bytes(b"no") and f / "x.pc2"],
    "x.obj:2: found 3 words": lambda f: [(f / "x.obj").write_text("v 0 0 0\nv 1 1\n") and f / "x.obj"],
    "#/obstacles/0/kind": lambda f: [written(f / "a", "npz", CLEAN)[0], *about(f, obstacles=[{"kind": "torus"}])],
    "#/given/0": lambda f: [written(f / "a", "npz", CLEAN)[0], *about(f, given=["part 7"])],
    "a sum of 11 vertices": lambda f: [written(f / "a", "npz", CLEAN)[0], *about(f, bodies=[{"name": "x", "vertices": 3}])],
    "needs times of the frames": lambda f: [written(f / "a", "obj", CLEAN)[0], *about(f, density={"part 1": 1})],
    "frames; the trajectory has 3": lambda f: [written(f / "a", "npz", CLEAN)[0], "--reference", written(f / "b", "npz", CLEAN[:2])[0]],
    "--scale: found '0'": lambda f: [written(f / "a", "npz", CLEAN)[0], "--scale", "0"],
}


@pytest.mark.parametrize("words", REFUSED)
def test_what_cannot_be_judged_is_refused_and_leaves_nothing(program, tmp_path, capsys, words):
    folder = tmp_path / "in"
    folder.mkdir()
    code, record = judge(tmp_path, *REFUSED[words](folder))
    assert (code, record) == (2, None)
    assert words in capsys.readouterr().err


def test_every_format_of_frames_is_tested():
    assert set(SUFFIXES) == {".obj", ".ply", ".stl", ".vtu", ".vtp", ".vtk", ".msh"}  # the rest: test_judge_files.py
