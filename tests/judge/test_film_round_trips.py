"""USD and Alembic there and back: what `bench data frames` writes is what `bench judge` reads, to the last bit of float32."""

import json
import subprocess
import sys

import numpy as np
import pytest

from barrierbench_analysis.figures.frames_out import formats, objects, verb
from barrierbench_analysis.figures.surfaces.sequence import Mesh, Sequence, State
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.frames import frame_paths, frames_of
from barrierbench_analysis.io.record_file import read_record
from barrierbench_analysis.program.film_files import joins
from barrierbench_analysis.program.mesh_arrays import read_frame_file
from barrierbench_analysis.program.trajectories.readers import read_trajectory
from tests.falling_cloth import CLOTH_ON_BALL
from tests.judge.alembic_package import NO_WHEEL
from tests.judge.test_judge_verb import judge

ABC = pytest.param("abc", marks=pytest.mark.skipif(bool(NO_WHEEL), reason=NO_WHEEL))
KINDS = ("usd", ABC)
ROOT = {"usd": "/World/", "abc": "/"}
TIMES = [0.0, 0.1 + 0.2, 1 / 3, 1.7]  # uneven, and not the multiples of one step
POINTS = np.random.default_rng(3).normal(size=(4, 12, 3)) * [1.0, 1e-7, 1e3]
POINTS[1, 0] = [0.0, -0.0, 1e-45]  # both zeros, and the smallest number of single precision
# Points 0 to 3 a leaf, 4 to 8 a rod and a loose piece, 9 to 11 what has no cells.
MESH = Mesh(
    ["a leaf", "a.leaf", "marks"],
    np.repeat([0, 1, 2], [4, 5, 3]),
    np.array([0, 0]),
    np.array([[0, 1, 2], [2, 1, 3]]),
    np.array([[4, 5], [5, 6], [7, 8]]),
)


def sequence(moves=True, mesh=MESH, points=POINTS):
    def states():
        return (State(x, {}, {}) for x in (points if moves else points[:1]))

    times = TIMES if moves else TIMES[:1]
    return Sequence("frame" if moves else "obstacles", mesh, moves, list(range(len(times))), times, states)


@pytest.mark.parametrize("kind", KINDS)
def test_there_and_back(program, tmp_path, kind):
    formats.write([sequence()], kind, tmp_path)
    found = read_trajectory(tmp_path)  # the folder that has it
    assert found.times_s == TIMES
    names = ("a_leaf", "a_leaf_2") if kind == "usd" else ("a leaf", "a.leaf")
    assert found.topology.names == tuple(ROOT[kind] + name for name in names)
    assert found.topology.first_vertex == (0, 4)
    np.testing.assert_array_equal(found.topology.triangles, MESH.triangles)
    np.testing.assert_array_equal(found.topology.segments, MESH.edges)
    frames = list(found.frames())
    assert len(frames) == 4
    for frame, x in zip(frames, POINTS, strict=True):
        assert frame.astype("<f4").tobytes() == x[:9].astype("<f4").tobytes()  # the sign of 0 too
        np.testing.assert_array_equal(frame, x[:9].astype("<f4").astype(float))
    assert any("positions are float32" in note for note in found.notes)
    assert any("points beside what has cells" in note or "not read: /marks" in note for note in found.notes)


@pytest.mark.parametrize("kind", KINDS)
def test_points_alone_are_a_film_without_cells(program, tmp_path, kind):
    bare = Mesh(["dots"], np.zeros(12, int), np.zeros(0, int), np.zeros((0, 3), int), np.zeros((0, 2), int))
    formats.write([sequence(mesh=bare)], kind, tmp_path)
    found = read_trajectory(tmp_path / f"frame.{kind}")
    assert found.topology.n_vertices == 12 and not len(found.topology.triangles)
    np.testing.assert_array_equal(list(found.frames()), POINTS.astype("<f4").astype(float))
    cells = "".join("v %r %r %r\n" % tuple(p) for p in POINTS[0].tolist()) + "f 1 2 3\nf 4 5 6\n"
    (tmp_path / "cells.obj").write_text(cells)
    found = read_trajectory(tmp_path / f"frame.{kind}", topology=tmp_path / "cells.obj")
    assert found.topology.triangles.tolist() == [[0, 1, 2], [3, 4, 5]]


