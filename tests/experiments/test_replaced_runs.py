"""What is there stays: a run replaces the record of its own config alone, and no file of another program, unless it is told to."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from test_cli import BLOCK, bench, sweep_spec, write

ROOT = Path(__file__).resolve().parents[2]
FEW = ("--set", "/time/steps=3", "--set", "/output/frames_every=1")
OTHER = ("--set", "/time/steps=4")


def contents(folder: Path) -> dict:
    found = {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}
    assert found
    return found


def steps_of(folder: Path) -> int:
    return json.loads((folder / "run.json").read_text())["summary"]["steps"]


@pytest.fixture()
def finished(program, tmp_path) -> Path:
    """A folder with a finished run of three steps and its frames."""
    assert bench(program, "run", BLOCK, *FEW, "--out", tmp_path / "out").returncode == 0
    assert len([name for name in contents(tmp_path / "out") if name.startswith("frames/")]) >= 3
    return tmp_path / "out"


def refused_as_taken(done, folder: Path) -> None:
    assert done.returncode == 2 and done.stdout == "", done.stdout
    assert f"{folder}/run.json: found " in done.stderr and "allowed: another folder" in done.stderr and "--replace" in done.stderr, done.stderr


@pytest.mark.parametrize("more", [(), ("--resume",), ("--keep-inputs",), ("--time-limit", "0.001")])
def test_the_record_of_another_config_and_its_frames_stay(program, finished, more):
    before = contents(finished)
    done = bench(program, "run", BLOCK, *OTHER, "--out", finished, *more)
    refused_as_taken(done, finished)
    assert 'the record of another run, "' in done.stderr and contents(finished) == before


def test_a_run_that_was_cut_is_no_less_the_record_of_another_config(program, tmp_path):
    out = tmp_path / "out"
    assert bench(program, "run", BLOCK, "--set", "/time/steps=100000", "--time-limit", "0.2", "--out", out).returncode == 0
    assert json.loads((out / "run.json").read_text())["status"]["outcome"] == "timeout"
    before = contents(out)
    refused_as_taken(bench(program, "run", BLOCK, *OTHER, "--out", out), out)
    assert contents(out) == before


def test_a_rerun_replaces_no_record_of_another_config(program, finished, tmp_path):
    before = contents(finished)
    assert bench(program, "run", BLOCK, *OTHER, "--out", tmp_path / "one").returncode == 0
    again = ("run", tmp_path / "one/run.json", "--out")
    refused_as_taken(bench(program, *again, finished), finished)
    assert contents(finished) == before
    for _ in range(2):  # the same command twice
        assert bench(program, *again, tmp_path / "two").returncode == 0
    assert bench(program, *again, finished, "--replace").returncode == 0 and steps_of(finished) == 4


def test_replace_lets_the_record_go_with_its_files(program, finished):
    assert bench(program, "run", BLOCK, *OTHER, "--out", finished, "--replace").returncode == 0
    assert steps_of(finished) == 4 and not (finished / "frames").exists()


def test_a_command_may_be_typed_twice(program, tmp_path):
    out, states = tmp_path / "out", []
    for _ in range(2):
        done = bench(program, "run", BLOCK, *FEW, "--out", out)
        assert done.returncode == 0 and done.stderr == "", done.stderr
        states.append(json.loads((out / "run.json").read_text())["summary"]["state_hash"])
    assert states[0] == states[1]


def test_a_new_build_may_make_the_run_again_and_says_so(program, finished):
    record = json.loads((finished / "run.json").read_text())
    record["ids"]["build_id"] = "b" * 64
    write(finished / "run.json", record)
    done = bench(program, "run", BLOCK, *FEW, "--out", finished)
    assert done.returncode == 0 and f"{finished}/run.json is replaced when this run is over; it was made by another build" in done.stderr, done.stderr
    assert json.loads((finished / "run.json").read_text())["ids"]["build_id"] != "b" * 64


@pytest.mark.parametrize("text", ['{"anything": 1}', "no JSON", "", '{"schema": {"name": "barrierbench.run", "version": "99.0.0"}}', "[]"])
def test_a_file_of_another_program_stays(program, tmp_path, text):
    (tmp_path / "run.json").write_text(text)
    done = bench(program, "run", BLOCK, *FEW, "--out", tmp_path)
    refused_as_taken(done, tmp_path)
    assert "that is no record of" in done.stderr and contents(tmp_path) == {"run.json": text.encode()}
    assert bench(program, "run", BLOCK, *FEW, "--out", tmp_path, "--replace").returncode == 0 and steps_of(tmp_path) == 3


def test_a_share_of_a_sweep_that_is_repeated_goes_on(program, tmp_path):
    spec, out = sweep_spec(tmp_path, [1, 2, 3]), tmp_path / "out"
    share = ("sweep", spec, "--out", out, "--shard", "1/2")
    assert bench(program, *share).returncode == 0
    made = len(list(out.glob("*/run.json")))
    assert made == 2
    again = bench(program, *share)
    assert again.returncode == 0 and again.stdout.count("already there") == made
    assert bench(program, *share, "--again").returncode == 0
    assert bench(program, "sweep", spec, "--out", out).returncode == 0 and len(list(out.glob("*/run.json"))) == 3


def test_scenes_writes_over_no_other_file_and_may_be_typed_twice(program, tmp_path):
    command = [sys.executable, ROOT / "analysis", "scenes", "twist", "--write"]
    told = {"env": {**os.environ, "BARRIERBENCH_PROGRAM": program}, "capture_output": True, "text": True, "check": False}
    for _ in range(2):
        assert subprocess.run([*command, tmp_path / "new.json"], **told).returncode == 0
    assert json.loads((tmp_path / "new.json").read_text())["scene"]
    for other, text in (("mine.json", "mine"), ("bytes.json", "\udcff")):
        file = tmp_path / other
        file.write_bytes(text.encode(errors="surrogateescape"))
        before = file.read_bytes()
        done = subprocess.run([*command, file], **told)
        assert done.returncode == 2 and file.read_bytes() == before and f"{file} is there, with other contents" in done.stderr, done.stderr
