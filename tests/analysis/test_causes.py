"""The causes of a condition number, from made traces and from a run."""

import json
import subprocess
from pathlib import Path

import pytest

from barrierbench_analysis.tables import causes
from barrierbench_analysis.program.start import RELEASE
from synthetic import write_run

ROOT = Path(__file__).resolve().parents[2]


def sample(stage, scaling, low, high, ends=()):
    return {"matrix": "clamped", "stage": stage, "scaling": scaling, "lambda_min": low, "lambda_max": high, "cond": None if low is None else high / low,
            "status": "singular" if low is None else "ok", "ends": list(ends)}


def row(step, iteration, *samples):
    return {"step": step, "iteration": iteration, "cond": list(samples)}


END = {"side": "largest", "lambda": 900.0, "terms": [{"term": "contact", "share": 0.9}, {"term": "inertia", "share": 0.1}, {"term": "hinges", "share": 0.001}],
       "element": "contact: obstacle: floor, cloth[3]", "element_share": 0.8, "body": "cloth", "body_share": 1.0, "vertex": 3, "vertices": 1.2}
ROWS = [row(0, 0, sample("full", "none", 1.0, 10.0)),
        row(1, 2, sample("full", "none", 1.0, 1000.0, [END]), sample("full", "jacobi", 0.5, 2.0), sample("without_contact", "none", 2.0, 100.0), sample("without_contact_and_limit", "none", 2.0, 20.0)),
        row(2, 0, sample("without_contact", "none", 1.0, 1e9))]


def test_the_worst_iteration_is_that_of_the_full_matrix():
    assert causes.pick(ROWS, "none", None)["step"] == 1
    assert causes.pick(ROWS, "none", (0, 0))["step"] == 0
    assert causes.pick([*ROWS, row(3, 1, sample("full", "none", None, None))], "none", None)["step"] == 3  # singular is worse than any number


@pytest.mark.parametrize("scaling, at", [("block_jacobi", None), ("none", (7, 0)), ("none", (2, 0))])
def test_an_iteration_without_a_number_is_refused(scaling, at):
    with pytest.raises(causes.UserError, match="passes/diagnose"):
        causes.pick(ROWS, scaling, at)


def test_every_cause_is_a_ratio_of_two_matrices_of_one_iteration():
    found = dict(causes.ratios(causes.clamped(ROWS[1])))
    assert found == pytest.approx({"contact, scaling none": 20.0, "strain limit, scaling none": 5.0, "scaling jacobi, full matrix": 0.004})


def test_the_text_names_term_element_and_body_and_leaves_out_small_terms():
    text = causes.text(ROWS[1], 3, "none")
    for part in ("step 1, iteration 2 of 3", "cond 10^3.00", "contact 90%, inertia 10%", "floor, cloth[3] (80%)", "cloth (100%)"):
        assert part in text
    assert "hinges" not in text


def test_a_record_without_a_trace_says_what_to_do(tmp_path, capsys):
    write_run(tmp_path, "log", 1.0, 0.1)
    (tmp_path / "log/trace.jsonl").unlink()
    record = json.loads((tmp_path / "log/run.json").read_text())
    (tmp_path / "log/run.json").write_text(json.dumps(record | {"artifacts": []}))
    assert causes.main([str(tmp_path / "log")]) == 2
    assert "trace.jsonl: not there" in capsys.readouterr().err


@pytest.mark.parametrize("at", ["", ",", "1", "1,2,3", "-1,0", "a,b", "1,"])
def test_an_iteration_is_two_numbers_from_0(tmp_path, capsys, at):
    write_run(tmp_path, "log", 1.0, 0.1)
    assert causes.main([str(tmp_path / "log"), f"--at={at}"]) == 2
    assert ("--at: found nothing" if at == "" else f"--at {at!r}: allowed: STEP,ITERATION") in capsys.readouterr().err


@pytest.mark.parametrize("words", [("--set", "/time/steps=3"), ("--plugin", "a.so"), ("--out", "there")])
@pytest.mark.parametrize("given", ["log", "log/run.json"])
def test_a_record_takes_nothing_that_only_a_run_can(tmp_path, capsys, given, words):
    write_run(tmp_path, "log", 1.0, 0.1)
    assert causes.main([str(tmp_path / given), *words]) == 2
    said = capsys.readouterr().err
    assert " ".join(words) in said and "whose run is over" in said and "CONFIG.json" in said


def test_a_stiff_contact_of_a_run_is_named(tmp_path, capsys):
    if not RELEASE.exists():
        pytest.skip("the program is not built")
    words = ["--set", "/time/steps=20", "--set", "/formulation=cubic", "--set", "/formulation/stiffness_policy={\"name\": \"fixed\", \"kappa_N_per_m\": 1e6}", "--out", str(tmp_path / "run")]
    assert causes.main([str(ROOT / "configs/scenes/resting_block_1d.json"), *words]) == 0
    out = capsys.readouterr().out
    largest = [line for line in out.splitlines() if line.startswith("full ") and " largest " in line and " none " in line]
    assert len(largest) == 1 and "contact 100%" in largest[0] and "plane" in largest[0]


@pytest.mark.parametrize("out, replace, passed", [(None, False, True), ("out", False, False), ("out", True, True)])
def test_replace_is_handed_to_the_run(monkeypatch, tmp_path, out, replace, passed):
    asked = []
    monkeypatch.setattr(causes, "started", lambda *words, **_: asked.append(words) or subprocess.CompletedProcess(words, 0))
    causes.run_folder(tmp_path / "config.json", out and tmp_path / out, [], [], replace)
    assert len(asked) == 1 and ("--replace" in asked[0]) == passed
    with pytest.raises(causes.UserError, match="--replace: given with a record"):
        causes.run_folder(tmp_path, None, [], [], True)
