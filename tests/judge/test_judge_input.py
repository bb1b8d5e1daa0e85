"""`bench judge`: parts of one time, folders of PC2, times, numbers beyond double, faults of files by file and place."""

import json
import subprocess
from pathlib import Path

import meshio
import numpy as np
import pytest

from barrierbench_analysis.figures.frames_out.verb import main as write_frames
from barrierbench_analysis.studies.judge import verb
from tests.judge.test_judge_verb import CLEAN, INTO, about, judge, write_obj, written

FLOOR = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
SPEAR = np.array([[0.2, 0.2, 1], [0.3, 0.2, -1], [0.2, 0.3, -1]])  # passes through FLOOR


def write_parts(folder, heights, order=None, drop=(), times=None):
    """A collection of the floor, part 0, and the spear, part 1, above its crossing place."""
    lines = []
    for k, z in enumerate(heights):
        for part, x in ((0, FLOOR), (1, SPEAR + [0, 0, z])):
            meshio.write(str(folder / f"f_{k}_{part}.vtu"), meshio.Mesh(x, [("triangle", [[0, 1, 2]])]))
            if (k, part) not in drop:
                lines.append(f'<DataSet timestep="{k if times is None else times[k]}" part="{part}" file="f_{k}_{part}.vtu"/>')
    lines = [lines[k] for k in order] if order else lines
    (folder / "all.pvd").write_text(f'<VTKFile type="Collection"><Collection>{"".join(lines)}</Collection></VTKFile>')
    return folder / "all.pvd"


@pytest.mark.parametrize("order", [[0, 1, 2, 3], [1, 0, 3, 2], [0, 2, 1, 3]])
def test_parts_of_one_time_are_one_frame(program, tmp_path, order):
    path = write_parts(tmp_path, [5, 0], order)
    for given in (path, tmp_path):  # and the folder goes by its collection
        code, record = judge(tmp_path, given, "--states-only")
        assert (code, record["verdict"]) == (1, "penetrates")
        assert record["total"]["frames"] == 2 and record["total"]["vertices"] == 6 and record["trajectory"]["times_s"] == [0, 1]
        row = record["findings"][0]
        assert row["frame"] == "f_1_0.vtu and 1 more" and "part 0" in row["pair"] and "part 1" in row["pair"]


@pytest.mark.parametrize("kind", ["obj", "ply", "vtu", "pc2"])
def test_what_bench_frames_writes_is_judged(program, tmp_path, kind):
    run, out = tmp_path / "run", tmp_path / "frames"
    stack = Path(__file__).parents[2] / "configs/scenes/stack.json"
    words = ["run", stack, "--out", run, "--set", "/time/steps=4", "--set", "/output/frames_every=1", "--progress", "none"]
    subprocess.run([program, *map(str, words)], check=True, capture_output=True)
    assert write_frames([str(run), str(out), "--format", kind]) == 0
    code, record = judge(tmp_path, out)
    assert code == 0 and record["total"]["frames"] == 5 and record["total"]["triangles"] == 4


@pytest.mark.parametrize("kind", ["obj", "ply", "vtu"])
def test_moving_obstacles_beside_frames_are_no_frames_either(program, tmp_path, kind):
    """One mesh a frame, with the frame's number."""
    folder, _ = written(tmp_path / "a", kind, CLEAN)
    for number in range(3):
        (folder / f"obstacles_{number:06d}.{kind}").write_text("never opened")
    code, record = judge(tmp_path, folder)
    assert code == 0 and record["total"]["frames"] == 3
    assert any(f"obstacles_000002.{kind} is no frame" in note for note in record["notes"])


@pytest.mark.parametrize("kind", ["obj", "ply", "vtu"])
def test_obstacles_beside_frames_are_no_frame_and_named(program, tmp_path, kind):
    """As `bench data frames` writes them."""
    folder, _ = written(tmp_path / "a", kind, CLEAN)
    (folder / f"obstacles.{kind}").write_text("never opened")
    code, record = judge(tmp_path, folder)
    assert code == 0 and record["total"]["frames"] == 3
    assert any(f"obstacles.{kind} is no frame" in note for note in record["notes"])


