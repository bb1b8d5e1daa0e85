"""Alembic of other programs: axes, transforms, times, winding, objects that are no mesh, and what is refused."""

import numpy as np
import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program import mesh_file
from barrierbench_analysis.program.mesh_arrays import read_frame_file
from barrierbench_analysis.program.trajectories.readers import read_trajectory
from tests.judge.alembic_package import NO_WHEEL
from tests.judge.habits import APART, CROSSED, FACES
from tests.judge.test_judge_verb import judge

if NO_WHEEL:
    pytest.skip(NO_WHEEL, allow_module_level=True)
import imath
from alembic3d import Abc, AbcCoreAbstract, AbcGeom

SQUARE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float)


def filled(array, values):
    np.asarray(memoryview(array))[:] = values
    return array


def vectors(values):
    return filled(imath.V3fArray(len(values)), np.asarray(values, "<f4"))


def integers(values):
    return filled(imath.IntArray(len(values)), values)


def faces(points, corners=(0, 1, 2, 3), sizes=(4,)):
    return AbcGeom.OPolyMeshSchemaSample(vectors(points), integers(corners), integers(sizes))


def times_of(archive, times):
    kind = AbcCoreAbstract.TimeSamplingType(AbcCoreAbstract.AcyclicFlag.kAcyclic)
    vector = AbcCoreAbstract.TimeVector()
    vector[:] = times
    return Abc.Argument(archive.addTimeSampling(AbcCoreAbstract.TimeSampling(kind, vector)))


def written(path, fill):
    """fill(archive, its top). The library writes when all that it made is gone."""
    archive = Abc.CreateArchiveWithInfo(str(path), "test", "")
    fill(archive, archive.getTop())
    return path


def sheet(top, name="cloth", samples=None, times=None):
    mesh = AbcGeom.OPolyMesh(top, name, *([times] if times else []))
    for sample in samples or [faces(SQUARE)]:
        mesh.getSchema().set(sample)


def refused(path, words):
    with pytest.raises(UserError) as error:
        list(read_trajectory(path).frames())
    assert str(error.value).startswith(str(path.parent)) and words in str(error.value), error.value


# --- unit, axes, winding


def test_y_is_up_and_the_unit_is_m_unless_the_user_says_otherwise(program, tmp_path):
    path = written(tmp_path / "a.abc", lambda archive, top: sheet(top))
    found = read_trajectory(path)
    np.testing.assert_array_equal(next(found.frames()), SQUARE[:, [0, 2, 1]] * [1, -1, 1])
    assert "m and y up are taken, or --scale and --up" in " ".join(found.notes)
    found = read_trajectory(path, unit_m=0.01, up="z")
    np.testing.assert_array_equal(next(found.frames()), 0.01 * SQUARE)
    out = tmp_path / "a.ply"
    assert mesh_file.main([str(path), str(out), "--scale", "0.5", "--up", "z"]) == 0
    np.testing.assert_array_equal(read_frame_file(out).points, 0.5 * SQUARE)


def test_faces_turn_counterclockwise_once_they_are_read(program, tmp_path):
    """Alembic has them clockwise: a square from above has the normal -z in the file's own order."""
    t = read_trajectory(written(tmp_path / "a.abc", lambda archive, top: sheet(top)), up="z").topology
    normals = np.cross(*(SQUARE[t.triangles[:, k]] - SQUARE[t.triangles[:, 0]] for k in (1, 2)))
    assert t.polygons == 1 and (normals[:, 2] < 0).all() and len(normals) == 2


# --- places and times


