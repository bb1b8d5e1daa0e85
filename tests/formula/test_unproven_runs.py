"""A run says of its formula what `bench formula` says: signs that are only sampled; once in a sweep."""

import json

import pytest

from barrierbench_analysis.program.formula.compiled import compiled, signs_of
from test_program import BLOCK, bench, setting

# b'' meets 0 within the interval, and is not below it
SAMPLED = "d_hat^2*((1 - d/d_hat)^3/24 - (1 - d/d_hat)^4/12 + (1 - d/d_hat)^5/20)"
PROVEN = "(d - d_hat)^2"
FEW = ("--set", "/time/steps=1", "--set", "/formulation/stiffness_policy={\"name\": \"fixed\", \"kappa_N_per_m\": 1e9}")


def message(done) -> list[str]:
    assert done.returncode == 0, done.stderr
    return [line for line in done.stderr.splitlines() if "only sampled" in line]


@pytest.fixture()
def caveat(cache) -> str:
    made = compiled(SAMPLED)
    assert made.about["unproven"]
    return f"formula:{made.about['formula']}: the signs of b, b' and b'' are {signs_of(made.about['unproven'])}"


def test_a_run_and_its_rerun_say_it(program, tmp_path, caveat):
    assert message(bench(program, "run", BLOCK, *FEW, "--set", setting({"formula": SAMPLED}), "--out", tmp_path / "one")) == [caveat]
    assert message(bench(program, "run", tmp_path / "one/run.json", "--out", tmp_path / "two")) == [caveat]


def test_a_formula_that_is_proven_and_a_built_in_shape_have_none(program, tmp_path):
    for folder, shape in (("proven", {"formula": PROVEN}), ("built", "cubic")):
        assert message(bench(program, "run", BLOCK, *FEW, "--set", setting(shape), "--out", tmp_path / folder)) == []


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_a_sweep_says_it_once(program, tmp_path, caveat, jobs):
    spec = {"schema": "barrierbench.sweep/1", "name": "sampled", "base": str(BLOCK), "set": {"/formulation/shape": {"formula": SAMPLED}},
            "axes": [{"pointer": "/time/steps", "values": [1, 2, 3]}]}
    (tmp_path / "sweep.json").write_text(json.dumps(spec))
    done = bench(program, "sweep", tmp_path / "sweep.json", "--out", tmp_path / "out", "--jobs", jobs, *FEW[2:])
    assert message(done) == [caveat] and len(list((tmp_path / "out").glob("*/run.json"))) == 3
