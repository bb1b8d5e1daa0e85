"""Shapes, geometry, condition numbers and lists against closed forms, differences and the verb eval."""

import doctest
import importlib
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

MODULES = ("shape", "geometry", "condition", "queries", "scene", "python_policies", "python_shapes", "python_step_solvers", "simulation", "step")


@pytest.mark.parametrize("name", MODULES)
def test_doctests_run(bb, name):
    module = importlib.import_module(f"barrierbench.{name}")
    found = doctest.testmod(module, optionflags=doctest.IGNORE_EXCEPTION_DETAIL)
    assert found.attempted > 0 and found.failed == 0


def test_cubic_is_its_formula(bb):
    d_hat, d = 0.01, np.linspace(0, 0.012, 25)
    b, db, d2b = bb.Shape("cubic")(d, d_hat)
    s = np.maximum(d_hat - d, 0)
    assert np.allclose(b, 2 / (3 * d_hat) * s**3, rtol=1e-14, atol=0) and b.max() > 0
    assert np.allclose(db, -2 / d_hat * s**2, rtol=1e-14, atol=0)
    assert np.allclose(d2b, 4 / d_hat * s, rtol=1e-14, atol=0)


@pytest.mark.parametrize("argument", ["gap", "squared_gap"])
def test_every_shape_has_its_derivatives(bb, argument):
    d_hat, d, h = 0.01, np.linspace(0.002, 0.009, 8), 1e-8
    for name in bb.shapes():
        shape = bb.Shape(name.replace(":A", ":4").replace(":TEXT", ":(d_hat - d)^3/d_hat"), argument)
        up, here, down = shape(d + h, d_hat), shape(d, d_hat), shape(d - h, d_hat)
        assert np.abs(here.db).min() > 0
        assert np.allclose((up.b - down.b) / (2 * h), here.db, rtol=2e-5)
        assert np.allclose((up.db - down.db) / (2 * h), here.d2b, rtol=2e-5)


def test_shapes_broadcast_and_say_what_is_wrong(bb):
    log = bb.Shape("log")
    assert log(np.full((3, 1), 0.005), np.full(4, 0.01)).b.shape == (3, 4)
    assert log(0.005, 0.01).b.shape == ()
    assert np.isinf(log(0.0, 0.01).b)
    with pytest.raises(bb.ConfigError, match=r"d\[1\]: found -0.1\d*; allowed: a gap >= 0 m"):
        log([0.1, -0.1], 0.01)
    with pytest.raises(bb.ConfigError, match=r"did you mean log\?"):
        bb.Shape("logg")


def test_arguments_and_rules_are_told_apart(bb):
    """The cubic on the squared gap: D = d^2, b' = -4 d (1 - u^2)^2, b'' = -4 (1 - u^2)^2 + 16 u^2 (1 - u^2)."""
    d_hat, u = 0.01, 0.75
    squared, plain = bb.Shape("cubic", argument="squared_gap"), bb.Shape("cubic")
    e = 1 - u * u
    assert squared(u * d_hat, d_hat).db == pytest.approx(-4 * u * d_hat * e**2, rel=1e-12)
    assert squared.rho(u) == pytest.approx((16 * u**2 * e - 4 * e**2) / (4 * u * e**2), rel=1e-12)
    assert plain.equal_curvature(d_hat, 3.0, theta=u) == pytest.approx(3 / (4 * (1 - u)), rel=1e-12)
    assert plain.equal_force(d_hat, 3.0, theta=u) == pytest.approx(3 / (2 * d_hat * (1 - u) ** 2), rel=1e-12)
    assert plain.equal_curvature(d_hat, 3.0) == pytest.approx(1.5) and plain.equal_force(d_hat, 3.0) == pytest.approx(3 / (2 * d_hat * 0.81))


def test_lists_are_those_of_the_registries(bb):
    from barrierbench import scene

    for entries, name in ((scene.policies, "elasticity_inclusive"), (scene.step_solvers, "line_search"), (scene.linear_solvers, "pcg"), (scene.generators, "grid")):
        assert name in [entry.name for entry in entries()]


