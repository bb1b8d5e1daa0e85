"""Stiffness formulas with `potential: derived`: the force kappa(d) b'(d) from its potential, beside the policy that has it in
closed form, and what is refused."""

import ctypes
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from barrierbench_analysis.program.formula.compiled import compiled_policy

ROOT = Path(__file__).resolve().parents[2]
STRIP = str(ROOT / "configs/scenes/strip_on_disk.json")
BLOCK = str(ROOT / "configs/scenes/resting_block_1d.json")
SCALED = "m/(c*h^2)*(d_hat/d)^2 + k"


def bench(program, *words):
    environment = {**os.environ, "BARRIERBENCH_PYTHON": sys.executable}
    return subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False, timeout=300, env=environment)


def policy(**keys):
    return f"/formulation/stiffness_policy={json.dumps(keys)}"


def derived_policy(text, **keys):
    return policy(name="formula", formula=text, **{"refresh": "per_step", "potential": "derived", **keys})


def run(program, folder, scene, *settings):
    words = [word for setting in settings for word in ("--set", setting)]
    done = bench(program, "run", scene, *words, "--out", folder)
    assert done.returncode == 0, done.stderr
    record = json.loads((folder / "run.json").read_text())
    assert record["status"]["outcome"] == "ok" and record["summary"]["contacts"]["sum"] > 0
    return record


@pytest.mark.parametrize("shape", ["cubic", "quadratic"])
def test_a_run_is_that_of_the_closed_form(program, tmp_path, shape):
    common = (f'/formulation/shape="{shape}"', "/time/steps=12")
    built = run(program, tmp_path / "built", STRIP, policy(name="elasticity_inclusive", mass_term="scaled", refresh="per_step", derivative="included"), *common)
    mine = run(program, tmp_path / "formula", STRIP, derived_policy(SCALED), *common)
    assert mine["summary"]["newton_iterations"] == built["summary"]["newton_iterations"]
    assert mine["summary"]["gap_min_m"] == pytest.approx(built["summary"]["gap_min_m"], rel=1e-8)
    assert mine["summary"]["contact_load_max_N"] == pytest.approx(built["summary"]["contact_load_max_N"], rel=1e-8)
    dropped = run(program, tmp_path / "dropped", STRIP, policy(name="formula", formula=SCALED, refresh="per_step"), *common)
    assert dropped["summary"]["gap_min_m"] != pytest.approx(mine["summary"]["gap_min_m"], rel=1e-3)
    message = [record["config"]["formulation"]["stiffness_policy"] for record in (mine, dropped)]
    assert message[0]["potential"] == "derived" and "potential" not in message[1]  # an id from before the key stays


@pytest.mark.parametrize("shape, argument", [("log", "gap"), ("log", "squared_gap"), ("two_stage", "gap"), ("minimax", "gap"), ("formula:(d_hat - d)^3/d_hat", "gap")])
def test_a_body_rests_where_the_number_lets_it_rest(program, tmp_path, shape, argument):
    """Shapes without a potential of 1/d^2: the force is that of kappa as a number of every iterate."""
    text, common = "20*m/(c*h^2)*exp(-d/d_hat)", (f'/formulation/shape="{shape}"', f'/formulation/argument="{argument}"')
    number = run(program, tmp_path / "number", BLOCK, policy(name="formula", formula=text), *common)
    derived = run(program, tmp_path / "derived", BLOCK, derived_policy(text), *common)
    assert derived["summary"]["gap_min_m"] == pytest.approx(number["summary"]["gap_min_m"], rel=1e-4)
    (one,), (other,) = (record["steps"][-1]["contacts"]["total"] and [record["steps"][-1]["gap_min_m"]] for record in (number, derived))
    assert 0 < one and other == pytest.approx(one, rel=1e-6)


@pytest.mark.parametrize("keys, pointer, found", [
    ({"formula": "m/(c*h^2) + k"}, "potential", "does not depend on the gap"),
    ({"formula": SCALED, "refresh": "per_iteration"}, "refresh", "a potential is frozen for a step"),
    ({"formula": "m/h^2*(d/d_hat)^2"}, "potential", "a force that falls as the gap closes, at d = "),
    ({"formula": "m/h^2*(d_hat/d)^2*(1 + 1e-7*sin(3000*d/d_hat))"}, "potential", "integral is off by "),
    ({"formula": SCALED, "potential": "maybe"}, "potential", "maybe"),
])
def test_what_has_no_potential_is_named(program, keys, pointer, found):
    given = policy(**{"name": "formula", "refresh": "per_step", "potential": "derived", **keys})
    done = bench(program, "check", STRIP, "--set", given, "--set", '/formulation/shape="cubic"')
    assert done.returncode == 2 and f"#/formulation/stiffness_policy/{pointer}" in done.stderr, done.stderr
    assert found in done.stderr and "allowed: " in done.stderr and "internal" not in done.stderr


def test_a_step_solver_beyond_contact_and_a_device_have_none(program):
    words = ("--set", derived_policy(SCALED), "--set", '/formulation/shape="cubic"')
    done = bench(program, "check", STRIP, *words, "--set", '/step_solver/name="penalty"')
    assert done.returncode == 2 and "none: the step solver is penalty" in done.stderr
    done = bench(program, "check", STRIP, *words, "--set", '/device="host"')
    assert done.returncode == 2 and "a policy with a device form" in done.stderr


def test_the_library_has_kappa_and_its_slope():
    made = compiled_policy("m/(c*h^2)*(d_hat/d)^2 + k*exp(-3*d/d_hat)")
    assert made.about["reads_gap"] and made.about["slope_error_rel"] < 1e-13
    call = ctypes.CDLL(str(made.library)).barrierbench_formula_in_gap
    call.restype, call.argtypes = None, [ctypes.c_double] * 5 + [ctypes.c_size_t] + [ctypes.POINTER(ctypes.c_double)] * 3
    gaps, n = [0.001, 0.004, 0.009], 3
    kappa, slope = (ctypes.c_double * n)(), (ctypes.c_double * n)()
    call(2.0, 5.0, 0.1, 0.5, 0.01, n, (ctypes.c_double * n)(*gaps), kappa, slope)
    for d, k, s in zip(gaps, kappa, slope, strict=True):
        inertia, elastic = 2 / (0.5 * 0.1**2) * (0.01 / d) ** 2, 5 * 2.718281828459045 ** (-300 * d)
        assert k == pytest.approx(inertia + elastic, rel=1e-12)
        assert s == pytest.approx(-2 * inertia / d - 300 * elastic, rel=1e-12) and s < 0
    assert not compiled_policy("m/h^2").about["reads_gap"]
