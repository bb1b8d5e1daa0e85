"""USD of other programs: units, axes, transforms, times, prims that are no mesh, and what is refused."""

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdUtils

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program import mesh_file
from barrierbench_analysis.program.mesh_arrays import read_frame_file
from barrierbench_analysis.program.trajectories.readers import read_trajectory
from tests.judge.habits import APART, CROSSED, FACES
from tests.judge.test_judge_verb import judge

SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
QUAD = ("int[] faceVertexCounts = [4]", "int[] faceVertexIndices = [0, 1, 2, 3]", 'uniform token subdivisionScheme = "none"')
CM_Y_UP = ("metersPerUnit = 0.01", 'upAxis = "Y"')


def usda(folder, body, head=("metersPerUnit = 1", 'upAxis = "Z"')):
    path = folder / "a.usda"
    lines = "\n".join(head)
    path.write_text(f"#usda 1.0\n(\n{lines}\n)\n{body}\n")
    return path


def prim(kind, name, *lines, about=""):
    inner = "\n".join(lines)
    return f'def {kind} "{name}" {about}\n{{\n{inner}\n}}\n'


def points_of(values=SQUARE):
    return f"point3f[] points = [{', '.join(map(str, values))}]"


def sheet(name="cloth", *more, points=SQUARE):
    """A mesh of one square."""
    return prim("Mesh", name, *QUAD, points_of(points), *more)


def square(folder, **more):
    return usda(folder, sheet(), **more)


def refused(path, words):
    with pytest.raises(UserError) as error:
        list(read_trajectory(path).frames())
    assert str(error.value).startswith(str(path.parent)) and words in str(error.value), error.value


def text_of(found):
    return " | ".join(found.notes)


# --- units and axes


def test_unit_and_axis_of_the_file_are_those_of_the_result(program, tmp_path):
    """Centimetres with y up: x stays, y becomes z, z becomes -y."""
    path = usda(tmp_path, sheet(points=[(0, 10, 0), (100, 10, 0), (100, 20, 50), (0, 20, 50)]), CM_Y_UP)
    found = read_trajectory(path)
    np.testing.assert_allclose(next(found.frames()), [[0, 0, 0.1], [1, 0, 0.1], [1, -0.5, 0.2], [0, -0.5, 0.2]], rtol=1e-15, atol=0)
    assert "coordinates were multiplied by 0.01 (m per unit) and rounded and turned from y up to z up" in text_of(found)


def test_a_stage_that_names_neither_has_those_of_usd(program, tmp_path):
    found = read_trajectory(square(tmp_path, head=()))
    np.testing.assert_array_equal(next(found.frames()), [[0, 0, 0], [0.01, 0, 0], [0.01, 0, 0.01], [0, 0, 0.01]])
    assert "the stage names no metersPerUnit: that of USD is taken (0.01), or --scale" in found.notes
    assert "the stage names no upAxis: that of USD is taken (y), or --up" in found.notes
    found = read_trajectory(square(tmp_path, head=("metersPerUnit = 1",)))
    assert "no metersPerUnit" not in text_of(found) and "no upAxis" in text_of(found)


@pytest.mark.parametrize("unit", ["0", "-1", "inf", "nan"])
def test_a_unit_that_is_no_length_is_refused(program, tmp_path, unit):
    refused(square(tmp_path, head=(f"metersPerUnit = {unit}",)), "a.usda: found metersPerUnit")


def test_they_can_be_kept_as_they_are(program, tmp_path):
    path = square(tmp_path, head=CM_Y_UP)
    found = read_trajectory(path, unit_m=1.0, up="z")
    np.testing.assert_array_equal(next(found.frames()), SQUARE)
    assert "coordinates were" not in text_of(found)
    out = tmp_path / "a.ply"
    assert mesh_file.main([str(path), str(out), "--scale", "1", "--up", "z"]) == 0
    np.testing.assert_array_equal(read_frame_file(out).points, SQUARE)
    code, record = judge(tmp_path, path, "--scale", "1", "--up", "z")
    assert code == 0 and not any("coordinates were" in note for note in record["notes"])


