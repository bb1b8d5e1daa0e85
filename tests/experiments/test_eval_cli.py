"""`eval` as another program sees it: every kind through the command line, queries and answers against the schema."""

import json
import math
import subprocess
from pathlib import Path

import jsonschema
import pytest

SCHEMA = json.loads((Path(__file__).resolve().parents[2] / "configs/schema/eval.schema.json").read_text())
SQUARE = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
POINTS = [[0, 0, 1], [0, 0, 0]]
MOVED = [[0, 0, 0.1], [1.2, 0, 0], [0, 0.9, 0.05]]

QUERIES = [
    {"kind": "shape", "shape": "log", "d": 0.25, "d_hat": 1, "id": [1, "a"]},
    {"kind": "shape", "shape": "log", "d": 0, "d_hat": 1, "precision": "float"},
    {"kind": "rho", "shape": "cubic", "u": 0.5},
    {"kind": "rho", "shape": "quadratic", "derivative": "included", "u": 0.5},
    {"kind": "equilibrium", "shape": "cubic", "derivative": "included", "kappa": 10, "d_hat": 0.1, "load": 1000},
    {"kind": "equilibrium", "shape": "cubic", "kappa": 10, "d_hat": 0.1, "load": 1},
    {"kind": "equilibrium", "shape": "cubic", "kappa": 10, "d_hat": 0.1, "load": 1000},
    {"kind": "match", "rule": "equal_force", "shape": "log", "d_hat": 0.1, "load": 2},
    {"kind": "match", "rule": "equal_curvature", "shape": "log", "d_hat": 0.1, "curvature": 2, "theta": 0.25},
    {"kind": "distance", "pair": "point_edge", "points": SQUARE},
    {"kind": "ccd", "pair": "point_triangle", "points_t0": [[0.2, 0.2, 1], *SQUARE], "points_t1": [[0.2, 0.2, -1], *SQUARE]},
    {"kind": "intersects", "segment": [[0.2, 0.2, -1], [0.2, 0.2, 1]], "triangle": SQUARE},
    {"kind": "stiffness", "policy": "fixed", "kappa": 3},
    {"kind": "stiffness", "policy": "elasticity_inclusive", "mass_term": "inertia", "dt": 0.1, "c": 1, "elastic_term": False,
     "weights": [1], "normal": [0, 0, 1], "gap": 0.5, "masses": [3], "hessian": [[2, 0, 0], [0, 2, 0], [0, 0, 2]]},
    {"kind": "stiffness", "policy": "elasticity_inclusive", "mass_term": "scaled", "dt": 0.1, "c": 1, "elastic_term": False,
     "weights": [1], "normal": [0, 0, 1], "gap": 0.5, "d_hat": 1, "masses": [3]},
    {"kind": "strain_limit", "shape": "cubic", "sigma": [1.015, 1.0, 1.5], "onset": 0.01, "width": 0.01},
    {"kind": "strain_limit", "shape": "log", "F": [[1.5, 0], [0, 1], [0, 0]], "onset": 0.01, "width": 0.01},
    *({"kind": "energy", "model": model, "rest": SQUARE, "x": MOVED, "lame_mu": 3, "lame_lambda": 2}
      for model in ("corotational", "arap", "stvk", "stable_neo_hookean", "baraff_witkin")),
    {"kind": "energy", "model": "spring", "rest": SQUARE[:2], "x": MOVED[:2], "k": 8},
    {"kind": "energy", "model": "cloth_spring", "rest": SQUARE[:2], "x": MOVED[:2], "tension": 8, "compression_exponential": 2, "exponent": 4},
    {"kind": "energy", "model": "hinge", "x": [[0, 0, 0], [1, 0, 0], [0, 1, 0.2], [0, -1, 0]], "k": 2, "rest_angle": 0.1, "exponential": 1},
    {"kind": "energy", "model": "hinge", "x": [[0, 0, 0], [1, 0, 0], [0, 1, 0.2], [0, -1, 0]], "k": 2, "rest_angle": 0.1},
    {"kind": "energy", "model": "rod_bend", "x": SQUARE, "k": 2, "rest_angle": 0.1},
    {"kind": "energy", "model": "rod_bend", "rest": SQUARE, "x": [[0, 0, 0], [1, 0, 0], [3, 0, 0]], "k": 2, "rest_angle": 0.1, "precision": "float"},
    *({"kind": "friction", "law": law, "mu": 0.5, "load": 2, "eps": 0.1, "pair": "point_point", "points_lagged": POINTS,
       "points_start": POINTS, "points_end": [[0.03, 0.01, 2], [0, 0, 0]]} for law in ("smoothed_coulomb", "capped")),
    {"kind": "svd", "F": [[3, 0], [0, -2]]},
    *({"kind": "condition", "rows": [0, 1, 1], "cols": [0, 0, 1], "values": [2, 1, 2], "scaling": scaling, "tier": tier}
      for scaling in ("none", "jacobi", "block_jacobi") for tier in range(5)),
]


def ask(program: str, lines: str, *arguments: str) -> subprocess.CompletedProcess:
    return subprocess.run([program, "eval", *arguments], input=lines, capture_output=True, text=True, check=False)


def definition(name: str) -> jsonschema.Draft202012Validator:
    return jsonschema.Draft202012Validator({"$ref": f"#/$defs/{name}", "$defs": SCHEMA["$defs"]})


def test_every_kind_is_asked():
    kinds = {name.removeprefix("query_") for name in SCHEMA["$defs"] if name.startswith("query_")}
    assert {q["kind"] for q in QUERIES} == kinds


