"""`bench data mesh`: meshes of Gmsh and VTK as PLY that the program reads; what is left out, what is refused."""

import json
import os
import subprocess
from pathlib import Path

import meshio
import numpy as np
import pytest

from barrierbench_analysis.program import mesh_file

# Two tetrahedra on one face, one point between that belongs to nothing, a triangle and an edge beside them.
POINTS = np.array(
    [
        [0, 0, 0],
        [1, 0, 0],
        [0, 1, 0],
        [9, 9, 9],
        [0, 0, 1],
        [1, 1, 1.125],
        [3, 0, 0],
        [4, 0, 0],
        [3, 1, 0.3125],
        [5, 5, 5],
    ]
)
TETRAHEDRA = np.array([[0, 1, 2, 4], [1, 5, 2, 4]])
TRIANGLES = np.array([[2, 1, 0], [6, 7, 8]])  # the first is a face of tetrahedron 0
LINES = np.array([[0, 1], [6, 7], [7, 9]])  # the last is a side of nothing


def written(path: Path, **options) -> Path:
    if options.get("file_format") == "gmsh41":
        path.write_text(msh41())
        return path
    cells = [("vertex", np.array([[3]])), ("line", LINES), ("triangle", TRIANGLES), ("tetra", TETRAHEDRA)]
    meshio.Mesh(POINTS, cells).write(path, **options)
    return path


def msh41() -> str:
    """What Gmsh writes; meshio writes 4.1 of one kind of cells only."""
    blocks = [(0, 15, np.array([[3]])), (1, 1, LINES), (2, 2, TRIANGLES), (3, 4, TETRAHEDRA)]
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$Nodes", "1 10 1 10", "3 1 0 10"]
    lines += [str(i + 1) for i in range(10)] + [" ".join(map(str, point)) for point in POINTS]
    lines += ["$EndNodes", "$Elements", "4 8 1 8"]
    number = 0
    for dimension, kind, corners in blocks:
        lines.append(f"{dimension} 1 {kind} {len(corners)}")
        for row in corners + 1:
            number += 1
            lines.append(" ".join(map(str, [number, *row])))
    return "\n".join([*lines, "$EndElements", ""])


def convert(source: Path, *words: str) -> tuple[int, Path]:
    target = source.with_name("out.ply")
    return mesh_file.main([str(source), str(target), *words]), target


def numbers_of(path: Path) -> dict:
    """The elements of a PLY of ours."""
    header, body = path.read_bytes().split(b"end_header\n", 1)
    count = {
        line.split()[1]: int(line.split()[2])
        for line in header.decode().splitlines()
        if line.startswith("element")
    }
    kinds = {
        "vertex": np.dtype(("<f8", 3)),
        "face": np.dtype([("n", "u1"), ("v", "<i4", 3)]),
        "tetrahedron": np.dtype([("n", "u1"), ("v", "<i4", 4)]),
        "edge": np.dtype(("<i4", 2)),
    }
    out, at = {}, 0
    for name, kind in kinds.items():
        out[name] = np.frombuffer(body, kind, count[name], at)
        at += count[name] * kind.itemsize
    assert at == len(body)
    return out


FORMATS = {
    "msh22_ascii": ("a.msh", {"file_format": "gmsh22", "binary": False}),
    "msh22_binary": ("a.msh", {"file_format": "gmsh22", "binary": True}),
    "msh41_ascii": ("a.msh", {"file_format": "gmsh41"}),
    "vtu_ascii": ("a.vtu", {"binary": False}),
    "vtu_binary": ("a.VTU", {"file_format": "vtu"}),
}


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_gives_the_same_bits(tmp_path, name):
    file, options = FORMATS[name]
    code, target = convert(written(tmp_path / file, **options))
    assert code == 0
    ply = numbers_of(target)
    assert (ply["vertex"] == POINTS[[0, 1, 2, 4, 5, 6, 7, 8, 9]]).all()
    assert (
        ply["tetrahedron"]["v"].tolist() == [[0, 1, 2, 3], [1, 4, 2, 3]]
        and (ply["tetrahedron"]["n"] == 4).all()
    )
    assert ply["face"]["v"].tolist() == [[5, 6, 7]]
    assert ply["edge"].tolist() == [[6, 8]]