def test_matching_inverts_equilibrium(bb):
    shape = bb.Shape("log")
    kappa = shape.equal_force(d_hat=0.01, load=2.0, theta=0.3)
    found = shape.equilibrium(kappa, 0.01, 2.0)
    assert found.d_m == pytest.approx(0.003, rel=1e-9) and found.capacity_N is None
    assert bb.Shape("cubic").equilibrium(1.0, 0.01, 1.0).above_capacity


@pytest.mark.parametrize("pair", ["point_point", "point_edge", "point_triangle", "edge_edge"])
def test_distance_has_its_derivatives(bb, pair):
    from barrierbench.geometry import POINTS, distance_hessian

    x = np.random.default_rng(3).normal(size=(5, 4, POINTS[pair], 3))
    found, h = bb.distance(pair, x), 1e-6
    second = distance_hessian(pair, x)
    assert found.d.shape == (5, 4) and found.d.min() > 0
    assert np.allclose(np.einsum("...n,...nk->...k", found.weights, x), found.r, atol=1e-12)
    smooth = np.ones((5, 4), bool)
    numeric = np.empty_like(second)
    gradient = np.empty_like(found.gradient)
    for i in range(POINTS[pair]):
        for k in range(3):
            step = np.zeros_like(x)
            step[..., i, k] = h
            up, down = bb.distance(pair, x + step), bb.distance(pair, x - step)
            smooth &= (up.region == found.region) & (down.region == found.region)
            gradient[..., i, k] = (up.d - down.d) / (2 * h)
            numeric[..., 3 * i + k] = ((up.gradient - down.gradient) / (2 * h)).reshape(5, 4, -1)
    assert smooth.sum() >= 15
    assert np.allclose(gradient[smooth], found.gradient[smooth], atol=1e-7)
    assert np.allclose(numeric[smooth], second[smooth], atol=1e-5 * np.abs(second).max())


def test_accd_stops_before_a_head_on_contact(bb):
    x0 = np.array([[[0.2, 0.2, 1], [0, 0, 0], [1, 0, 0], [0, 1, 0]]] * 2, float)
    x1 = x0.copy()
    x1[:, 0, 2] = [-1, 0.5]
    found = bb.accd("point_triangle", x0, x1)
    assert found.hit.tolist() == [True, False] and found.toi[1] == 1
    assert 0.5 - 1e-9 < found.toi[0] <= 0.5
    with pytest.raises(bb.ConfigError, match="as many as at t = 0: 2"):
        bb.accd("point_triangle", x0, x1[:1])
    with pytest.raises(bb.ConfigError, match="a finite number"):
        bb.accd("point_triangle", x0 * np.nan, x1)


@pytest.mark.parametrize("indices, indptr", [([0, 7], [0, 1, 2]), ([0, -1], [0, 1, 2]), ([0, 1], [0, 2, 1]), ([0, 1], [0, 1, 9]), ([0, 2**31 - 1], [0, 1, 2])])
@pytest.mark.parametrize("form", ["csr_matrix", "csc_matrix"])
def test_indices_beyond_a_matrix_are_refused(bb, form, indices, indptr):
    """scipy takes them when they are put into a matrix that is there, and reads memory that is not the matrix's."""
    sparse = pytest.importorskip("scipy.sparse")
    matrix = getattr(sparse, form)(np.eye(2))
    matrix.indices, matrix.indptr = np.array(indices, np.int32), np.array(indptr, np.int32)
    with pytest.raises(bb.ConfigError, match="matrix: found .*; allowed: indices within its shape"):
        bb.condition_number(matrix)
    triplets = sparse.coo_matrix(np.eye(2))
    triplets.row = np.array([0, 5], np.int32)
    with pytest.raises(bb.ConfigError, match="an index out of the range 0 to 1"):
        bb.condition_number(triplets)


def test_what_is_no_regular_file_is_no_config(bb, tmp_path):
    os.mkfifo(tmp_path / "fifo")
    (tmp_path / "latin.json").write_bytes(b'{"name": "\xe4"}')
    (tmp_path / "large.json").write_bytes(b"")
    os.truncate(tmp_path / "large.json", 1 << 40)
    for path, found in (("/dev/zero", "no regular file"), (tmp_path / "fifo", "no regular file"), (tmp_path, "a folder"), (tmp_path / "none.json", "No such file"),
                        (tmp_path / "latin.json", "bytes that are not UTF-8"), (tmp_path / "large.json", "1099511627776 bytes")):
        for call in (bb.resolve, bb.Simulation, bb.run):
            with pytest.raises(bb.ConfigError, match=f"{path}: found {found}"):
                call(path)


