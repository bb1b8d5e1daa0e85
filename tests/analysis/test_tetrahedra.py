"""`bench data mesh --tetrahedra`: a closed surface filled, and what is refused. What needs TetGen is skipped without it."""

import importlib.util
import json
import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest
from scipy.spatial import ConvexHull

from barrierbench_analysis.program import mesh_file, tetrahedra
from barrierbench_analysis.program.mesh_file import read_cells

needs_tetgen = pytest.mark.skipif(importlib.util.find_spec("tetgen") is None, reason=f"tetgen is not installed: {tetrahedra.INSTALL}")
POINTS = np.random.default_rng(1).normal(size=(100, 3))
POINTS /= np.linalg.norm(POINTS, axis=1)[:, None]
HULL = ConvexHull(POINTS)
FACES = HULL.simplices


def written(path: Path, points: np.ndarray = POINTS, faces: np.ndarray = FACES) -> Path:
    meshio.Mesh(points, [("triangle", faces)]).write(path)
    return path


def fill(source: Path, *words: str) -> tuple[int, Path]:
    target = source.with_name("solid.ply")
    return mesh_file.main([str(source), str(target), "--tetrahedra", *words]), target


def solid(target: Path):
    """Vertices and tetrahedra of a PLY file of the verb, read by offsets."""
    head, body = target.read_bytes().split(b"end_header\n", 1)
    counts = {w[1]: int(w[2]) for w in (line.split() for line in head.decode().splitlines()) if w[0] == "element"}
    points = np.frombuffer(body, "<f8", 3 * counts["vertex"]).reshape(-1, 3)
    rows = np.frombuffer(body, np.dtype([("n", "u1"), ("v", "<i4", 4)]), counts["tetrahedron"], 24 * counts["vertex"])
    assert counts["face"] == 0 and (rows["n"] == 4).all()
    return points, rows["v"]


def volume(points, cells) -> np.ndarray:
    x = points[cells]
    return np.einsum("ni,ni->n", x[:, 3] - x[:, 0], np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])) / 6


@needs_tetgen
@pytest.mark.parametrize("suffix", ["ply", "obj", "stl", "vtu"])
def test_the_volume_is_filled_and_the_surface_stays(program, tmp_path, suffix):
    source = written(tmp_path / f"surface.{suffix}")
    code, target = fill(source)
    assert code == 0
    points, cells = solid(target)
    inside = volume(points, cells)
    given = read_cells(source)
    kept, triangles = tetrahedra.merged(given.points, given.triangles)
    np.testing.assert_array_equal(points[: len(kept)], kept)
    assert len(kept) == 100 and inside.min() > 0 and inside.sum() == pytest.approx(HULL.volume, rel=1e-6 if suffix == "stl" else 1e-12)
    faces = np.sort(cells[:, [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]].reshape(-1, 3), axis=1)
    sides, count = np.unique(faces, axis=0, return_counts=True)
    assert {tuple(s) for s in sides[count == 1].tolist()} == {tuple(sorted(t)) for t in triangles.tolist()}
    config = {"schema": "barrierbench.config/1", "formulation": {"name": "log", "d_hat_m": 1e-3}, "time": {"dt_s": 0.01, "steps": 1},
              "scene": {"name": "bodies", "bodies": [{"name": "solid", "mesh": {"file": str(target)}, "material": {"solid_youngs_Pa": 1e5, "solid_density_kg_per_m3": 1000}}]}}
    (tmp_path / "config.json").write_text(json.dumps(config))
    done = subprocess.run([program, "check", str(tmp_path / "config.json")], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and f"{len(points)} vertices" in done.stdout, done.stderr


@needs_tetgen
def test_edges_within_are_as_long_as_asked(tmp_path):
    """TetGen is free at the surface, whose triangles stay as large as they are."""
    found = []
    for length in ("0.4", "0.1"):
        points, cells = solid(fill(written(tmp_path / "surface.ply"), "--edge", length)[1])
        assert np.median(volume(points, cells)) < float(length) ** 3 / (6 * np.sqrt(2))
        found.append(len(cells))
    assert found[1] > 8 * found[0]


@needs_tetgen
def test_a_surface_that_crosses_itself_is_refused(tmp_path, capsys, monkeypatch):
    """And nothing is left where the verb was called."""
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    two = written(tmp_path / "two.ply", np.concatenate([POINTS, POINTS + [0.5, 0, 0]]), np.concatenate([FACES, FACES + 100]))
    assert fill(two)[0] == 2 and "does it cross itself" in capsys.readouterr().err
    assert Path.cwd() == tmp_path / "here" and not list(Path.cwd().iterdir())


@pytest.mark.parametrize("faces, message", [
    (FACES[1:], "the surface is open: edge"),
    (np.concatenate([FACES, FACES[:1]]), "found the same corners as at 0"),
    (np.concatenate([FACES, [[1, 1, 2]]]), "found a face with vertex 1 twice"),
])
def test_what_is_not_closed_is_refused(tmp_path, capsys, faces, message):
    code, target = fill(written(tmp_path / "surface.ply", POINTS, faces))
    assert code == 2 and message in capsys.readouterr().err and not target.exists()


def test_without_the_package_it_says_what_installs_it(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "tetgen", None)
    assert fill(written(tmp_path / "surface.ply"))[0] == 2
    told = capsys.readouterr().err
    assert "tetgen (MIT; TetGen within it AGPL-3.0) is not installed" in told and tetrahedra.INSTALL in told
    file = Path(__file__).resolve().parents[2] / tetrahedra.INSTALL.split()[-1]
    assert "tetgen==" in file.read_text() and "AGPL-3.0" in file.read_text()


@pytest.mark.parametrize("words, message", [
    (["--edge", "0.1"], "--tetrahedra with it"), (["--tetrahedra", "--edge", "0"], "a length > 0"), (["--tetrahedra", "--skin"], "contradict"),
    (["--tetrahedra", "--edge", "nan"], "a finite number"),
])
def test_options_that_do_not_go_together_are_refused(tmp_path, capsys, words, message):
    assert mesh_file.main([str(written(tmp_path / "a.vtu")), str(tmp_path / "out.ply"), *words]) == 2
    assert message in capsys.readouterr().err


def test_a_surface_is_triangles_alone(tmp_path, capsys):
    meshio.Mesh(POINTS, [("triangle", FACES), ("line", np.array([[0, 1]]))]).write(tmp_path / "a.vtu")
    assert fill(tmp_path / "a.vtu")[0] == 2 and "1 lone edges and 0 tetrahedra" in capsys.readouterr().err
    written(tmp_path / "b.ply").rename(tmp_path / "b.xyz")
    assert fill(tmp_path / "b.xyz")[0] == 2 and ".obj, .ply, .stl" in capsys.readouterr().err.replace("allowed: .msh, .vtu, .ply, .obj, .stl", ".obj, .ply, .stl")
