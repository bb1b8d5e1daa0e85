"""What is there stays: a run replaces the record of its own config alone, and no file of another program, unless --replace is given."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from processes import started, wait_until

from test_cli import BLOCK, bench, frame, long_run, sweep_spec, write

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
    done = bench(program, "run", BLOCK, *FEW, *OTHER, "--out", finished, *more)
    refused_as_taken(done, finished)
    assert 'the record of another run, "' in done.stderr and "/time/steps is 3 there and 4 in this run" in done.stderr, done.stderr
    assert contents(finished) == before


@pytest.fixture()
def stopped(program, tmp_path) -> Path:
    """A folder with the checkpoint of a run that Ctrl-C has stopped."""
    with started(program, *long_run(tmp_path)) as run:
        wait_until(frame(tmp_path, 1).exists, run)
        run.send_signal(signal.SIGINT)
        run.communicate(timeout=30)
    assert (tmp_path / "out/checkpoint.bin").is_file() and not (tmp_path / "out/run.json").exists()
    return tmp_path / "out"


def test_the_checkpoint_of_another_config_stays(program, stopped):
    before = contents(stopped)
    for more in ((), ("--resume",)):
        done = bench(program, "run", BLOCK, *OTHER, "--out", stopped, *more)
        assert done.returncode == 2 and done.stdout == "" and contents(stopped) == before
        assert f"{stopped}/checkpoint.bin: found the checkpoint of another run, which is not over: /" in done.stderr and "--replace" in done.stderr, done.stderr
    assert bench(program, "run", BLOCK, *OTHER, "--out", stopped, "--replace").returncode == 0
    assert steps_of(stopped) == 4 and not (stopped / "checkpoint.bin").exists()


@pytest.mark.parametrize("text", ["my notes", "barrierbench.checkpoint/2\nprogram 0\n"])
def test_a_file_that_is_no_checkpoint_stays(program, tmp_path, text):
    (tmp_path / "checkpoint.bin").write_text(text)
    done = bench(program, "run", BLOCK, *FEW, "--out", tmp_path)
    assert done.returncode == 2 and "checkpoint.bin: found a file that is no checkpoint of this version" in done.stderr, done.stderr
    assert contents(tmp_path) == {"checkpoint.bin": text.encode()}
    assert bench(program, "run", BLOCK, *FEW, "--out", tmp_path, "--replace").returncode == 0


def test_every_difference_is_counted_and_the_first_has_both_values(program, finished):
    done = bench(program, "run", BLOCK, *FEW, *OTHER, "--set", "/output/frames_every=2", "--out", finished)
    refused_as_taken(done, finished)
    assert "/output/frames_every is 1 there and 2 in this run; 2 differences in all" in done.stderr, done.stderr


def test_a_setting_that_an_earlier_program_did_not_have_makes_no_other_run(program, finished):
    """Its record has a config without the setting."""
    record = json.loads((finished / "run.json").read_text())
    assert record["config"]["output"].pop("matrices") is False
    write(finished / "run.json", record)
    done = bench(program, "run", BLOCK, *FEW, "--out", finished)
    assert done.returncode == 0, done.stderr
    record["config"]["time"]["steps"] = 5
    write(finished / "run.json", record)
    done = bench(program, "run", BLOCK, *FEW, "--out", finished)
    refused_as_taken(done, finished)
    assert "/time/steps is 5 there and 3 in this run" in done.stderr and "matrices" not in done.stderr


def test_a_run_that_was_cut_is_no_less_the_record_of_another_config(program, tmp_path):
    out = tmp_path / "out"
    assert bench(program, "run", BLOCK, "--set", "/time/steps=100000", "--step-limit", "3", "--out", out).returncode == 0
    assert json.loads((out / "run.json").read_text())["status"]["outcome"] == "timeout"
    (out / "checkpoint.bin").unlink(missing_ok=True)
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
    assert done.returncode == 0 and f"{finished}/run.json is replaced when this run is over, which differs from it: another build (commit " in done.stderr, done.stderr
    assert json.loads((finished / "run.json").read_text())["ids"]["build_id"] != "b" * 64


def test_what_differs_is_said_of_the_run_that_comes(program, tmp_path):
    for threads in (1, 2):
        done = bench(program, "run", BLOCK, *FEW, "--set", f"/threads={threads}", "--out", tmp_path / "out")
        assert done.returncode == 0
    assert done.stderr == f"{tmp_path}/out/run.json is replaced when this run is over, which differs from it: another number of threads (2, not 1)\n", done.stderr


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


@pytest.mark.parametrize("jobs", [(), ("--jobs", "2")])
def test_a_case_whose_folder_has_what_is_not_its_own_is_refused_and_the_others_run(program, tmp_path, jobs):
    spec, out = sweep_spec(tmp_path, [1, 2, 3, 4, 5]), tmp_path / "out"
    assert bench(program, "sweep", spec, "--out", out).returncode == 0
    one, two, three, four, five = sorted(out.glob("*/run.json"))
    one.write_text("my notes")
    two.write_text("[]")
    three.write_bytes(five.read_bytes())  # the record of another config
    four.write_text(four.read_text()[:500])  # cut off: it runs again
    before = [file.read_bytes() for file in (one, two, three)]
    five.unlink()
    (five.parent / "trace.jsonl").unlink()
    done = bench(program, "sweep", spec, "--out", out, *jobs)
    assert done.returncode == 2, done.stdout + done.stderr
    assert [file.read_bytes() for file in (one, two, three)] == before
    assert done.stderr.count("that is no record of a run") == 2 and done.stderr.count("the record of another run") == 1, done.stderr
    assert "/time/steps is 5 there and 3 in this run" in done.stderr and "another folder of the sweep (--out)" in done.stderr
    assert [json.loads(file.read_text())["summary"]["steps"] for file in (four, five)] == [4, 5]


def test_scenes_writes_over_no_other_file_and_may_be_typed_twice(program, tmp_path):
    command = [sys.executable, ROOT / "analysis", "scenes", "twist", "--write"]
    reported = {"env": {**os.environ, "BARRIERBENCH_PROGRAM": program}, "capture_output": True, "text": True, "check": False}
    for _ in range(2):
        assert subprocess.run([*command, tmp_path / "new.json"], **reported).returncode == 0
    assert json.loads((tmp_path / "new.json").read_text())["scene"]
    for other, text in (("mine.json", "mine"), ("bytes.json", "\udcff")):
        file = tmp_path / other
        file.write_bytes(text.encode(errors="surrogateescape"))
        before = file.read_bytes()
        done = subprocess.run([*command, file], **reported)
        assert done.returncode == 2 and file.read_bytes() == before and f"{file} is there, with other contents" in done.stderr, done.stderr