def test_a_folder_of_pc2_is_judged_by_it_and_not_by_its_mesh(program, tmp_path):
    pc2, _ = written(tmp_path / "a", "pc2", INTO)
    (tmp_path / "a" / "start.obj").rename(tmp_path / "a" / "all.obj")
    code, record = judge(tmp_path, pc2.parent)
    assert (code, record["verdict"]) == (1, "penetrates")
    assert record["total"]["frames"] == 3 and record["trajectory"]["format"] == "pc2"


def test_uppercase_suffixes_are_frames(program, tmp_path):
    for k, x in enumerate(INTO):
        write_obj(tmp_path / f"F_{k}.OBJ", x)
    code, record = judge(tmp_path, tmp_path)
    assert (code, record["total"]["frames"]) == (1, 3)


def npz(path, frames, **arrays):
    np.savez(path, positions=np.array(frames), triangles=np.array([[0, 1, 2], [3, 4, 5]]), **arrays)
    return path


@pytest.mark.parametrize("scale", [1e60, 1e150, 1e200, 1e300])
def test_the_verdict_is_kept_where_physics_overflows(program, tmp_path, capfd, scale):
    x = np.vstack([FLOOR, SPEAR]) * scale
    keys = about(tmp_path, density={"part 0": 1.0}, gravity_m_s2=[0, 0, -9.81], dt_s=0.1)
    code, record = judge(tmp_path, npz(tmp_path / "x.npz", [x, x]), *keys)
    assert (code, record["verdict"]) == (1, "penetrates")
    assert "Warning" not in capfd.readouterr().err
    if scale >= 1e200:
        last = record["frames"][1]
        assert last["stretch_max"] is None and last["gravity_J"] is None and last["kinetic_J"] is None


def test_a_solid_whose_volume_overflows_is_not_called_sound(program, tmp_path):
    tet = 1e200 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, -1.0]])
    np.savez(tmp_path / "tet.npz", positions=np.array([tet, tet]), tetrahedra=np.array([[0, 1, 2, 3]]))
    _, record = judge(tmp_path, tmp_path / "tet.npz")
    assert record["frames"][1]["tetrahedra_inverted"] is None and record["frames"][1]["volume_rel"] == {"surface": None}


def test_a_first_frame_that_is_not_finite_has_its_verdict(program, tmp_path):
    frames = [x.copy() for x in CLEAN]
    frames[0][9, 2] = np.nan
    path, _ = written(tmp_path / "nan", "npz", frames)
    code, record = judge(tmp_path, path, *about(tmp_path, density={"part 1": 2.0}), "--reference", path)
    assert (code, record["verdict"]) == (1, "not_finite")
    assert record["frames"][0]["apart_max_m"] is None and record["frames"][2]["apart_max_m"] == 0
    assert record["frames"][2]["gravity_J"] is None and record["frames"][2]["stretch_max"] is None


def test_a_reference_that_is_not_finite_has_no_distance(program, tmp_path):
    broken = [x.copy() for x in CLEAN]
    broken[1][0, 0] = np.inf
    path, other = written(tmp_path / "a", "npz", CLEAN)[0], written(tmp_path / "b", "npz", broken)[0]
    code, record = judge(tmp_path, path, "--reference", other)
    assert code == 0 and [f["apart_rms_m"] for f in record["frames"]] == [0, None, 0]
    assert any("1 frames of the reference" in note for note in record["notes"])


def test_the_topology_is_not_asked_of_a_reference(program, tmp_path):
    path, more = written(tmp_path / "a", "pc2", CLEAN)
    other, _ = written(tmp_path / "b", "obj", CLEAN)
    code, _ = judge(tmp_path, path, *more, "--reference", other)
    assert code == 0


