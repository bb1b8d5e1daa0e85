"""VTKHDF, written here by h5py as VTK's specification says: grids and polygons, partitions, steps, collections, and what is refused."""

import h5py
import numpy as np
import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program import mesh_file
from barrierbench_analysis.program.mesh_arrays import read_frame_file
from barrierbench_analysis.program.trajectories.readers import read_trajectory
from tests.judge.habits import APART, CROSSED, FACES, FALL, FLOOR, SPEAR, TETRAHEDRA
from tests.judge.test_judge_verb import judge

TOPOLOGIES = ("Vertices", "Lines", "Polygons", "Strips")
SOLIDS = [[0, 1, 2, 3], [4, 5, 6, 7]]


def head(group, kind):
    group.attrs["Version"] = (2, 2)
    group.attrs.create("Type", kind.encode("ascii"), dtype=h5py.string_dtype("ascii", len(kind)))


def cells_of(group, parts):
    """parts: lists of cells, a list a partition, whose offsets begin at 0 in each."""
    group["NumberOfCells"] = [len(part) for part in parts]
    group["NumberOfConnectivityIds"] = [sum(map(len, part)) for part in parts]
    group["Connectivity"] = np.array([corner for part in parts for cell in part for corner in cell], np.int64)
    group["Offsets"] = np.concatenate([np.cumsum([0, *(len(cell) for cell in part)]) for part in parts]).astype(np.int64)


def points_of(group, parts, counts=None):
    group["NumberOfPoints"] = counts or [len(part) for part in parts]
    group["Points"] = np.concatenate(parts)


def grid(group, points, cells, types, counts=None):
    head(group, "UnstructuredGrid")
    points_of(group, points, counts)
    cells_of(group, cells)
    group["Types"] = np.array([kind for part in types for kind in part], np.uint8)


def polygons(group, points, counts=None, **cells):
    head(group, "PolyData")
    points_of(group, points, counts)
    for name in TOPOLOGIES:
        cells_of(group.create_group(name), cells.get(name, [[]] * len(group["NumberOfPoints"])))


def steps(group, times, **tables):
    of = group.create_group("Steps")
    of.attrs["NSteps"] = len(times)
    of["Values"] = times
    for name, values in tables.items():
        of[name] = values


def file_of(folder, fill, name="a.vtkhdf"):
    with h5py.File(folder / name, "w", track_order=True) as file:
        fill(file.create_group("VTKHDF", track_order=True))
    return folder / name


def refused(path, words):
    with pytest.raises(UserError) as error:
        list(read_trajectory(path).frames())
    assert str(error.value).startswith(str(path.parent)) and words in str(error.value), error.value


# --- without time


def test_a_grid_of_two_partitions_has_every_cell_and_bit(program, tmp_path):
    points = [np.random.default_rng(1).normal(size=(4, 3)), np.random.default_rng(2).normal(size=(6, 3))]
    path = file_of(tmp_path, lambda group: grid(group, points, [[[0, 1, 2, 3]], [[0, 1, 2], [3, 4], [2, 1, 4, 5]]], [[10], [5, 3, 9]]))
    found = read_trajectory(path)
    assert found.times_s is None and found.labels == ["the only step"]
    np.testing.assert_array_equal(next(found.frames()), np.concatenate(points))
    t = found.topology
    assert t.tetrahedra.tolist() == [[0, 1, 2, 3]] and t.segments.tolist() == [[7, 8]] and t.polygons == 1
    assert t.triangles[0].tolist() == [4, 5, 6] and set(t.triangles[1:].ravel()) == {6, 5, 8, 9} and len(t.triangles) == 3


def test_polygons_have_lines_strips_and_faces(program, tmp_path):
    def fill(group):
        cells = {"Polygons": [[[0, 1, 2]]], "Lines": [[[0, 3, 4]]], "Strips": [[[2, 3, 4, 5]]], "Vertices": [[[5]]]}
        polygons(group, [CROSSED], **cells)

    found = read_trajectory(file_of(tmp_path, fill, "a.hdf"))
    assert found.topology.triangles.tolist() == [[0, 1, 2], [2, 3, 4], [4, 3, 5]] and found.topology.segments.tolist() == [[0, 3], [3, 4]]
    list(found.frames())
    assert any('cell "vertices": 1 left out, the first at' in note and "a.hdf (the only step):" in note for note in found.heard)