# --- places and times


def test_transforms_of_all_parents_hold_at_each_time(program, tmp_path):
    """A parent turns by 90 degrees about z and doubles; a child moves along x from time to time."""
    child = prim("Xform", "c", "double3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 12: (1, 0, 0), 24: (3, 0, 0) }",
                 'uniform token[] xformOpOrder = ["xformOp:translate"]', sheet())  # fmt: skip
    parent = prim("Xform", "p", "double3 xformOp:rotateXYZ = (0, 0, 90)", "double3 xformOp:scale = (2, 2, 2)",
                  'uniform token[] xformOpOrder = ["xformOp:rotateXYZ", "xformOp:scale"]', child)  # fmt: skip
    found = read_trajectory(usda(tmp_path, parent, ("metersPerUnit = 1", 'upAxis = "Z"', "timeCodesPerSecond = 48")))
    assert found.times_s == [0, 0.25, 0.5] and found.topology.names == ("/p/c/cloth",)
    here = np.array(SQUARE, float)
    for frame, x in zip(found.frames(), (0, 1, 3), strict=True):
        np.testing.assert_allclose(frame, np.stack([-2 * here[:, 1], 2 * (here[:, 0] + x), here[:, 2]], 1), atol=1e-14)


def test_a_mirror_keeps_the_outside_outside(program, tmp_path):
    """Faces and tetrahedra are reversed where a transform has a negative determinant."""
    flat, solid = "int[] faceVertexCounts = [3]", "int4[] tetVertexIndices = [(0, 1, 2, 3)]"
    cells = prim("Mesh", "leaf", flat, "int[] faceVertexIndices = [0, 1, 2]", points_of(SQUARE[:3]))
    cells += prim("TetMesh", "solid", solid, points_of([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]))
    scale = ("double3 xformOp:scale = (-1, 1, 1)", 'uniform token[] xformOpOrder = ["xformOp:scale"]')
    found = read_trajectory(usda(tmp_path, prim("Xform", "m", *scale, cells)))
    x, t = next(found.frames()), found.topology
    leaf = x[t.triangles[0]]
    assert np.cross(leaf[1] - leaf[0], leaf[2] - leaf[0])[2] == 1  # a side that is above is above in the mirror of x
    sides = x[t.tetrahedra[0, 1:]] - x[t.tetrahedra[0, 0]]
    assert np.linalg.det(sides) > 0


def test_positions_between_samples_are_straight_and_reported(program, tmp_path):
    def moving(name, samples):
        values = ", ".join(f"{t}: [{', '.join(str((x + s, y, z)) for x, y, z in SQUARE)}]" for t, s in samples.items())
        return prim("Mesh", name, *QUAD, f"point3f[] points.timeSamples = {{ {values} }}")

    found = read_trajectory(usda(tmp_path, moving("a", {0: 0, 24: 1}) + moving("b", {0: 5, 12: 6, 24: 7})))
    assert found.times_s == [0, 0.5, 1]
    np.testing.assert_array_equal([frame[[0, 4], 0] for frame in found.frames()], [[0, 5], [0.5, 6], [1, 7]])
    assert "at times between samples of their own positions are straight: /a" in text_of(found)