def test_what_is_in_the_way_of_the_answer_is_said_before_the_audit(program, tmp_path, monkeypatch, capsys):
    path, _ = written(tmp_path / "a", "npz", CLEAN)
    monkeypatch.setattr(verb, "audited", lambda *_: pytest.fail("the audit ran"))
    (tmp_path / "taken").write_text("")
    (tmp_path / "folder" / "judgement.html").mkdir(parents=True)
    for out, words in (("taken", "taken: "), ("taken/below", "taken/below: "), ("folder", "judgement.html: is a folder")):
        assert verb.main([str(path), "--out", str(tmp_path / out)]) == 2
        assert words in capsys.readouterr().err


def cut_off(path, length):
    path.write_bytes(path.read_bytes()[:length])
    return path


def a(f):
    return written(f / "a", "npz", CLEAN)[0]


def with_times(f, times):
    return [npz(f / "x.npz", [np.vstack([FLOOR, SPEAR])] * 3, times_s=np.array(times))]


def with_about(f, **keys):
    return [a(f), *about(f, **keys)]


def twice(f):
    (f / "about.json").write_text('{"schema": "barrierbench.judge/1", "planar": false, "planar": true}')
    return [a(f), "--about", f / "about.json"]


def pc2_folder(f, *more):
    path, _ = written(f / "a", "pc2", CLEAN)
    for name in more:
        (f / "a" / name).write_text("")
    return [path.parent]


def broken_vtu(f):
    (f / "x.vtu").write_text("<VTKFile>")
    return [f / "x.vtu"]


