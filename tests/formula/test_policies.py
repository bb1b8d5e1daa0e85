"""Stiffness policies as formulas: beside the policy of the same formula that the program has, and what is refused."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from barrierbench_analysis.program.formula.compiled import compiled_policy
from barrierbench_analysis.program.formula.grammar import FormulaError

ROOT = Path(__file__).resolve().parents[2]
STRIP = str(ROOT / "configs/scenes/strip_on_disk.json")
SAME = {
    "inertia": ("m/(c*h^2) + k", {"mass_term": "inertia"}),
    "scaled": ("m/(c*h^2)*(d_hat/d)^2 + k", {"mass_term": "scaled", "refresh": "per_step"}),
    "none": ("k", {"mass_term": "none"}),
    "no H": ("m/(c*h^2)", {"mass_term": "inertia", "elastic_term": False}),
}


def bench(program, *words):
    environment = {**os.environ, "BARRIERBENCH_PYTHON": sys.executable}
    return subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False, timeout=300, env=environment)


def policy(**keys):
    return f"/formulation/stiffness_policy={json.dumps(keys)}"


@pytest.mark.parametrize("name", SAME)
def test_a_run_is_that_of_the_policy_with_the_same_formula(program, tmp_path, name):
    text, keys = SAME[name]
    refresh = {"refresh": keys.get("refresh", "per_iteration")}
    records = []
    for folder, given in (("built", {"name": "elasticity_inclusive", **keys}), ("formula", {"name": "formula", "formula": text, **refresh})):
        done = bench(program, "run", STRIP, "--set", policy(**given), "--set", '/formulation/shape="cubic"', "--set", '/integrator/name="bdf2"', "--set", "/time/steps=12", "--out", tmp_path / folder)
        records.append(json.loads((tmp_path / folder / "run.json").read_text()))
        assert done.returncode in (0, 75), done.stderr
    built, mine = (record["summary"] for record in records)
    assert built["contacts"]["sum"] > 0 and built["contact_load_max_N"] > 0
    assert mine["newton_iterations"] == built["newton_iterations"]
    assert mine["contact_load_max_N"] == pytest.approx(built["contact_load_max_N"], rel=1e-9)
    assert mine["gap_min_m"] == pytest.approx(built["gap_min_m"], rel=1e-9)
    made = compiled_policy(text)
    assert records[1]["config"]["formulation"]["stiffness_policy"]["formula"] == made.about["formula"]
    assert [p["sha256"] for p in records[1]["provenance"]["plugins"]] == [made.about["library_sha256"]]


def test_the_gap_enters(program, tmp_path):
    """Not all formulas give one run."""
    gaps = set()
    for power in (0, 2):
        given = {"name": "formula", "formula": f"m/h^2*(d_hat/d)^{power}", "refresh": "per_step"}
        done = bench(program, "run", STRIP, "--set", policy(**given), "--set", "/time/steps=12", "--out", tmp_path / str(power))
        assert done.returncode == 0, done.stderr
        gaps.add(json.loads((tmp_path / str(power) / "run.json").read_text())["summary"]["gap_min_m"])
    assert len(gaps) == 2


def test_spellings_of_one_tree_are_one_config(program):
    message = [bench(program, "explain", STRIP, "--set", policy(name="formula", formula=text)) for text in ("m/h^2+k", "m / (h**2) + k", "k + m/h^2")]
    first = [done.stdout.splitlines()[0] for done in message]
    assert first[0] == first[1] != first[2], message[0].stderr


@pytest.mark.parametrize("keys, found", [
    ({}, "found nothing"),
    ({"formula": "m/h"}, "the unit kg s^-1"),
    ({"formula": "m/h^2 + d"}, "the sum of kg s^-2 and m"),
    ({"formula": "m/h^2 - k"}, "kappa = "),
    ({"formula": "m/h^2/(d_hat - d)*d"}, "no kappa at m = "),
    ({"formula": "k*sqrt(d/d_hat - 1)"}, "no real kappa"),
    ({"formula": "0*k"}, "kappa = 0 at all"),
    ({"formula": "__import__('os').system('true')"}, "the call"),
    ({"formula": "kappa"}, 'the symbol "kappa"'),
    ({"formula": "m/h^2", "gap_floor": 0.1}, "0.1"),
])
def test_bad_policies_are_named_with_what_is_allowed(program, keys, found):
    done = bench(program, "check", STRIP, "--set", policy(name="formula", **keys))
    assert done.returncode == 2, done.stdout
    assert "#/formulation/stiffness_policy/" in done.stderr and found in done.stderr and "allowed: " in done.stderr and "internal" not in done.stderr


def test_a_card_and_a_strain_limit_have_none(program):
    given = policy(name="formula", formula="m/h^2")
    done = bench(program, "check", STRIP, "--set", given, "--set", '/device="host"')
    assert done.returncode == 2 and "a policy with a device form" in done.stderr
    done = bench(program, "check", STRIP, "--set", '/strain_limit/stiffness_policy={"name": "formula"}')
    assert done.returncode == 2 and "one of fixed, elasticity_inclusive" in done.stderr


def test_a_difference_that_double_precision_loses():
    with pytest.raises(FormulaError, match="in double precision at"):
        compiled_policy("k*(exp(d/d_hat*1e-9) - 1)*1e9")


def test_the_verb_says_what_a_policy_reads():
    done = subprocess.run([sys.executable, ROOT / "analysis", "formula", "--policy", "m/h^2 + k"], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0 and "reads m, k, h" in done.stdout, done.stderr
    done = subprocess.run([sys.executable, ROOT / "analysis", "formula", "--policy", "--at-zero", "finite", "k"], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "--at-zero" in done.stderr
