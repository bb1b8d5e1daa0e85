"""Runs on a device that lacks memory or a kernel, or is not there: exit codes, messages, the record, and going on."""

import json
import os
import shutil
from pathlib import Path

import pytest
from test_cli import bench, refused, write

BLOCK = {"schema": "barrierbench.config/1", "scene": {"name": "drape", "n": 5}, "formulation": "log", "matching": {"rule": "equal_force"},
         "time": {"steps": 3}, "passes": {"time": False, "audit": True}, "device": "host", "threads": 1}


def run(program: str, tmp_path: Path, *more: str, out: str = "out", **environment: str):
    config = write(tmp_path / "a.json", json.dumps(BLOCK))
    return bench(program, "run", config, "--out", tmp_path / out, *more, env={**os.environ, **environment})


def record_of(folder: Path) -> dict:
    return json.loads((folder / "run.json").read_text())


def test_a_kernel_that_fails_leaves_a_record_and_goes_on_from_the_last_step(program, tmp_path):
    assert run(program, tmp_path, out="whole").returncode == 0
    whole = record_of(tmp_path / "whole")
    for launches in range(1, 60):  # until a step is over before it
        done = run(program, tmp_path, BARRIERBENCH_FAIL_KERNEL=f"BeginRun:{launches}")
        assert done.returncode == 70, done.stderr
        assert "BeginRun" in done.stderr and "--resume" in done.stderr
        stopped = record_of(tmp_path / "out")
        assert stopped["status"]["outcome"] == "kernel_failed" and "BeginRun" in stopped["status"]["detail"]
        if stopped["steps"]:
            break
    assert 0 < len(stopped["steps"]) < len(whole["steps"]) == 3
    assert (tmp_path / "out/checkpoint.bin").exists()
    assert run(program, tmp_path, "--resume").returncode == 0
    resumed = record_of(tmp_path / "out")
    assert resumed["status"]["resumed_from_step"] == len(stopped["steps"])
    assert resumed["summary"]["state_hash"] == whole["summary"]["state_hash"]
    assert not (tmp_path / "out/checkpoint.bin").exists()


def test_memory_that_runs_out_is_named_with_numbers(program, tmp_path):
    done = run(program, tmp_path, BARRIERBENCH_DEVICE_MEMORY="60000")
    assert done.returncode == 75, done.stderr
    for part in ("no memory for ", "requested", "58.59 KiB"):
        assert part in done.stderr
    assert record_of(tmp_path / "out")["status"]["outcome"] == "oom"


def test_memory_that_runs_out_in_a_step_keeps_the_step_before(program, tmp_path):
    low, high = 10_000, 100_000_000
    while high - low > 16:
        middle = (low + high) // 2
        shutil.rmtree(tmp_path / "out", ignore_errors=True)  # a whole record of this run would stay
        done = run(program, tmp_path, BARRIERBENCH_DEVICE_MEMORY=str(middle))
        assert done.returncode in (0, 75), done.stderr
        if done.returncode == 75 and (tmp_path / "out/checkpoint.bin").exists():
            stopped = record_of(tmp_path / "out")
            assert stopped["status"]["outcome"] == "oom" and "no memory for " in stopped["status"]["detail"]
            assert run(program, tmp_path, "--resume").returncode == 0
            assert record_of(tmp_path / "out")["status"]["outcome"] in ("ok", "unproven")
            return
        low, high = (middle, high) if done.returncode == 75 else (low, middle)
    raise AssertionError("no limit lets a run begin and ends a step of it")


@pytest.mark.parametrize("variable, value", [("BARRIERBENCH_DEVICE_MEMORY", "lots"), ("BARRIERBENCH_FAIL_KERNEL", "BeginRun")])
def test_a_variable_that_means_nothing_is_refused(program, tmp_path, variable, value):
    refused(run(program, tmp_path, **{variable: value}), variable, value)
    assert not (tmp_path / "out").exists()


def test_without_a_card_nothing_begins(program, tmp_path):
    found = json.loads(bench(program, "device", "--json").stdout)
    if found["usable"]:
        pytest.skip("there is a card")
    done = run(program, tmp_path, "--set", '/device="cuda"')
    refused(done, "/device", found["why"])
    assert not (tmp_path / "out").exists()


def test_explain_counts_the_memory(program, tmp_path):
    config = write(tmp_path / "a.json", json.dumps(BLOCK))
    done = bench(program, "explain", config, "--contacts", "1e6", "--blocks-per-contact", "0.5")
    assert done.returncode == 0, done.stderr
    for part in ("contact vertices", "1e+06 contacts (--contacts)", "B a contact row", "total"):
        assert part in done.stdout
    few = bench(program, "explain", config)
    assert "estimated" in few.stdout and "total" in few.stdout
    measured = json.loads((Path(__file__).parents[2] / "results/gpu_model_inputs.json").read_text())["dense_patch"]
    assert f"each with {measured['candidates_a_contact']:.4g} candidates and {measured['blocks_a_contact']:.4g} stored blocks" in few.stdout
    assert "each with 6.145 candidates and 0.5 stored blocks" in done.stdout
    assert "memory of the device" not in bench(program, "explain", config, "--set", '/device="cpu"').stdout
