"""Published methods as the program shows, runs and records them, and the simulated time that they are compared at."""

import json
import subprocess
from pathlib import Path

import pytest

BLOCK = str(Path(__file__).resolve().parents[2] / "configs/scenes/resting_block_1d.json")
SHORT = ("--set", "/time/duration_s=0.0305", "--set", "/passes/time=false")


def bench(program, *words):
    return subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False, timeout=120)


def run(program, out, *words) -> dict:
    done = bench(program, "run", BLOCK, *SHORT, *words, "--out", out, "--progress", "none")
    assert done.returncode == 0, done.stderr
    return json.loads((out / "run.json").read_text())


def test_a_method_is_listed_with_its_settings_its_facts_and_what_differs(program):
    text = bench(program, "list", "methods").stdout
    for part in ("ando2024", "ipc2020", "/linear_solver/tol_rel = 0.001", "frontend/_param_.py: dt 1e-3", "differs, walls:", "Source: Ando 2024"):
        assert part in text
    assert "/method" in text.splitlines()[0] and "/method" in bench(program, "help", "config").stdout


def test_the_record_of_a_whole_method(program, tmp_path):
    record = run(program, tmp_path / "a", "--set", "/method=ando2024")
    assert record["method"]["name"] == record["labels"]["method"] == record["config"]["method"] == "ando2024"
    assert record["method"]["overridden"] == [] and "walls" in record["method"]["differs"] and "Ando 2024" in record["method"]["source"]
    assert (record["labels"]["precision"], record["labels"]["linear_solver"], record["labels"]["step_solver"]) == ("float", "pcg", "accumulated_toi")
    assert record["config"]["time"] == {"dt_s": 0.001, "duration_s": 0.0305, "steps": 31}
    assert 0.0305 * (1 - 1e-9) <= record["steps"][-1]["t_s"] < 0.0305 + 0.001


def test_a_method_that_was_changed_is_called_so(program, tmp_path):
    record = run(program, tmp_path / "a", "--set", "/method=ando2024", "--set", "/precision=double", "--set", "/time/dt_s=0.01")
    assert record["labels"]["method"] == "ando2024, changed" and record["method"]["overridden"] == ["/precision", "/time/dt_s"]
    again = run(program, tmp_path / "b")
    assert again["method"] == {"name": "", "source": "", "overridden": [], "differs": {}} and again["labels"]["method"] == ""
    assert again["config"]["time"]["steps"] == len(again["steps"]) == 4 and again["steps"][-1]["t_s"] == pytest.approx(0.04)


def test_explain_says_what_is_of_the_method(program):
    text = bench(program, "explain", BLOCK, "--set", "/method=ando2024", "--set", "/precision=double").stdout
    marks = {line[4:].split()[0]: line[2] for line in text.splitlines() if line[4:5] == "/"}
    assert "method    ando2024, changed: Ando 2024" in text and "  overridden: /precision" in text and "  differs, walls:" in text
    assert (marks["/linear_solver/tol_rel"], marks["/precision"], marks["/time/dt_s"], marks["/scene/name"], marks["/contact/min_gap_fraction"], marks["/seeds/main"]) == ("m", "*", "m", "*", "m", " ")


@pytest.mark.parametrize("setting, where, allowed", [
    ("/method=ando", "#/method", "one of ando2024, ipc2020"), ("/method=ipc2021", "#/method", "did you mean ipc2020?"),
    ("/time/duration_s=0", "#/time/duration_s", "a number >= 1e-18 and <= 1e+09 (s)"), ("/time/duration_s=1e9", "#/time/duration_s", "at most 1000000000 steps")])
def test_what_is_refused(program, setting, where, allowed):
    done = bench(program, "check", BLOCK, "--set", setting)
    assert done.returncode == 2 and BLOCK + where in done.stderr and allowed in done.stderr


def test_steps_and_a_duration_in_one_file_have_to_agree(program, tmp_path):
    config = json.loads(Path(BLOCK).read_text()) | {"time": {"dt_s": 0.01, "steps": 5, "duration_s": 0.04}}
    (tmp_path / "both.json").write_text(json.dumps(config))
    done = bench(program, "check", tmp_path / "both.json")
    assert done.returncode == 2 and "#/time/steps" in done.stderr and "4, which is ceil(duration_s/dt_s)" in done.stderr