def test_binary_msh41_of_tetrahedra(tmp_path):
    meshio.Mesh(POINTS, [("tetra", TETRAHEDRA)]).write(tmp_path / "a.msh", file_format="gmsh", binary=True)
    code, target = convert(tmp_path / "a.msh")
    assert code == 0 and b"4.1 1 8" in (tmp_path / "a.msh").read_bytes()[:40]
    ply = numbers_of(target)
    assert (ply["vertex"] == POINTS[[0, 1, 2, 4, 5]]).all()
    assert ply["tetrahedron"]["v"].tolist() == [[0, 1, 2, 3], [1, 4, 2, 3]]


def test_a_skin_stays_where_it_is_asked_for(tmp_path, capsys):
    source = written(tmp_path / "a.vtu")
    assert convert(source)[0] == 0
    assert "a triangle that is a face of tetrahedra: 1 left out" in capsys.readouterr().err
    code, target = convert(source, "--skin")
    assert code == 0 and "face of tetrahedra" not in capsys.readouterr().err
    assert numbers_of(target)["face"]["v"].tolist() == [[2, 1, 0], [5, 6, 7]]


def test_no_skin_is_kept_between_two_tetrahedra(tmp_path, capsys):
    cells = [("tetra", TETRAHEDRA), ("triangle", [[2, 1, 0], [1, 2, 4]])]  # of one tetrahedron, of both
    meshio.Mesh(POINTS, cells).write(tmp_path / "a.vtu")
    code, target = convert(tmp_path / "a.vtu", "--skin")
    assert code == 0
    assert numbers_of(target)["face"]["v"].tolist() == [[2, 1, 0]]


def test_the_program_reads_it(tmp_path):
    program = os.environ.get("BARRIERBENCH_PROGRAM")
    if not program:
        pytest.skip("no program")
    mesh = meshio.Mesh(POINTS, [("tetra", TETRAHEDRA)])
    mesh.write(tmp_path / "a.vtu")
    _, target = convert(tmp_path / "a.vtu")
    body = {"name": "solid", "mesh": {"file": str(target)}}
    config = {
        "schema": "barrierbench.config/1",
        "scene": {"bodies": [body]},
        "formulation": {"d_hat_m": 0.01},
    }
    config["time"] = {"dt_s": 0.01, "steps": 1}
    (tmp_path / "config.json").write_text(json.dumps(config))
    explained = subprocess.run(
        [program, "explain", str(tmp_path / "config.json")], capture_output=True, text=True, check=False
    )
    assert explained.returncode == 0, explained.stderr
    assert "2 tetrahedra" in explained.stdout


def refused(capsys, source: Path, *words: str) -> str:
    code, target = convert(source, *words)
    assert code == 2 and not target.exists()
    return capsys.readouterr().err


def test_what_cannot_be_used_is_refused(tmp_path, capsys):
    assert "No such file" in refused(capsys, tmp_path / "missing.vtu")
    (tmp_path / "a.xyz").write_text("1 2 3\n")
    assert 'extension ".xyz"; allowed: one of .obj' in refused(capsys, tmp_path / "a.xyz")
    for suffix in (".msh", ".vtu"):
        for text in ("", "nonsense\n", "$MeshFormat\n4.1 0 8\n", "<VTKFile>"):
            (tmp_path / f"b{suffix}").write_text(text)
            said = refused(capsys, tmp_path / f"b{suffix}")
            assert f"b{suffix}" in said and "allowed: " in said
    meshio.Mesh(POINTS, [("line", LINES)]).write(tmp_path / "lines.vtu")
    assert "no tetrahedron and no triangle" in refused(capsys, tmp_path / "lines.vtu")
    meshio.Mesh(POINTS, [("quad", [[0, 1, 5, 2]]), ("tetra", TETRAHEDRA)]).write(tmp_path / "quad.vtu")
    assert convert(tmp_path / "quad.vtu")[0] == 0
    assert numbers_of(tmp_path / "out.ply")["face"]["v"].tolist() == [[0, 1, 4], [0, 4, 2]]
    (tmp_path / "out.ply").unlink()
    meshio.Mesh(POINTS, [("tetra", TETRAHEDRA[:, [1, 0, 2, 3]])]).write(tmp_path / "inverted.vtu")
    assert "cell 0: found a tetrahedron of -0.166667 m^3" in refused(capsys, tmp_path / "inverted.vtu")
    code = mesh_file.main([str(written(tmp_path / "a.vtu")), str(tmp_path / "out.obj")])
    assert code == 2 and "extension '.obj'; allowed: .ply" in capsys.readouterr().err