def test_condition_number_is_that_of_numpy(bb):
    sparse = pytest.importorskip("scipy.sparse")
    n = 30
    matrix = sparse.diags([-np.ones(n - 1), 2.001 * np.ones(n), -np.ones(n - 1)], [-1, 0, 1])
    for tier in (2, 3, 4):
        found = bb.condition_number(matrix, tier=tier)
        assert found.status == "ok" and found.cond == pytest.approx(np.linalg.cond(matrix.toarray()), rel=1e-5)
    assert bb.condition_number(-matrix).status == "not_pd"
    assert bb.condition_number(sparse.tril(matrix), tier=3) == bb.condition_number(matrix, tier=3)
    twice = sparse.coo_matrix(([1.0, 1.0, 5.0], ([0, 0, 1], [0, 0, 1])))
    assert bb.condition_number(twice, tier=3).cond == 2.5
    with pytest.raises(bb.ConfigError, match="scaling.*jacobi"):
        bb.condition_number(matrix, scaling="jacoby")
    with pytest.raises(bb.ConfigError, match="across the diagonal"):
        bb.condition_number(sparse.triu(matrix))
    for shape in ((2, 3), (3, 2)):
        with pytest.raises(bb.ConfigError, match="a square matrix"):
            bb.condition_number(np.ones(shape))
    with pytest.raises(bb.ConfigError, match="tier"):
        bb.condition_number(matrix, tier=0)


def test_evaluate_is_the_verb(bb, program):
    queries = [
        {"id": 1, "kind": "shape", "shape": "log", "argument": "gap", "d": 0.003, "d_hat": 0.01},
        {"id": 2, "kind": "rho", "shape": "exponential:3", "argument": "gap", "u": 0.25},
    ]
    text = "".join(json.dumps(query) + "\n" for query in queries)
    done = subprocess.run([program, "eval"], input=text, capture_output=True, text=True, check=True)
    assert [bb.evaluate(query) for query in queries] == [json.loads(line) for line in done.stdout.splitlines()]
    with pytest.raises(bb.ConfigError, match="kind"):
        bb.evaluate({"kind": "shap"})


@pytest.mark.parametrize("text", ['{"id": 1, "kind": "svd", "F": [[3, 0], [0, 1]]}\n', '{"id": 2, "kind": "svd"}\n', "nonsense\n", "\n"])
def test_the_script_is_the_verb(bb, program, tmp_path, text):
    """The same bytes and exit code, from a file and from the standard input."""
    script = [sys.executable, "-m", "barrierbench.eval"]
    environment = os.environ | {"PYTHONPATH": str(Path(bb.__file__).parents[1])}
    file = tmp_path / "queries.jsonl"
    file.write_text(text)
    for words, fed in ((["-"], text), ([str(file)], ""), (["--schema"], "")):
        own, verb = (
            subprocess.run([*command, *words], input=fed, capture_output=True, text=True, env=environment, check=False)
            for command in (script, [program, "eval"])
        )
        assert (own.returncode, own.stdout, own.stderr) == (verb.returncode, verb.stdout, verb.stderr)
    for words in ([str(file), str(file)], [str(tmp_path / "nowhere.jsonl")], ["--no-such"]):
        own = subprocess.run([*script, *words], capture_output=True, text=True, env=environment, check=False)
        assert own.returncode == 2 and own.stdout == "" and own.stderr


def test_a_scene_is_that_of_the_config(bb, drape):
    scene = bb.build_scene(drape)
    assert scene.x0.shape == (64, 3) and scene.faces.shape == (98, 3) and scene.faces.max() == 63
    assert scene.obstacles and scene.mass.sum() == pytest.approx(0.15, rel=1e-9)
    with pytest.raises(bb.ConfigError, match="/scene/layers"):
        bb.build_scene({"scene": {"name": "drape", "layers": 0}})
    with pytest.raises(bb.ConfigError, match="/time/step.*did you mean") as reported:
        bb.resolve({"scene": {"name": "drape"}, "time": {"step": 3}}, {"/seeds/jitter": "x"})
    assert isinstance(reported.value, ValueError)