def test_crossing_blocks_of_a_collection_are_bodies_that_cross(program, tmp_path):
    def fill(group):
        head(group, "PartitionedDataSetCollection")
        for index, (name, x) in enumerate((("spear", SPEAR), ("floor", FLOOR))):
            block = group.create_group(name)
            polygons(block, [x], Polygons=[[[0, 1, 2]]])
            block.attrs["Index"] = index
        assembly = group.create_group("Assembly")
        assembly["floor"] = h5py.SoftLink("/VTKHDF/floor")
        group.create_group("empty").attrs["Index"] = 2

    code, record = judge(tmp_path, file_of(tmp_path, fill))
    assert (code, record["verdict"], record["trajectory"]["bodies"]) == (1, "penetrates", ["spear", "floor"])


# --- steps


def test_steps_of_points_share_the_cells_they_name(program, tmp_path):
    frames = [APART, APART + 0.125, CROSSED]

    def fill(group):
        grid(group, frames, [FACES], [[5, 5]], [6])
        steps(group, [0.0, 0.1, 0.3], PartOffsets=[0] * 3, NumberOfParts=[1] * 3, PointOffsets=[0, 6, 12], CellOffsets=[[0]] * 3, ConnectivityIdOffsets=[[0]] * 3)

    path = file_of(tmp_path, fill)
    found = read_trajectory(path)
    assert found.times_s == [0.0, 0.1, 0.3]
    np.testing.assert_array_equal(list(found.frames()), frames)
    code, record = judge(tmp_path, path)
    assert (code, record["verdict"]) == (1, "penetrates") and record["findings"][0]["frame"] == "0.3 s"


def test_steps_with_partitions_and_cells_of_their_own(program, tmp_path):
    """As vtkHDFWriter appends a step: everything again, in two partitions each, without NumberOfParts."""
    frames = [APART, APART + 0.5]

    def fill(group):
        grid(group, [x[part] for x in frames for part in (slice(0, 3), slice(3, 6))], [[[0, 1, 2]]] * 4, [[5]] * 4)
        steps(group, [0.0, 1.0], PartOffsets=[0, 2], PointOffsets=[0, 6], CellOffsets=[0, 2], ConnectivityIdOffsets=[0, 6])

    found = read_trajectory(file_of(tmp_path, fill))
    np.testing.assert_array_equal(list(found.frames()), frames)
    assert found.topology.triangles.tolist() == FACES


@pytest.mark.parametrize("again", [False, True], ids=["cells once", "cells in every step"])
def test_steps_of_polygons_with_a_partition_each(program, tmp_path, again):
    """A step that names a partition of its own may still have the cells of the first one."""
    frames = [APART, APART + 0.5, APART + 1]
    faces = [FACES] * 3 if again else [FACES]
    cell, corner = ([0, 2, 4], [0, 6, 12]) if again else ([0, 0, 0], [0, 0, 0])

    def fill(group):
        head(group, "PolyData")
        points_of(group, frames)
        for name in TOPOLOGIES:
            cells_of(group.create_group(name), faces if name == "Polygons" else [[]])
            for count in ("NumberOfCells", "NumberOfConnectivityIds"):
                first = group[name][count][0]
                del group[name][count]
                group[name][count] = [first] * 3
        columns = {"CellOffsets": cell, "ConnectivityIdOffsets": corner}
        tables = {name: [[0, 0, start, 0] for start in starts] for name, starts in columns.items()}
        steps(group, [0.0, 1.0, 2.0], PartOffsets=[0, 1, 2], NumberOfParts=[1] * 3, PointOffsets=[0, 6, 12], **tables)

    found = read_trajectory(file_of(tmp_path, fill))
    np.testing.assert_array_equal(list(found.frames()), frames)
    assert found.topology.triangles.tolist() == FACES


def test_a_field_moves_points_that_rest(program, tmp_path):
    """As FEM programs write it: points once, the motion as u at each step."""

    def fill(group):
        grid(group, [TETRAHEDRA], [SOLIDS], [[10, 10]])
        group.create_group("PointData")["u"] = np.concatenate([0 * FALL, FALL])
        steps(group, [0.0, 1.0], PartOffsets=[0, 0], NumberOfParts=[1, 1], PointOffsets=[0, 0], CellOffsets=[0, 0], ConnectivityIdOffsets=[0, 0])
        group["Steps"].create_group("PointDataOffsets")["u"] = [0, 8]

    path = file_of(tmp_path, fill)
    found = read_trajectory(path)
    np.testing.assert_array_equal(list(found.frames()), [TETRAHEDRA, TETRAHEDRA + FALL])
    code, record = judge(tmp_path, path)
    assert (code, record["verdict"], record["trajectory"]["displacement"]) == (1, "penetrates", "u")
    code, record = judge(tmp_path, path, "--displacement", "none")
    assert code == 0 and record["trajectory"]["moves"] is False
    assert mesh_file.main([str(path), str(tmp_path / "a.ply")]) == 0
    mesh = read_frame_file(tmp_path / "a.ply")
    np.testing.assert_array_equal(mesh.points, TETRAHEDRA)
    assert mesh.tetrahedra.tolist() == SOLIDS


