"""Formulas as the program meets them: in configs, sweeps, eval and records, beside the built-in shapes of the same formula."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from barrierbench_analysis.program.formula import cache as kept
from barrierbench_analysis.program.formula import device
from barrierbench_analysis.program.formula.compiled import compiled
from barrierbench_analysis.program.formula.grammar import FormulaError

ROOT = Path(__file__).resolve().parents[2]
BLOCK = str(ROOT / "configs/scenes/resting_block_1d.json")
STRIP = str(ROOT / "configs/scenes/strip_on_disk.json")
BUILT_IN = {
    "log": ("-(d - d_hat)^2*log(d/d_hat)", "infinite"),
    "cubic": ("2/(3*d_hat)*(d_hat - d)^3", "finite"),
    "quadratic": ("(d - d_hat)^2", "finite"),
}
ULP = 2.0**-52


def bench(program, *words, given="", **more):
    environment = {**os.environ, "BARRIERBENCH_PYTHON": sys.executable, **more}
    return subprocess.run([program, *map(str, words)], input=given, capture_output=True, text=True, check=False, timeout=300, env=environment)


def answers(program, queries):
    done = bench(program, "eval", given="".join(json.dumps(q) + "\n" for q in queries))
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


def setting(shape):
    return f"/formulation/shape={json.dumps(shape)}"


@pytest.mark.parametrize("name", BUILT_IN)
@pytest.mark.parametrize("argument", ["gap", "squared_gap"])
def test_values_are_those_of_the_built_in_shape(program, name, argument):
    gaps = [1e-9, 1e-4, 0.1, 0.5, 0.7, 0.999, 1 - 1e-6, 1, 2, 0]
    for precision, tolerance in (("double", 8 * ULP), ("float", 8 * 2.0**-23)):
        query = {"kind": "shape", "argument": argument, "d_hat": 1, "precision": precision}
        pairs = answers(program, [{**query, "d": 0.01 * u, "d_hat": 0.01, "shape": shape} for u in gaps for shape in (name, "formula:" + BUILT_IN[name][0])])
        assert len(pairs) == 2 * len(gaps)
        for u, mine, theirs in zip(gaps, pairs[1::2], pairs[::2], strict=True):
            for key in ("b", "db", "d2b"):
                if isinstance(theirs[key], str) or theirs[key] is None:  # infinity
                    assert mine[key] == theirs[key], (u, key)
                else:
                    assert mine[key] == pytest.approx(theirs[key], rel=tolerance, abs=0), (u, key)
                    assert u >= 1 or u == 0 or theirs[key] != 0


@pytest.mark.parametrize("name", BUILT_IN)
def test_a_run_is_that_of_the_built_in_shape(program, tmp_path, name):
    text, at_zero = BUILT_IN[name]
    for folder, shape in (("built", name), ("formula", {"formula": text, "at_zero": at_zero})):
        done = bench(program, "run", BLOCK, "--set", setting(shape), "--out", tmp_path / folder)
        assert done.returncode == 0, done.stderr
    built, mine = (json.loads((tmp_path / folder / "run.json").read_text()) for folder in ("built", "formula"))
    assert mine["status"]["outcome"] == built["status"]["outcome"] == "ok"
    assert built["summary"]["gap_min_m"] > 0
    assert mine["summary"]["gap_min_m"] == pytest.approx(built["summary"]["gap_min_m"], rel=1e-9)
    assert mine["summary"]["newton_iterations"] == built["summary"]["newton_iterations"]
    assert mine["matching"]["kappa_N_per_m"] == pytest.approx(built["matching"]["kappa_N_per_m"], rel=1e-12)


def test_record_keeps_text_and_hash_and_repeats_itself(program, tmp_path, cache):
    text, at_zero = BUILT_IN["log"]
    done = bench(program, "run", BLOCK, "--set", setting({"formula": text, "at_zero": at_zero}), "--out", tmp_path / "one")
    assert done.returncode == 0, done.stderr
    record = json.loads((tmp_path / "one/run.json").read_text())
    made = compiled(text)
    assert record["config"]["formulation"]["shape"] == record["labels"]["shape"] == f"formula:{made.about['formula']}"
    assert record["labels"]["formulation"] == made.about["label"]
    assert [p["sha256"] for p in record["provenance"]["plugins"]] == [made.about["library_sha256"]]
    again = bench(program, "run", tmp_path / "one/run.json", "--out", tmp_path / "two", BARRIERBENCH_CACHE=str(tmp_path / "empty"))
    assert again.returncode == 0 and "the same, bit for bit" in again.stdout, again.stdout + again.stderr


def test_spellings_of_one_tree_are_one_config(program):
    message = [bench(program, "explain", BLOCK, "--set", setting(shape)) for shape in (
        {"formula": "(d - d_hat)^2", "at_zero": "finite"}, {"formula": "((d-d_hat))**2"}, "formula: (d - d_hat) ^ 2", "formula:(d_hat - d)^2")]
    first = [done.stdout.splitlines()[0] for done in message]
    assert first[0] == first[1] == first[2] != first[3] and "formula-" in first[0], message[0].stderr


def test_the_strain_limit_takes_a_formula(program):
    done = bench(program, "explain", ROOT / "configs/scenes/drape2d.json", "--set", f"/strain_limit/shape={json.dumps({'formula': BUILT_IN['cubic'][0]})}")
    assert done.returncode == 0, done.stderr
    assert "formula:2 / (3 * d_hat) * (d_hat - d)^3" in done.stdout


def test_a_sweep_over_formulas(program, tmp_path):
    spec = {"schema": "barrierbench.sweep/1", "name": "formulas", "base": BLOCK,
            "axes": [{"cases": [{"label": "built", "set": {"/formulation/shape": "quadratic"}}, {"label": "typed", "set": {"/formulation/shape": {"formula": BUILT_IN["quadratic"][0]}}}]}]}
    (tmp_path / "sweep.json").write_text(json.dumps(spec))
    done = bench(program, "sweep", tmp_path / "sweep.json", "--out", tmp_path / "out", "--jobs", "2")
    assert done.returncode == 0, done.stderr
    records = [json.loads(path.read_text()) for path in (tmp_path / "out").rglob("run.json")]
    assert {r["labels"]["shape"] for r in records} == {"quadratic", "formula:(d - d_hat)^2"}


@pytest.mark.parametrize("shape, where, found", [
    ({"formula": "d_hat - d"}, "#/formulation/shape/formula", "the unit m"),
    ({"formula": "(d - d_hat)^2", "at_zero": "infinite"}, "#/formulation/shape/formula", 'at_zero "infinite"'),
    ({"formula": "__import__('os').system('touch /tmp/x')"}, "#/formulation/shape/formula", "the call"),
    ({"formula": "(d_hat - d)^4/(d - d_hat/3)^2"}, "#/formulation/shape/formula", "a division by 0 at d = 0.333333 d_hat"),
    ({"formula": "d_hat^2*exp(-d/d_hat)"}, "#/formulation/shape/formula", "a value that jumps at d_hat"),
    ({"formula": ""}, "#/formulation/shape/formula", '""'),
    ({"formula": 3}, "#/formulation/shape/formula", "3"),
    ({"at_zero": "finite"}, "#/formulation/shape/formula", "nothing"),
    ({"formula": "(d - d_hat)^2", "at_zero": "soft"}, "#/formulation/shape/at_zero", '"soft"'),
    ({"formula": "(d - d_hat)^2", "unit": "m"}, "#/formulation/shape/unit", "the unknown key"),
    ("formula:d*delta", "#/formulation/shape", 'the symbol "delta"'),
    ("formule:d", "#/formulation/shape", '"formule:d"'),
])
def test_bad_formulas_are_named_with_place_and_what_is_allowed(program, shape, where, found):
    done = bench(program, "check", BLOCK, "--set", setting(shape))
    assert done.returncode == 2, done.stdout + done.stderr
    assert f"{where}: found {found}" in done.stderr and "allowed: " in done.stderr and "internal" not in done.stderr


def test_a_bare_program_without_python_says_so(program):
    done = bench(program, "check", BLOCK, "--set", setting({"formula": "(d - d_hat)^2"}), BARRIERBENCH_PYTHON="/nowhere/python")
    assert done.returncode == 2 and "no Python at" in done.stderr and "./bench setup" in done.stderr


def test_a_python_without_the_library_says_so(program, tmp_path):
    (tmp_path / "python").write_text("#!/bin/sh\necho 'No module named analysis' >&2\nexit 1\n")
    (tmp_path / "python").chmod(0o755)
    done = bench(program, "check", BLOCK, "--set", setting({"formula": "(d - d_hat)^2"}), BARRIERBENCH_PYTHON=str(tmp_path / "python"))
    assert done.returncode == 2 and "No module named analysis" in done.stderr and "./bench setup" in done.stderr


def test_eval_says_what_is_wrong(program):
    done = bench(program, "eval", given=json.dumps({"kind": "shape", "shape": "formula:d", "d": 0.5, "d_hat": 1}) + "\n")
    assert "the unit m" in done.stdout


def test_a_card_takes_a_formula_where_nvcc_makes_a_kernel_of_it(program):
    """What is checked before a card is looked for, so that it is known on any machine."""
    on_a_card = ("check", BLOCK, "--set", '/device="cuda"', "--set")
    done = bench(program, *on_a_card, setting({"formula": "(d - d_hat)^2"}))
    if device.find_nvcc():
        assert done.returncode == 0, done.stderr
    else:
        assert done.returncode == 2 and "on a card, and no nvcc" in done.stderr
    done = bench(program, *on_a_card, setting("exponential:4"))
    assert done.returncode == 2 and "exponential:4" in done.stderr and "device cpu or host" in done.stderr
    drape = str(ROOT / "configs/scenes/drape.json")
    done = bench(program, "check", drape, *on_a_card[2:], setting({"formula": "(d - d_hat)^2"}), "--set", '/linear_solver/name="pcg_resident"')
    assert done.returncode == 2 and "/strain_limit" in done.stderr and "have no kernel" in done.stderr


@pytest.mark.parametrize("name, argument", [("log", "gap"), ("cubic", "squared_gap")])
def test_the_host_executor_calls_it_for_every_row(program, tmp_path, name, argument):
    """A strip that lands on a disk, by kernels on threads, beside the kernel of the built-in shape."""
    text, at_zero = BUILT_IN[name]
    for folder, shape in (("built", name), ("formula", {"formula": text, "at_zero": at_zero})):
        words = [f'/formulation/argument="{argument}"', '/device="host"', "/time/steps=12", setting(shape)]
        done = bench(program, "run", STRIP, *(word for one in words for word in ("--set", one)), "--out", tmp_path / folder)
        assert done.returncode == 0, done.stderr
    built, mine = (json.loads((tmp_path / folder / "run.json").read_text())["summary"] for folder in ("built", "formula"))
    assert built["contacts"]["sum"] > 0 and mine["newton_iterations"] == built["newton_iterations"]
    assert mine["gap_min_m"] == pytest.approx(built["gap_min_m"], rel=1e-7)
    done = bench(program, "explain", STRIP, "--set", setting({"formula": text}), "--set", '/device="host"')
    assert done.returncode == 0, done.stderr


def test_no_compiler_is_said(monkeypatch):
    monkeypatch.setenv("CXX", "/nowhere/c++")
    with pytest.raises(FormulaError, match='no compiler "/nowhere/c\\+\\+"'):
        compiled("(d - d_hat)^2")


def test_a_cut_library_is_made_again(tmp_path, monkeypatch):
    monkeypatch.setenv("BARRIERBENCH_CACHE", str(tmp_path))
    made = compiled("(d - d_hat)^2")
    whole = made.library.read_bytes()
    cut = tmp_path / "cut"
    cut.write_bytes(whole[: len(whole) // 2])
    cut.replace(made.library)  # a file of its own: the process has the whole one mapped
    assert kept.find(made.library.stem) is None
    assert compiled("(d - d_hat)^2").library.read_bytes() == whole
    assert not list((tmp_path / "formulas").glob("making-*"))


def test_a_formula_that_double_precision_loses():
    """exp(e) less its first four terms is e^4/24, which nothing of 1 is left of near d_hat."""
    text = "d_hat^2*(exp(1 - d/d_hat) - 1 - (1 - d/d_hat) - (1 - d/d_hat)^2/2 - (1 - d/d_hat)^3/6)"
    with pytest.raises(FormulaError, match="in double precision at d = "):
        compiled(text)