ABOUT = "in/about.json#/"
REFUSED = {
    "DataSet 2 (part 0, file 'f_1_0.vtu'): found the time 0.0 s after 1.0": lambda f: [write_parts(f, [5, 5], times=[1, 0])],
    "DataSet 1 (part 0, file 'f_1_0.vtu'): found the time 0.0 s after 0.0": lambda f: [write_parts(f, [5, 5], times=[0, 0], drop=[(0, 1), (1, 1)])],
    "found the time nan": lambda f: [write_parts(f, [5, 5], times=["nan", 1])],
    "found the timestep 'soon'": lambda f: [write_parts(f, [5], times=["soon"])],
    "part 1 has no file at 1.0, part 0 has": lambda f: [write_parts(f, [5, 5], drop=[(1, 1)])],
    "all.pc2, start.obj; one .pc2 and one mesh of its name are needed, or say which: ./bench judge": lambda f: pc2_folder(f),
    "obstacles.pc2": lambda f: pc2_folder(f, "obstacles.pc2"),
    "x.npz: `times_s`[2]: found the time 0.5 s after 1.0": lambda f: with_times(f, [0, 1, 0.5]),
    "x.npz: `times_s`[1]: found the time inf": lambda f: with_times(f, [0, np.inf, 2]),
    "x.npz: `times_s` of shape (3,) and type <U1": lambda f: with_times(f, ["a", "b", "c"]),
    "x.npz: `times_s` of shape (2,)": lambda f: with_times(f, [0, 1]),
    "all.npz: not an NPZ file: BadZipFile": lambda f: [cut_off(a(f), 500)],
    "all.npz: not an NPZ file: EOFError": lambda f: [cut_off(a(f), 0)],
    "b/all.npz: not an NPZ file": lambda f: [a(f), "--reference", cut_off(written(f / "b", "npz", CLEAN)[0], 500)],
    "have cells of their own": lambda f: [a(f), "--topology", f / "nothing.obj"],
    "a have cells of their own": lambda f: [written(f / "a", "obj", CLEAN)[0], "--topology", f / "a" / "frame_000.obj"],
    "nothing.obj: found No such file": lambda f: [written(f / "a", "pc2", CLEAN)[0], "--topology", f / "nothing.obj"],
    "argument --weld: found '-1'; allowed: a number from 0": lambda f: [a(f), "--weld", "-1"],
    f"{ABOUT}obstacles/0/axis: found [0, 0, 0]; a direction, a vector that is not zero, is needed": lambda f: with_about(f, obstacles=[{"kind": "plane", "axis": [0, 0, 0]}]),
    f"{ABOUT}bodies: found \"the cell [6, 7, 8] of `triangles` (one of 1) with vertices of 'left' and of 'right'\"": lambda f: with_about(
        f, triangles=[[6, 7, 8]], bodies=[{"name": "left", "vertices": 8}, {"name": "right", "vertices": 3}]),
    f"{ABOUT}bodies: found \"the cell [2, 8] of `segments`": lambda f: with_about(
        f, segments=[[2, 8]], bodies=[{"name": "left", "vertices": 8}, {"name": "right", "vertices": 3}]),
    f"{ABOUT}obstacles/0/radius_m: is missing": lambda f: with_about(f, obstacles=[{"kind": "sphere"}]),
    f"{ABOUT}obstacles/0/point_m/0: found 1e+60": lambda f: with_about(f, obstacles=[{"kind": "plane", "point_m": [1e60, 0, 0]}]),
    f"{ABOUT}obstacles/0/radius_m: found 1e+16": lambda f: with_about(f, obstacles=[{"kind": "sphere", "radius_m": 1e16}]),
    f"{ABOUT}segments/1: found [0, 99]": lambda f: with_about(f, segments=[[0, 1], [0, 99]]),
    f"{ABOUT}triangles/0: found [0, 1, 1]": lambda f: with_about(f, triangles=[[0, 1, 1]]),
    f"{ABOUT}given_vertices/1: found 1000000000000000000000": lambda f: with_about(f, given_vertices=[0, 10**21]),
    f"{ABOUT}thickness_m: found 1e+60": lambda f: with_about(f, thickness_m=1e60),
    f"{ABOUT}dt_s: found 1e+308": lambda f: with_about(f, dt_s=1e308),
    "argument --scale: found 'nan'; allowed: a number above 0": lambda f: [a(f), "--scale", "nan"],
    "argument --reach: found 'inf'; allowed: a number above 0, at most 1e+15": lambda f: [a(f), "--reach", "inf"],
    "argument --reach: found '1e16'; allowed: a number above 0, at most 1e+15": lambda f: [a(f), "--reach", "1e16"],
    "x.vtu: found Start-end tags mismatch": lambda f: broken_vtu(f),
    "the key 'planar' is given twice": twice,
    "x.obj:2: found \"99999999999999999999\"": lambda f: [(f / "x.obj").write_text("v 0 0 0\nf 1 2 99999999999999999999\n") and f / "x.obj"],
}


@pytest.mark.parametrize("size", [1e-200, 5e-324, 1e200])
def test_an_axis_of_any_size_is_a_direction(program, tmp_path, size):
    """A floor at z = -0.5, below the triangle at z = 0: the spear of the first frame is above both, that of the second goes through both."""
    path = write_parts(tmp_path, [5.2, -4])
    records = [judge(tmp_path, path, *about(tmp_path, obstacles=[{"kind": "plane", "name": "floor", "point_m": [0, 0, -0.5], "axis": axis}]))
               for axis in ([0, 0, 1], [0, 0, size])]
    [[code, along], [code_of_another, of_another]] = records
    assert code == code_of_another == 1 and any("floor" in json.dumps(row) for row in along["findings"])
    assert {**along["total"], "audit_s": 0} == {**of_another["total"], "audit_s": 0}


@pytest.mark.parametrize("words", REFUSED)
def test_a_fault_is_told_by_file_and_place(program, tmp_path, capsys, words):
    folder = tmp_path / "in"
    folder.mkdir()
    code, record = judge(tmp_path, *REFUSED[words](folder))
    message = capsys.readouterr().err
    assert (code, record) == (2, None)
    assert words in message and "barrierbench-judge-" not in message
