"""A build that fails its block shows no times; the block is made by the first run."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "build/release/experiments/barrierbench"
SCENE = ROOT / "configs/scenes/resting_block_1d.json"

pytestmark = pytest.mark.skipif(not PROGRAM.exists(), reason="the program is not built")


@pytest.fixture
def program(tmp_path):
    """A copy, so that its validity folder is the test's own."""
    return Path(shutil.copy(PROGRAM, tmp_path / "barrierbench"))


def run(program, out):
    done = subprocess.run([program, "run", SCENE, "--out", out, "--progress", "none", "--set", "/time/steps=3", "--set", "/passes/diagnose=true"],
                          capture_output=True, text=True, check=False, env={"BARRIERBENCH_CONFIGS": str(ROOT / "configs"), "PATH": "/usr/bin:/bin"})
    assert done.returncode == 0, done.stderr
    return json.loads((out / "run.json").read_text()), done.stderr


def test_the_first_run_makes_the_block_and_the_record_names_it(program, tmp_path):
    record, message = run(program, tmp_path / "out")
    reports = list((tmp_path / "validity").glob("*.json"))
    assert len(reports) == 1 and message == ""
    build = record["validity"]["build"]
    assert build["valid"] and build["checks"] == len(json.loads(reports[0].read_text())["checks"]) > 0
    assert record["summary"]["wall_s"] > 0 and record["samples"]["wall_s"]
    assert {"name": "build_valid", "value": 0.0, "bound": 0.0, "pass": True} in record["validity"]["checks"]


def test_a_build_that_fails_a_check_shows_no_times(program, tmp_path):
    run(program, tmp_path / "first")
    report = next((tmp_path / "validity").glob("*.json"))
    document = json.loads(report.read_text())
    document["checks"][0]["value"] = 2 * document["checks"][0]["bound"] + 1
    report.write_text(json.dumps(document))

    record, message = run(program, tmp_path / "second")
    name = document["checks"][0]["name"]
    assert name in message and "no times" in message
    assert record["validity"]["build"]["failed"] == name
    assert not record["validity"]["valid"] and not record["status"]["valid"]
    assert record["summary"]["wall_s"] is None and record["summary"]["wall_s_status"] == "build_not_valid"
    assert record["summary"]["time"] == {} or not any(record["summary"]["time"].values())
    assert "wall_s" not in record["samples"]
    assert all(step["wall_s"] is None for step in record["steps"]) and record["steps"]
    lines = [json.loads(line) for line in (tmp_path / "second/trace.jsonl").read_text().splitlines()]
    assert lines and all(not any(line["time"].values()) for line in lines)
    assert {"metric": "time", "reason": "build_not_valid"} in record["skipped"]


def test_the_verb_prints_every_check_and_its_exit_code_is_the_verdict(program, tmp_path):
    good = subprocess.run([program, "validity"], capture_output=True, text=True, check=False)
    assert good.returncode == 0 and "all passed" in good.stdout and good.stdout.count("passed ") >= 12
    report = next((tmp_path / "validity").glob("*.json"))
    document = json.loads(report.read_text())
    document["checks"][-1]["detail"] = "made to fail"
    document["checks"][-1]["pass"] = False
    report.write_text(json.dumps(document))
    bad = subprocess.run([program, "validity"], capture_output=True, text=True, check=False)
    assert bad.returncode == 4 and "FAILED" in bad.stdout and "not valid" in bad.stdout