# --- lists of files, units and axes


def blocks(folder: Path, **files: str) -> Path:
    rows = "".join(
        f'<Block name="{name}" index="{k}"><DataSet index="0" file="{file}"/></Block>'
        for k, (name, file) in enumerate(files.items())
    )
    text = f'<VTKFile type="vtkMultiBlockDataSet"><vtkMultiBlockDataSet>{rows}</vtkMultiBlockDataSet></VTKFile>'
    (folder / "a.vtm").write_text(text)
    return folder / "a.vtm"


def test_the_meshes_of_a_list_are_one_mesh(tmp_path):
    """Squares stay squares until all is there: they are cut as those of one file."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    meshio.Mesh(square, [("quad", np.array([[0, 1, 2, 3]]))]).write(tmp_path / "one.vtu")
    meshio.Mesh(square + [0, 0, 1 / 3], [("quad", np.array([[3, 2, 1, 0]]))]).write(tmp_path / "other.vtu")
    code, target = convert(blocks(tmp_path, lower="one.vtu", upper="other.vtu"))
    assert code == 0
    ply = numbers_of(target)
    assert (ply["vertex"] == np.concatenate([square, square + [0, 0, 1 / 3]])).all()
    assert [set(row) <= {0, 1, 2, 3} for row in ply["face"]["v"].tolist()] == [True, True, False, False]
    pieces = '<VTKFile type="PUnstructuredGrid"><PUnstructuredGrid><Piece Source="one.vtu"/></PUnstructuredGrid></VTKFile>'
    (tmp_path / "b.pvtu").write_text(pieces)
    assert convert(tmp_path / "b.pvtu")[0] == 0 and len(numbers_of(target)["vertex"]) == 4


def test_of_a_body_that_is_there_twice_the_solid_is_read(tmp_path, capsys):
    meshio.Mesh(POINTS[[0, 1, 2, 4]], [("tetra", np.array([[0, 1, 2, 3]]))]).write(tmp_path / "volume.vtu")
    meshio.Mesh(POINTS[[0, 1, 2]], [("triangle", np.array([[0, 1, 2]]))]).write(tmp_path / "surface.vtu")
    code, target = convert(blocks(tmp_path, Volume="volume.vtu", Surface="surface.vtu"))
    assert code == 0 and len(numbers_of(target)["tetrahedron"]) == 1 and not len(numbers_of(target)["face"])
    assert "a.vtm: blocks that show the same bodies once more are not read: Surface" in capsys.readouterr().err
    (tmp_path / "volume.vtu").unlink()
    assert convert(tmp_path / "a.vtm")[0] == 2
    assert "volume.vtu: " in capsys.readouterr().err


def test_unit_and_axis_can_be_stated(tmp_path, capsys):
    code, target = convert(written(tmp_path / "a.vtu"), "--scale", "0.001", "--up", "y")
    assert code == 0
    x = POINTS[[0, 1, 2, 4, 5, 6, 7, 8, 9]] * 0.001
    assert (numbers_of(target)["vertex"] == np.stack([x[:, 0], -x[:, 2], x[:, 1]], 1)).all()
    words = "a.vtu: coordinates were multiplied by 0.001 (m per unit) and rounded and turned from y up to z up"
    assert words in capsys.readouterr().err
