"""The verb steps: single steps from one state by every choice of Hessian, its file and its figure; and settings of /hessian."""

import json
import subprocess
from pathlib import Path

import pytest
from barrierbench_analysis.figures.plots import newton_steps

ROOT = Path(__file__).resolve().parents[2]
HANG = str(ROOT / "configs/scenes/hang.json")
LOADS = ["--set", "/matching/load_N=1", "--set", "/matching/limit_load_N_per_m=10"]
CHOICES = ["clamped", "absolute", "exact_or_clamped", "progressive", "blend"]


def bench(program: str, *arguments) -> subprocess.CompletedProcess:
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False, timeout=240)


@pytest.fixture(scope="module")
def study(program, tmp_path_factory) -> tuple[str, Path]:
    """Two steps of a small drape: what was printed, and the file."""
    out = tmp_path_factory.mktemp("steps") / "steps.json"
    done = bench(program, "steps", ROOT / "configs/scenes/drape.json", "--set", "/scene/layers=2", "--set", "/scene/n=8", "--set", "/time/steps=14",
                 *LOADS, "--at", "4,12", "--out", out)
    assert done.returncode == 0, done.stderr
    return done.stdout, out


def test_every_choice_is_tried_from_one_state_and_its_error_is_within_three_tolerances(study):
    trials = json.loads(study[1].read_text())["trials"]
    assert [(t["step"], t["hessian"]) for t in trials] == [(step, choice) for step in (4, 12) for choice in CHOICES]
    for trial in trials:
        assert trial["status"] == "converged"
        assert trial["linear_solves"] == trial["newton_iterations"] + trial["hessian_fallbacks"]
        assert len(trial["dx_inf_m"]) == trial["newton_iterations"] > 1
        assert trial["error_estimate_m"] < trial["tolerance_m"]
        assert 0 <= trial["error_true_m"] < 3 * trial["tolerance_m"]
    assert sum(trial["contacts"] > 0 for trial in trials if trial["step"] == 12) == len(CHOICES)
    first = [trial["dx_inf_m"][0] for trial in trials if trial["step"] == 4 and trial["hessian"] in CHOICES[2:]]
    assert len(first) == 3 and len(set(first)) == 1  # in free fall the exact matrix serves: one state, one direction


def test_the_table_says_what_the_file_holds(study):
    lines = study[0].splitlines()
    trials = json.loads(study[1].read_text())["trials"]
    for line, trial in zip(lines[1:], trials):
        words = line.split()
        assert words[:4] == [str(trial["step"]), trial["hessian"], str(trial["newton_iterations"]), str(trial["linear_solves"])]
    assert "in tolerances of" in lines[-1]


def test_the_figure_draws_every_iteration(study, tmp_path):
    data = newton_steps.read_steps(study[1])
    paths = newton_steps.figure(data, tmp_path / "steps")
    assert [path.suffix for path in paths] == [".png", ".pdf", ".csv", ".txt", ".svg", ".dat"] and all(path.stat().st_size > 0 for path in paths)
    rows = (tmp_path / "steps.csv").read_text().splitlines()
    assert len(rows) - 1 == sum(trial["newton_iterations"] for trial in data["trials"]) > 20


@pytest.mark.parametrize("text, word", [("no json", "not JSON"), ('{"schema": "barrierbench.run"}', "schema"),
                                        ('{"schema": "barrierbench.steps/1", "trials": []}', "no trials")])
def test_the_figure_refuses_another_file(tmp_path, text, word):
    file = tmp_path / "x.json"
    file.write_text(text)
    with pytest.raises(ValueError, match=word):
        newton_steps.read_steps(file)


@pytest.mark.parametrize("at, allowed", [("3,2", "ascending steps"), ("2,2", "ascending steps"), ("100000", "ascending steps"), ("-1", "ascending steps")])
def test_steps_that_the_run_does_not_have_are_refused(program, at, allowed):
    done = bench(program, "steps", HANG, *LOADS, "--at", at)
    assert done.returncode == 2 and allowed in done.stderr and done.stdout == ""


@pytest.mark.parametrize("setting, parts", [
    ("/hessian/membrane=blnd", ['/hessian/membrane: found "blnd"', "did you mean blend"]),
    ("/hessian/inertia=blend", ['/hessian', 'unknown key "inertia"']),
    ("/hessian/contact=1", ["/hessian/contact", "one of clamped, absolute, exact_or_clamped, progressive, blend"]),
])
def test_a_hessian_that_a_term_does_not_offer_is_refused(program, setting, parts):
    done = bench(program, "check", HANG, "--set", setting)
    assert done.returncode == 2
    for part in parts:
        assert part in done.stderr, done.stderr


def test_the_articles_solver_takes_clamped_hessians_only(program):
    done = bench(program, "check", ROOT / "configs/scenes/drape2d.json", "--set", "/scene/protocol=article_literal", "--set",
                 "/hessian/membrane=blend")
    assert done.returncode == 2 and "/hessian/membrane" in done.stderr and "clamped: the step solver is article_literal" in done.stderr