def test_transforms_of_all_parents_hold_at_each_time(program, tmp_path):
    def fill(archive, top):
        times = times_of(archive, [0.0, 0.3, 0.7])
        turned = AbcGeom.OXform(top, "p")
        turn = AbcGeom.XformSample()
        turn.setMatrix(imath.M44d(0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1))  # by 90 degrees, doubled
        turned.getSchema().set(turn)
        moving = AbcGeom.OXform(turned, "c", times)
        for x in (0, 1, 3):
            step = AbcGeom.XformSample()
            step.setTranslation(imath.V3d(x, 0, 0))
            moving.getSchema().set(step)
        sheet(moving)

    found = read_trajectory(written(tmp_path / "a.abc", fill), up="z")
    assert found.times_s == [0.0, 0.3, 0.7] and found.topology.names == ("/p/c/cloth",)
    for frame, x in zip(found.frames(), (0, 1, 3), strict=True):
        np.testing.assert_array_equal(frame, np.stack([-2 * SQUARE[:, 1], 2 * (SQUARE[:, 0] + x), SQUARE[:, 2]], 1))


def test_an_object_may_leave_its_parents_where_they_are(program, tmp_path):
    def fill(archive, top):
        parent, child = AbcGeom.OXform(top, "p"), None
        step = AbcGeom.XformSample()
        step.setTranslation(imath.V3d(5, 0, 0))
        parent.getSchema().set(step)
        child = AbcGeom.OXform(parent, "c")
        step = AbcGeom.XformSample()
        step.setTranslation(imath.V3d(0, 7, 0))
        step.setInheritsXforms(False)
        child.getSchema().set(step)
        sheet(child)

    np.testing.assert_array_equal(next(read_trajectory(written(tmp_path / "a.abc", fill), up="z").frames()), SQUARE + [0, 7, 0])


def test_two_that_move_at_other_times_are_refused(program, tmp_path):
    def fill(archive, top):
        two = [faces(SQUARE), faces(SQUARE + 1)]
        sheet(top, "a", two, times_of(archive, [0.0, 0.5]))
        sheet(top, "b", two, times_of(archive, [0.0, 0.75]))

    refused(written(tmp_path / "a.abc", fill), "/b: its samples are at other times than those of /a (one of them at 0.5 s)")


def test_the_one_whose_times_were_taken_is_named(program, tmp_path):
    def fill(archive, top):
        two = [faces(SQUARE), faces(SQUARE + 1)]
        sheet(top, "still")
        sheet(top, "a", two, times_of(archive, [0.0, 0.5]))
        sheet(top, "b", two, times_of(archive, [0.0, 0.75]))

    refused(written(tmp_path / "a.abc", fill), "/b: its samples are at other times than those of /a (one of them at 0.5 s)")


def test_a_mirror_keeps_the_outside_outside(program, tmp_path):
    def fill(scale):
        def of(archive, top):
            placed = AbcGeom.OXform(top, "m")
            step = AbcGeom.XformSample()
            step.setScale(imath.V3d(*scale))
            placed.getSchema().set(step)
            sheet(placed, "leaf", [faces(SQUARE[:3], (0, 1, 2), (3,))])

        return of

    for name, scale, z in (("a.abc", (2, 1, 1), -1), ("b.abc", (-2, 1, 1), -1), ("c.abc", (1, 1, -1), 1), ("d.abc", (-1, -1, 1), -1)):
        found = read_trajectory(written(tmp_path / name, fill(scale)), up="z")
        x = next(found.frames())[found.topology.triangles[0]]
        assert np.sign(np.cross(x[1] - x[0], x[2] - x[0])[2]) == z, name


def test_a_topology_that_changes_is_refused_with_object_and_time(program, tmp_path):
    def film(name, second):
        return written(tmp_path / name, lambda archive, top: sheet(top, "cloth", [faces(SQUARE), faces(SQUARE + 1), second], times_of(archive, [0.0, 0.5, 1.5])))

    refused(film("a.abc", faces(SQUARE, (1, 2, 0, 3), (4,))), "a.abc /cloth (1.5 s): faces are others than those of the first frame")
    refused(film("b.abc", faces([*SQUARE, (2, 2, 2)])), "b.abc /cloth (1.5 s): 5 vertices; the first frame has 4")


# --- objects


def curves(top, name, counts, linear=True, wrap=AbcGeom.CurvePeriodicity.kNonPeriodic):
    kind = AbcGeom.CurveType.kLinear if linear else AbcGeom.CurveType.kCubic
    points = vectors([(5, 0, k) for k in range(6)])
    AbcGeom.OCurves(top, name).getSchema().set(AbcGeom.OCurvesSchemaSample(points, integers(counts), kind, wrap))


