"""`bench data film`: a film of a config out of PC2, VTU with PVD, and a run, and what is refused."""

import json
import subprocess

import numpy as np
import pytest

from barrierbench_analysis.io.frames import frames_of
from barrierbench_analysis.figures.frames_out import film, formats, verb
from barrierbench_analysis.program.mesh_arrays import read_frame_file
from barrierbench_analysis.io.record_file import read_record
from tests.falling_cloth import CLOTH_ON_BALL

POINTS = np.random.default_rng(7).normal(size=(4, 5, 3))  # frames, vertices


@pytest.fixture(scope="module")
def run(program, tmp_path_factory):
    folder = tmp_path_factory.mktemp("film")
    (folder / "config.json").write_text(json.dumps({**CLOTH_ON_BALL, "output": {"frames_every": 1}}))
    done = subprocess.run([program, "run", folder / "config.json", "--out", folder / "out"], capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, done.stderr
    return folder / "out"


def cache(path):
    path.write_bytes(formats.pc2_header(5, 4) + POINTS.astype("<f4").tobytes())
    return path


def made(source, out, *words):
    assert film.main([str(source), str(out), *words]) == 0
    names = sorted(p.name for p in out.iterdir())
    frames = [read_frame_file(out / name) for name in names if name.endswith(".ply")]
    assert names == [*(f"frame_{k:06}.ply" for k in range(len(frames))), "times.csv"]
    times = [float(line.split(",")[2]) for line in (out / "times.csv").read_text().splitlines()[1:]]
    assert len(times) == len(frames)
    return frames, times


def refused(capsys, *words):
    assert film.main([str(word) for word in words]) == 2
    return capsys.readouterr().err


def test_a_cache_of_points_has_its_numbers_and_the_times_that_are_given(tmp_path):
    frames, times = made(cache(tmp_path / "a.pc2"), tmp_path / "out", "--frame-s", "0.25", "--scale", "0.5")
    assert times == [0.0, 0.25, 0.5, 0.75]
    for frame, points in zip(frames, POINTS, strict=True):
        np.testing.assert_array_equal(frame.points, 0.5 * points.astype("<f4").astype(float))
        assert len(frame.triangles) == 0


def test_a_body_of_a_run_becomes_the_film_of_the_same_body(program, run, tmp_path):
    frames, times = made(run, tmp_path / "cloth", "--body", "cloth")
    record = read_record(run / "run.json")
    states = list(frames_of(record, run, [-1, 0, 1, 2, 3, 4]))
    assert times == [0.0, 0.01, 0.02, 0.03, 0.04, 0.05] and len(states) == 6
    for frame, state in zip(frames, states, strict=True):
        np.testing.assert_array_equal(frame.points, state.vertices[:36])
    body = CLOTH_ON_BALL["scene"]["bodies"][0]
    first = {"file": str(tmp_path / "cloth/frame_000000.ply")}
    given = {"name": body["name"], "kind": "rigid", "mesh": first, "motion": {"film": first}}
    rod = CLOTH_ON_BALL["scene"]["bodies"][1]
    config = {**CLOTH_ON_BALL, "scene": {"bodies": [given, rod]}, "output": {"frames_every": 1}}
    (tmp_path / "c.json").write_text(json.dumps(config))
    done = subprocess.run([program, "run", tmp_path / "c.json", "--out", tmp_path / "run"], capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, done.stderr
    again = list(frames_of(read_record(tmp_path / "run/run.json"), tmp_path / "run", [-1, 0, 1, 2, 3, 4]))
    moved = np.abs(again[-1].vertices[:36] - again[0].vertices[:36]).max()
    assert moved > 0.01
    for state, other in zip(states, again, strict=True):
        np.testing.assert_allclose(other.vertices[:36], state.vertices[:36], atol=1e-15)


def test_a_collection_of_vtu_is_read_with_its_times(run, tmp_path):
    assert verb.main([str(run), str(tmp_path / "vtu"), "--format", "vtu"]) == 0
    frames, times = made(tmp_path / "vtu/frames.pvd", tmp_path / "out")
    assert times == [0.0, 0.01, 0.02, 0.03, 0.04, 0.05]
    assert len(frames[0].triangles) > 0


def test_what_is_no_film_is_said_by_name(run, tmp_path, capsys):
    pc2 = cache(tmp_path / "a.pc2")
    assert "has no times in seconds; allowed: --frame-s" in refused(capsys, pc2, tmp_path / "x")
    assert "has times of its own" in refused(capsys, run, tmp_path / "x", "--body", "cloth", "--frame-s", "1")
    assert "--body cloth, rod" in refused(capsys, run, tmp_path / "x")
    assert "found 'hat'; allowed: cloth, rod" in refused(capsys, run, tmp_path / "x", "--body", "hat")
    assert "it names none" in refused(capsys, pc2, tmp_path / "x", "--body", "hat", "--frame-s", "1")
    one = tmp_path / "one.pc2"
    one.write_bytes(formats.pc2_header(5, 1) + POINTS[:1].astype("<f4").tobytes())
    assert "1 frame; allowed: two or more" in refused(capsys, one, tmp_path / "x", "--frame-s", "1")
    bad = POINTS.copy()
    bad[2, 1, 1] = np.nan
    hole = tmp_path / "nan.pc2"
    hole.write_bytes(formats.pc2_header(5, 4) + bad.astype("<f4").tobytes())
    assert "frame 2 holds a coordinate that is not finite" in refused(capsys, hole, tmp_path / "x", "--frame-s", "1")
    assert not (tmp_path / "x").exists(), "nothing half-written is left"
    (tmp_path / "there").mkdir()
    assert "there already" in refused(capsys, pc2, tmp_path / "there", "--frame-s", "1")
    assert "number above 0" in refused(capsys, pc2, tmp_path / "x", "--frame-s", "0")