def test_queries_and_answers_follow_the_schema(program):
    done = ask(program, "".join(json.dumps(q) + "\n" for q in QUERIES))

    assert done.returncode == 0, done.stdout
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(answers) == len(QUERIES)
    root = jsonschema.Draft202012Validator(SCHEMA)
    for query, answer in zip(QUERIES, answers):
        root.validate(query)
        definition("answer_" + query["kind"]).validate(answer)
        assert answer.get("id") == query.get("id")


@pytest.mark.parametrize("query", QUERIES, ids=lambda q: q["kind"])
def test_schema_and_program_refuse_the_same_queries(program, query):
    """Each field dropped, and one added: both must agree whether the query is good."""
    variants = [{k: v for k, v in query.items() if k != dropped} for dropped in query]
    variants.append({**query, "surplus": 1})
    root = jsonschema.Draft202012Validator(SCHEMA)

    done = ask(program, "".join(json.dumps(v) + "\n" for v in variants))

    assert done.returncode == 2
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    for variant, answer in zip(variants, answers, strict=True):
        assert root.is_valid(variant) == ("error" not in answer), (variant, answer)
        if "error" in answer:
            definition("error").validate(answer)


def test_files_and_dashes(program, tmp_path):
    path = tmp_path / "queries.jsonl"
    path.write_text(json.dumps(QUERIES[2]) + "\r\n\r\n")
    from_file = ask(program, "", str(path))
    from_dash = ask(program, path.read_text(), "-")

    assert (from_file.returncode, from_dash.returncode) == (0, 0)
    assert from_file.stdout == from_dash.stdout
    assert json.loads(from_file.stdout)["rho"] == pytest.approx(4)


def test_a_missing_file_is_exit_2_without_answers(program, tmp_path):
    done = ask(program, "", str(tmp_path / "nowhere.jsonl"))

    assert done.returncode == 2
    assert done.stdout == ""
    assert "nowhere.jsonl" in done.stderr


def test_analytic_laws(program):
    """Rest gap, stiffness and rho of log, quadratic and cubic against their closed forms."""
    kappa, d_hat = 40.0, 0.01
    loads = [0.001, 0.1, 0.7]
    lines = [{"kind": "equilibrium", "shape": s, "kappa": kappa, "d_hat": d_hat, "load": f}
             for s in ("quadratic", "cubic", "log") for f in loads]
    done = ask(program, "".join(json.dumps(q) + "\n" for q in lines))
    answers = [json.loads(line) for line in done.stdout.splitlines()]

    for query, answer in zip(lines, answers, strict=True):
        f, u = query["load"], answer["d"] / d_hat
        e = 1 - u
        if query["shape"] == "quadratic":
            assert answer["d"] == pytest.approx(d_hat - f / (2 * kappa), rel=1e-9)
            assert answer["K"] == pytest.approx(2 * kappa, rel=1e-9)
        elif query["shape"] == "cubic":
            assert answer["d"] == pytest.approx(d_hat * (1 - math.sqrt(f / (2 * kappa * d_hat))), rel=1e-9)
            assert answer["K"] == pytest.approx(math.sqrt(8 * kappa * f / d_hat), rel=1e-9)
        else:
            assert kappa * d_hat * e * (e / u - 2 * math.log(u)) == pytest.approx(f, rel=1e-9)
            assert answer["K"] == pytest.approx(kappa * (-2 * math.log(u) + 4 * e / u + e * e / (u * u)), rel=1e-9)
            assert answer["capacity"] is None


BARAFF = {"kind": "energy", "model": "baraff_witkin", "rest": [[0.1, 0, 0], [1, 0.7, 0], [0.2, 1.1, 0.3]], "x": [[0, 0, 0], [1.3, 0.8, 0.1], [0.1, 1.5, 0.2]], "lame_mu": 3, "lame_lambda": 2}


def answers(program: str, queries: list) -> list:
    return [json.loads(line) for line in ask(program, "".join(json.dumps(q) + "\n" for q in queries)).stdout.splitlines()]


def test_warp_is_x_as_of_a_body_and_not_the_order_of_the_corners(program):
    """In the plane of the triangle at rest: whichever corner comes first, the energy is that of the same warp."""
    turned = [{**BARAFF, "rest": BARAFF["rest"][k:] + BARAFF["rest"][:k], "x": BARAFF["x"][k:] + BARAFF["x"][:k]} for k in range(3)]
    others = [{**BARAFF, "warp_axis": axis} for axis in ([1, 0, 0], [-1, 0, 0], [0, 1, 0], [0.6, 0.8, 0])]
    e = [answer["energy"] for answer in answers(program, turned + others)]
    assert e[0] > 0
    assert e[1] == pytest.approx(e[0], rel=1e-12) and e[2] == pytest.approx(e[0], rel=1e-12)
    assert e[3] == e[0] and e[4] == pytest.approx(e[0], rel=1e-12)
    assert min(abs(e[5] / e[0] - 1), abs(e[6] / e[0] - 1)) > 1e-3  # it does depend on the direction


@pytest.mark.parametrize("change, message", [
    ({"model": "arap", "warp_axis": [1, 0, 0]}, "no direction"), ({"warp_axis": [2, 0, 0]}, "a unit vector"), ({"warp_axis": [1, 0]}, "/warp_axis"),
    ({"warp_axis": "x"}, "/warp_axis"), ({"rest": [[0, 0, 0], [0, 1, 0], [0, 0, 1]]}, "/warp_axis")])
def test_a_warp_that_cannot_be_is_refused(program, change, message):
    done = subprocess.run([program, "eval"], input=json.dumps(BARAFF | change) + "\n", capture_output=True, text=True, check=False)
    assert done.returncode == 2 and message in done.stdout, done.stdout