def test_a_topology_that_changes_is_refused_with_prim_and_time(program, tmp_path):
    body = prim(
        "Mesh",
        "cloth",
        "int[] faceVertexCounts.timeSamples = { 0: [3, 3], 24: [3, 3], 48: [3, 3] }",
        "int[] faceVertexIndices.timeSamples = { 0: [0, 1, 2, 0, 2, 3], 24: [0, 1, 2, 0, 2, 3], 48: [0, 1, 3, 1, 2, 3] }",
        points_of(),
    )
    path = usda(tmp_path, body)
    assert len(next(read_trajectory(path).frames())) == 4
    refused(path, "a.usda /cloth (2.0 s): faces are others than those of the first frame; one topology is needed")
    two = "point3f[] points.timeSamples = { 0: [(0,0,0), (1,0,0), (1,1,0), (0,1,0)], 24: [(0,0,0), (1,0,0), (1,1,0), (0,1,0), (2,2,2)] }\n"
    refused(usda(tmp_path, prim("Mesh", "cloth", *QUAD, two)), "a.usda /cloth (1.0 s): 5 vertices; the first frame has 4")


# --- prims


def rods(wrap):
    kind = ('uniform token type = "linear"', f'uniform token wrap = "{wrap}"')
    return prim("BasisCurves", "rod", *kind, "int[] curveVertexCounts = [3, 3]", points_of([(5, 0, k) for k in range(6)]))


def test_several_meshes_curves_and_tetrahedra_are_bodies(program, tmp_path):
    solid = prim("TetMesh", "solid", "int4[] tetVertexIndices = [(0, 1, 2, 3)]", points_of([(9, 0, 0), (10, 0, 0), (9, 1, 0), (9, 0, 1)]))
    left = sheet("cloth", 'uniform token orientation = "leftHanded"')
    found = read_trajectory(usda(tmp_path, left + rods("nonperiodic") + solid))
    t = found.topology
    assert (t.names, t.first_vertex, t.n_vertices) == (("/cloth", "/rod", "/solid"), (0, 4, 10), 14)
    assert t.segments.tolist() == [[4, 5], [5, 6], [7, 8], [8, 9]] and t.tetrahedra.tolist() == [[10, 11, 12, 13]]
    assert t.polygons == 1 and sorted(t.triangles.ravel().tolist()) in ([0, 0, 1, 2, 2, 3], [0, 1, 1, 2, 3, 3])
    normals = np.cross(*(np.array(SQUARE)[t.triangles[:, k]] - np.array(SQUARE)[t.triangles[:, 0]] for k in (1, 2)))
    assert (normals[:, 2] < 0).all()  # of a left-handed mesh
    found = read_trajectory(usda(tmp_path, rods("periodic")))
    assert found.topology.segments.tolist() == [[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3]]


def test_what_is_no_part_of_the_scene_is_not_read_and_named(program, tmp_path):
    proxy, gone = sheet("proxy", 'uniform token purpose = "proxy"'), sheet("gone", 'token visibility = "invisible"')
    smooth = sheet("smooth").replace('"none"', '"catmullClark"')
    found = read_trajectory(usda(tmp_path, sheet() + prim("Sphere", "ball") + proxy + gone + smooth))
    assert found.topology.names == ("/cloth", "/smooth")
    for words in ("/ball: a Sphere (obstacles: --about)", "/proxy: of the purpose proxy", "/gone: invisible", "read as their control meshes: /smooth"):
        assert words in text_of(found)


def test_holes_are_named(program, tmp_path):
    assert "holeIndices" not in text_of(read_trajectory(square(tmp_path)))
    found = read_trajectory(usda(tmp_path, sheet("cloth", "int[] holeIndices = [0]")))
    assert "faces that are holes (holeIndices) are read as all others: /cloth" in found.notes


SKINNED = prim(
    "SkelRoot", "r", "rel skel:skeleton = </r/s>", prim("Skeleton", "s"),
    prim("Mesh", "cloth", *QUAD, points_of(), 'int[] primvars:skel:jointIndices = [0, 0, 0, 0] (\ninterpolation = "vertex"\nelementSize = 1\n)',
         about='(\nprepend apiSchemas = ["SkelBindingAPI"]\n)'),
)  # fmt: skip