def test_several_objects_are_bodies_and_points_beside_them_are_not(program, tmp_path):
    def fill(archive, top):
        sheet(top)
        curves(top, "rod", [4, 2])
        curves(top, "ring", [6], True, AbcGeom.CurvePeriodicity.kPeriodic)
        AbcGeom.OPoints(top, "dust").getSchema().set(AbcGeom.OPointsSchemaSample(vectors(SQUARE), integers(range(4))))
        AbcGeom.OCamera(top, "camera")

    found = read_trajectory(written(tmp_path / "a.abc", fill))
    t = found.topology
    assert (t.names, t.first_vertex) == (("/cloth", "/rod", "/ring"), (0, 4, 10))
    assert t.segments.tolist() == [[4, 5], [5, 6], [6, 7], [8, 9], *[[k, k + 1] for k in range(10, 15)], [15, 10]]
    assert "not read: /dust" in found.notes


def hide(one, value):
    AbcGeom.CreateVisibilityProperty(one, 0).setValue(value)


def test_hidden_objects_are_not_read_and_named(program, tmp_path):
    def fill(archive, top):
        sheet(top, "cloth")
        gone = AbcGeom.OPolyMesh(top, "gone")
        gone.getSchema().set(faces(SQUARE))
        hide(gone, 0)
        shown = AbcGeom.OPolyMesh(top, "shown")
        shown.getSchema().set(faces(SQUARE))
        hide(shown, 1)
        group = AbcGeom.OXform(top, "group")
        hide(group, 0)
        sheet(group, "inner")

    found = read_trajectory(written(tmp_path / "a.abc", fill))
    assert found.topology.names == ("/cloth", "/shown")
    assert "not read: /gone, /group/inner: hidden" in found.notes


@pytest.mark.parametrize("fill, words", [
    (lambda archive, top: AbcGeom.OXform(top, "empty") and None, "a.abc: no mesh (found: no object with a shape); allowed: an archive with PolyMesh"),
    (lambda archive, top: AbcGeom.OCamera(top, "eye") and None, "a.abc: no mesh (found: /eye (Camera))"),
    (lambda archive, top: curves(top, "hair", [6], False), "/hair: Curves that are not linear; allowed: linear ones"),
    (lambda archive, top: curves(top, "hair", [4]), "/hair: curves of 4 points; it has 6"),
    (lambda archive, top: sheet(top, "cloth", [faces(SQUARE[:3])]), "/cloth: 4 corners, numbered from 0 to 3; 4 numbers below 3 are needed"),
])  # fmt: skip
def test_what_is_no_film_of_meshes_is_refused(program, tmp_path, fill, words):
    refused(written(tmp_path / "a.abc", fill), words)


def test_what_is_no_alembic_is_refused(program, tmp_path):
    (tmp_path / "a.abc").write_text("v 0 0 0\n")
    refused(tmp_path / "a.abc", "a.abc: not an Alembic file that can be read: ")
    whole = written(tmp_path / "b.abc", lambda archive, top: sheet(top)).read_bytes()
    (tmp_path / "b.abc").write_bytes(whole[: len(whole) // 2])
    refused(tmp_path / "b.abc", "b.abc: not an Alembic file that can be read: ")


# --- verbs


def test_what_crosses_is_seen_and_what_does_not_is_clean(program, tmp_path):
    def film(name, frames):
        samples = [faces(x, np.ravel(FACES), (3, 3)) for x in frames]
        return written(tmp_path / name, lambda archive, top: sheet(top, "both", samples, times_of(archive, [0.0, 0.04])))

    code, record = judge(tmp_path, film("a.abc", [APART, CROSSED]), "--up", "z")
    assert (code, record["verdict"], record["trajectory"]["format"]) == (1, "penetrates", "abc")
    assert record["trajectory"]["times_s"] == [0.0, 0.04] and record["findings"][0]["frame"] == "0.04 s"
    assert judge(tmp_path, film("b.abc", [APART, APART + 0.5]))[0] == 0