# --- what is refused


def moving_cells(group):
    grid(group, [APART], [FACES, [[0, 1, 2], [3, 5, 4]]], [[5, 5], [5, 5]], [6, 6])
    steps(group, [0.0, 0.5], PartOffsets=[0, 1], NumberOfParts=[1, 1], PointOffsets=[0, 0], CellOffsets=[0, 2], ConnectivityIdOffsets=[0, 6])


def without(name):
    def fill(group):
        grid(group, [APART], [FACES], [[5, 5]])
        del group[name]

    return fill


def other_times(group):
    head(group, "MultiBlockDataSet")
    for name, times in (("a", [0.0, 1.0]), ("b", [0.0, 2.0])):
        block = group.create_group(name)
        grid(block, [FLOOR], [[[0, 1, 2]]], [[5]])
        steps(block, times, PartOffsets=[0, 0], NumberOfParts=[1, 1], PointOffsets=[0, 0], CellOffsets=[0, 0], ConnectivityIdOffsets=[0, 0])


def of_version(*numbers):
    def fill(group):
        grid(group, [APART], [FACES], [[5, 5]])
        group.attrs["Version"] = numbers

    return fill


def with_steps(times, count):
    def fill(group):
        grid(group, [APART], [FACES], [[5, 5]])
        steps(group, times)
        group["Steps"].attrs["NSteps"] = count

    return fill


@pytest.mark.parametrize("fill, words", [
    (moving_cells, "a.vtkhdf (0.5 s): faces are others than those of the first frame; one topology is needed"),
    (lambda group: grid(group, [np.zeros((8, 3))], [[list(range(8))]], [[12]]), "a hexahedron (type 12)"),
    (lambda group: grid(group, [APART], [[[0, 1, 9]]], [[5]]), "a.vtkhdf (the only step)"),
    (lambda group: head(group, "ImageData"), "/VTKHDF: found the type 'ImageData'; allowed: UnstructuredGrid, PolyData,"),
    (lambda group: head(group, "MultiBlockDataSet"), "a collection without a data set; one at least is needed"),
    (lambda group: grid(group, [np.zeros((6, 2))], [FACES], [[5, 5]]), "a.vtkhdf (the only step): cannot be read: cannot reshape"),
    (without("Points"), "/VTKHDF/Points: none; rows 0 to 6 are needed"),
    (without("NumberOfPoints"), "/VTKHDF: no NumberOfPoints; VTKHDF needs it"),
    (without("Types"), "/VTKHDF/Types: none; rows 0 to 2 are needed"),
    (lambda group: grid(group, [APART], [FACES], [[5, 5]], [7]), "/VTKHDF/Points: 6 rows; rows 0 to 7 are needed"),
    (other_times, "b: steps at other times than those of a; the same are needed"),
    (of_version(3, 0), "VTKHDF of version [3, 0]; allowed: up to 2"),
    (with_steps([0.0, 1.0], 3), "/VTKHDF/Steps: 3 steps and 2 values"),
    (with_steps([1.0, 0.5], 2), "found the time 0.5 s after 1.0 s; a later one is needed"),
])  # fmt: skip
def test_what_is_no_film_is_refused(program, tmp_path, fill, words):
    refused(file_of(tmp_path, fill), words)


def test_what_is_no_vtkhdf_is_refused(program, tmp_path):
    (tmp_path / "a.vtkhdf").write_text("v 0 0 0\n")
    refused(tmp_path / "a.vtkhdf", "a.vtkhdf: not an HDF5 file that can be read: ")
    with h5py.File(tmp_path / "b.hdf", "w") as file:
        file["x"] = [1.0]
    refused(tmp_path / "b.hdf", "b.hdf: no group VTKHDF; an HDF5 file of VTK is needed")