@pytest.mark.parametrize("kind", KINDS)
def test_what_stands_has_one_frame_and_no_time(program, tmp_path, kind):
    formats.write([sequence(moves=False)], kind, tmp_path)
    found = read_trajectory(tmp_path / f"obstacles.{kind}")
    assert (found.times_s, found.labels) == (None, ["at rest"])
    np.testing.assert_array_equal(next(found.frames()), POINTS[0, :9].astype("<f4").astype(float))


def test_rods_that_branch_or_close_are_several_curves():
    ring = np.array([[0, 1], [1, 2], [2, 0], [2, 3], [3, 4]])
    assert objects.curves_of(ring) == [[0, 1, 2, 0], [2, 3, 4]]
    part = objects.parts_of(Mesh(["net"], np.zeros(5, int), np.zeros(0, int), np.zeros((0, 3), int), ring))[0]
    assert (part.kind, part.numbers.tolist(), part.counts.tolist()) == ("curves", [0, 1, 2, 0, 2, 3, 4], [4, 3])


# A ring of four rods with a branch, and a leaf with a rod from one of its corners: neither can be curves without doubled points.
NET = Mesh(
    ["net", "leaf"],
    np.repeat([0, 1], [6, 4]),
    np.array([1]),
    np.array([[6, 7, 8]]),
    np.array([[0, 1], [1, 2], [2, 3], [3, 0], [2, 4], [4, 5], [8, 9]]),
)
PLACES = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 1, 0], [2, 2, 0], [5, 0, 0], [6, 0, 0], [5, 1, 0], [5, 2, 0]], float)
FALLING = np.array([PLACES + [0, 0, -0.1 * k] for k in range(4)])


@pytest.mark.parametrize("kind", KINDS)
def test_rings_branches_and_rods_on_triangles_come_back_as_they_are(program, tmp_path, kind):
    formats.write([sequence(mesh=NET, points=FALLING)], kind, tmp_path)
    found = read_trajectory(tmp_path)
    assert found.topology.names == (ROOT[kind] + "net", ROOT[kind] + "leaf") and found.topology.first_vertex == (0, 6)
    np.testing.assert_array_equal(found.topology.triangles, NET.triangles)
    assert {frozenset(e) for e in found.topology.segments.tolist()} == {frozenset(e) for e in NET.edges.tolist()}
    for frame, x in zip(found.frames(), FALLING, strict=True):
        np.testing.assert_array_equal(frame, x.astype("<f4").astype(float))
    assert len(read_frame_file(tmp_path / f"frame.{kind}").points) == 10
    assert any("4 points are joined to others" in note for note in found.notes), found.notes


@pytest.mark.parametrize("kind", ("vtu", *KINDS))
def test_a_film_with_a_ring_and_a_rod_on_a_triangle_is_clean(program, tmp_path, kind):
    (tmp_path / kind).mkdir()
    formats.write([sequence(mesh=NET, points=FALLING)], kind, tmp_path / kind)
    code, record = judge(tmp_path, tmp_path / kind)
    assert (code, record["verdict"]) == (0, "clean")


