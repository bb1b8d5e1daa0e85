"""Streams that are closed, full or read by nobody, and a limit on the size of files: no crash, the right exit code."""

import json
import os
import resource
import subprocess

import pytest

from test_cli import BLOCK

WRONG = ["run", BLOCK, "--set", "/time/dt_s=-1"]


def close(*descriptors):
    def in_the_child():
        for descriptor in descriptors:
            os.close(descriptor)

    return in_the_child


def ended(program: str, arguments: list, **options) -> subprocess.CompletedProcess:
    return subprocess.run([program, *map(str, arguments)], check=False, timeout=60, **options)


@pytest.mark.parametrize("arguments", [WRONG, ["run"], ["sweep", "nowhere.json"], ["--plugin", "nowhere.so", "list"]])
def test_errors_that_nobody_can_read_keep_their_exit_code(program, arguments):
    with open("/dev/full", "w") as full:
        assert ended(program, arguments, stdout=subprocess.DEVNULL, stderr=full).returncode == 2
    assert ended(program, arguments, stdout=subprocess.DEVNULL, preexec_fn=close(2)).returncode == 2
    assert ended(program, arguments, preexec_fn=close(0, 1, 2)).returncode == 2
    read_end, write_end = os.pipe()
    os.close(read_end)
    assert ended(program, arguments, stdout=subprocess.DEVNULL, stderr=write_end).returncode == 2
    os.close(write_end)


@pytest.mark.parametrize("descriptors", [(2,), (0, 2), (0, 1, 2)])
def test_no_file_of_a_run_gets_the_words_for_a_closed_stream(program, tmp_path, descriptors):
    out = tmp_path / "out"
    arguments = ["--progress", "plain", "--progress-every", "0.01", "run", BLOCK, "--out", out, "--set", "/time/steps=20"]
    done = ended(program, arguments, stdout=subprocess.DEVNULL, preexec_fn=close(*descriptors))
    assert done.returncode == (75 if 1 in descriptors else 0)
    assert json.loads((out / "run.json").read_text())["summary"]["steps"] == 20
    for line in (out / "trace.jsonl").read_text().splitlines():
        json.loads(line)


@pytest.mark.parametrize("progress", ["plain", "none"])
def test_a_full_stderr_does_not_end_a_run(program, tmp_path, progress):
    arguments = ["--progress", progress, "--progress-every", "0.01", "run", BLOCK, "--out", tmp_path / "out", "--set", "/time/steps=3"]
    with open("/dev/full", "w") as full:
        assert ended(program, arguments, stdout=subprocess.DEVNULL, stderr=full).returncode == 0
    assert (tmp_path / "out/run.json").exists()


@pytest.mark.parametrize("limit", [0, 100, 6000])
def test_a_limit_on_file_sizes_is_a_full_disk(program, tmp_path, limit):
    """As `ulimit -f` sets it: with the signal that ends a program by default."""
    def limited():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    arguments = ["run", BLOCK, "--out", tmp_path / "out", "--set", "/time/steps=2", "--set", "/output/frames_every=1"]
    done = ended(program, arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=limited)
    assert done.returncode == 75, (done.returncode, done.stderr)
    assert "File too large" in done.stderr and str(tmp_path / "out") in done.stderr
    assert not (tmp_path / "out").exists()


def test_an_answer_too_long_for_a_limited_file(program, tmp_path):
    def limited():
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))

    with open(tmp_path / "answer", "w") as answer:
        done = ended(program, ["eval", "--schema"], stdout=answer, stderr=subprocess.PIPE, text=True, preexec_fn=limited)
    assert done.returncode == 75 and "standard output" in done.stderr