@pytest.mark.parametrize("body, words", [
    (prim("Xform", "a", prim("Camera", "b")), "a.usda: no mesh (found: Camera 1, Xform 1); allowed: a stage with Mesh"),
    ("", "no mesh (found: no prim)"),
    (prim("PointInstancer", "many"), "/many: a PointInstancer; allowed: Mesh"),
    (prim("BasisCurves", "hair", "int[] curveVertexCounts = [4]", points_of()), "/hair: cubic BasisCurves; allowed: linear ones"),
    (rods("nonperiodic").replace("[3, 3]", "[3]"), "/rod: curves of 3 points; it has 6"),
    (sheet(points=SQUARE[:3]), "/cloth: 4 corners, numbered from 0 to 3; 4 numbers below 3 are needed"),
    (prim("Mesh", "cloth", *QUAD), "/cloth: no points; at least one is needed"),
    (prim("Xform", "x", about="(\nreferences = @./gone.usd@\n)") + sheet(), "Could not open asset"),
    (SKINNED, "/r/cloth: its points are moved by a skeleton"),
])  # fmt: skip
def test_what_is_no_film_of_meshes_is_refused(program, tmp_path, body, words):
    refused(usda(tmp_path, body), words)


def test_what_is_no_usd_is_refused(program, tmp_path):
    (tmp_path / "a.usd").write_text("v 0 0 0\n")
    refused(tmp_path / "a.usd", "a.usd: not a USD file that can be read: ")
    refused(tmp_path / "none.usd", "none.usd: no such file or folder")


# --- forms of the file, and verbs


def test_text_binary_and_packed_are_the_same(program, tmp_path):
    path = square(tmp_path)
    for name in ("b.usdc", "b.usd"):
        assert Usd.Stage.Open(str(path)).GetRootLayer().Export(str(tmp_path / name))
    assert UsdUtils.CreateNewUsdzPackage(str(tmp_path / "b.usdc"), str(tmp_path / "b.usdz"))
    for name in ("a.usda", "b.usdc", "b.usd", "b.usdz"):
        found = read_trajectory(tmp_path / name)
        np.testing.assert_array_equal(next(found.frames()), SQUARE)
        assert found.times_s is None and found.topology.names == ("/cloth",)


def stage_of(path, frames):
    """A film of two triangles by the library, with double precision nowhere."""
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    mesh = UsdGeom.Mesh.Define(stage, "/both")
    mesh.CreateFaceVertexCountsAttr([3, 3])
    mesh.CreateFaceVertexIndicesAttr(np.ravel(FACES).tolist())
    for k, x in enumerate(frames):
        mesh.GetPointsAttr().Set([Gf.Vec3f(*map(float, p)) for p in x], k)
    stage.Save()
    return path


def test_what_crosses_is_seen_and_what_does_not_is_clean(program, tmp_path):
    code, record = judge(tmp_path, stage_of(tmp_path / "a.usd", [APART, CROSSED]))
    assert (code, record["verdict"], record["trajectory"]["format"]) == (1, "penetrates", "usd")
    assert record["trajectory"]["times_s"] == [0, 1 / 24] and record["findings"][0]["frame"] == f"{1 / 24!r} s"
    assert judge(tmp_path, stage_of(tmp_path / "b.usd", [APART, APART + 0.5]))[0] == 0


def test_numbers_that_are_none_are_the_verdict(program, tmp_path):
    code, record = judge(tmp_path, stage_of(tmp_path / "a.usd", [APART, APART * np.nan]))
    assert (code, record["verdict"]) == (1, "not_finite")


def test_a_mesh_of_a_film_is_its_first_frame(program, tmp_path, capsys):
    path = stage_of(tmp_path / "a.usd", [APART, CROSSED])
    assert mesh_file.main([str(path), str(tmp_path / "a.ply")]) == 0
    np.testing.assert_array_equal(read_frame_file(tmp_path / "a.ply").points, APART.astype("<f4"))
    assert "a.usd: the first of 2 frames is read (0.0 s)" in capsys.readouterr().err