def test_points_of_one_number_in_two_places_stay_two():
    numbers = [np.array([0, 1, 2]), np.array([2, 0, 3]), None]
    x = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0]], float)
    join = joins.join_of(numbers, [x, np.array([[2, 0, 0], [9, 0, 0], [3, 0, 0]], float), x])
    assert join.kept.tolist() == [0, 1, 2, 4, 5, 6, 7, 8] and join.vertex.tolist() == [0, 1, 2, 2, 3, 4, 5, 6, 7]
    assert join.first_vertices([3, 3, 3]) == [0, 3, 5]
    assert joins.join_of([None, None], [x, x]) is None
    with pytest.raises(UserError, match=r"a.usd \(1 s\): found points 2 and 3 apart, one vertex by barrierbench_vertex"):
        join.points(np.arange(27.0).reshape(9, 3), "a.usd (1 s)")


@pytest.fixture(scope="module")
def run(program, tmp_path_factory):
    folder = tmp_path_factory.mktemp("film")
    (folder / "config.json").write_text(json.dumps({**CLOTH_ON_BALL, "output": {"frames_every": 2}}))
    done = subprocess.run([program, "run", folder / "config.json", "--out", folder / "out"], capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, done.stderr
    return folder / "out"


@pytest.mark.parametrize("kind", KINDS)
def test_a_run_is_exported_and_judged(run, tmp_path, kind):
    """Obstacles are a file of their own, which is no frame."""
    out = tmp_path / kind
    assert verb.main([str(run), str(out), "--format", kind]) == 0
    assert {p.name for p in out.iterdir()} == {f"frame.{kind}", f"obstacles.{kind}", "times.csv"}
    code, record = judge(tmp_path, out)
    assert (code, record["verdict"], record["trajectory"]["moves"]) == (0, "clean", True)
    record_of_run = read_record(run / "run.json")
    states = list(frames_of(record_of_run, run, frame_paths(record_of_run, run)))
    frames = list(read_trajectory(out).frames())
    assert len(frames) == len(states) == 4
    for frame, state in zip(frames, states, strict=True):
        np.testing.assert_array_equal(frame, state.vertices.astype("<f4").astype(float)[: len(frame)])


def test_unit_and_axis_of_a_run_are_fixed(run):
    """Its obstacles and thicknesses would stay where they are."""
    for wrong in ({"unit_m": 0.01}, {"up": "y"}):
        with pytest.raises(UserError, match=r"--scale, --up: found .* for the run .*; allowed: 1 m per unit and z up"):
            read_trajectory(run, **wrong)
    assert len(read_trajectory(run, unit_m=1.0, up="z").labels) == 4


@pytest.mark.parametrize("kind, module, words", [
    ("usd", "pxr.UsdGeom", "usd-core (Tomorrow Open Source Technology License 1.0)"),
    ("abc", "alembic3d.Abc", "alembic3d (BSD-3-Clause)"),
    ("vtkhdf", "h5py", "h5py (BSD-3-Clause)"),
])  # fmt: skip
def test_without_the_package_the_command_that_installs_it_is_named(tmp_path, monkeypatch, kind, module, words):
    monkeypatch.setitem(sys.modules, module, None)
    extra = {"usd": "usd", "abc": "alembic", "vtkhdf": "vtkhdf"}[kind]
    install = f"the package {words} is not installed: .venv/bin/python -m pip install --requirement analysis/requirements-{extra}.txt"
    (tmp_path / f"a.{kind}").write_bytes(b"")
    with pytest.raises(UserError) as error:
        read_trajectory(tmp_path / f"a.{kind}")
    assert str(error.value) == f"{tmp_path}/a.{kind}: {install}"
    if kind in formats.WRITERS:
        with pytest.raises(UserError) as error:
            formats.write([sequence()], kind, tmp_path)
        assert str(error.value) == f"--format {kind}: {install}"


@pytest.mark.parametrize("kind", KINDS)
def test_a_folder_with_two_films_asks_which(tmp_path, kind):
    for name in ("a", "b"):
        (tmp_path / f"{name}.{kind}").write_bytes(b"")
    with pytest.raises(UserError, match=f"found a.{kind}, b.{kind}; one film is needed, or say which: ./bench judge"):
        read_trajectory(tmp_path)
