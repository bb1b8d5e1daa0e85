"""A run that is killed at any of the calls by which files change: --resume goes on, or the finished record is there."""

import hashlib
import json
import os
import signal
import subprocess
from pathlib import Path

import pytest
from test_cli import BLOCK, write
from test_resume import result

CONFIG = {
    "schema": "barrierbench.config/1", "scene": {"name": "resting_block_1d"}, "formulation": {"name": "cubic", "d_hat_m": 0.01},
    "matching": {"rule": "equal_force", "load_N": 4}, "passes": {"time": True, "audit": True}, "time": {"steps": 5},
    "output": {"frames_every": 2}, "threads": 1}


@pytest.fixture
def shim(build_folder) -> Path:
    found = build_folder / "tests/experiments/libfault_shim.so"
    if not found.exists():
        pytest.skip(f"{found} is not built (a build with sanitizers has none)")
    return found


def run(program: str, shim: Path, *words, **faults) -> subprocess.CompletedProcess:
    settings = {f"FAULT_{name.upper()}": str(value) for name, value in faults.items()}
    return subprocess.run([program, "run", *map(str, words)], capture_output=True, text=True, check=False, timeout=120,
                          env={**os.environ, "LD_PRELOAD": str(shim), **settings})


def is_whole(folder: Path) -> bool:
    """Whether a record is there with all the files that it names, as it names them."""
    record = json.loads((folder / "run.json").read_text())
    files = all(hashlib.sha256((folder / a["path"]).read_bytes()).hexdigest() == a["sha256"] for a in record["artifacts"])
    return files and len(record["artifacts"]) > 3 and (folder / "trace.jsonl").exists()


def kill_everywhere(program: str, shim: Path, config: Path, tmp_path: Path, every: int, earlier: bool, stride: int):
    """Yields the folder of every run that was killed, n the number of the call, and the bytes of the earlier record."""
    words = [config, "--set", f"/output/checkpoint_every={every}"]
    assert run(program, shim, *words, "--out", tmp_path / "first").returncode == 0  # checks the build, which stays
    assert run(program, shim, *words, "--out", tmp_path / "whole", count=tmp_path / "count").returncode == 0
    calls, replaced = int((tmp_path / "count").read_text()), ["--replace"] if earlier else []
    assert calls > 30
    for n in range(1, calls + 20, stride):
        folder = tmp_path / f"killed-{n}"
        before = b""
        if earlier:  # the record of another config
            assert run(program, shim, BLOCK, "--out", folder, "--set", "/time/steps=2", "--set", "/output/frames_every=1").returncode == 0
            before = (folder / "run.json").read_bytes()
        done = run(program, shim, *words, "--out", folder, *replaced, at=n)
        if done.returncode == 0:
            assert n >= calls  # an earlier record takes calls of its own
            return
        assert done.returncode == -signal.SIGKILL, (n, done.stderr)
        yield words, folder, n, before
    raise AssertionError("it is killed for ever")


@pytest.mark.parametrize("every", [0, 1, 2])
def test_a_run_that_is_killed_anywhere_goes_on_or_is_over(program, shim, tmp_path, every):
    config, resumed, over = write(tmp_path / "block.json", CONFIG), 0, 0
    stride = 1 if every == 1 else 3
    for words, folder, n, _ in kill_everywhere(program, shim, config, tmp_path, every, False, stride):
        finished = next((f.read_bytes() for name in ("run.json.part", "run.json") if (f := folder / name).exists()), b"")
        again = run(program, shim, *words, "--out", folder, "--resume")
        assert again.returncode == 0, (n, again.stderr)
        if finished:  # nothing is computed twice
            over += 1
            assert (folder / "run.json").read_bytes() == finished, n
        assert is_whole(folder), n
        expected, found = result(tmp_path / "whole"), result(folder)
        assert expected["outcome"] == "ok" and sum(step["contacts"]["total"] for step in expected["steps"]) > 0
        for part, value in expected.items():
            assert found[part] == value, (n, part)
        status = json.loads((folder / "run.json").read_text())["status"]
        resumed += status["resumed_from_step"] is not None and status["resumed_from_step"] > 0
        if n % 10 == 0:
            assert "already there" in run(program, shim, *words, "--out", folder, "--resume").stdout
    assert over > 0 and resumed >= {0: 0, 1: 10, 2: 4}[every] and (every > 0 or resumed == 0), (over, resumed)


def test_an_earlier_record_is_whole_until_the_new_run_is_over(program, shim, tmp_path):
    config, stayed = write(tmp_path / "block.json", CONFIG), 0
    for words, folder, n, before in kill_everywhere(program, shim, config, tmp_path, 1, True, 2):
        pending = (folder / "run.json.part").exists()
        if not pending and (folder / "run.json").exists():
            assert is_whole(folder), n
            stayed += (folder / "run.json").read_bytes() == before
        else:
            assert pending, n  # the new run is over, and every file of it is on the disk
        assert run(program, shim, *words, "--out", folder, "--resume", "--replace").returncode == 0, n
        assert is_whole(folder) and (folder / "run.json").read_bytes() != before, n
        names = [p.name for p in folder.rglob("*")]
        assert not [name for name in names if ".part" in name or ".tmp" in name or "checkpoint" in name], (n, names)
    assert stayed > 15


def test_a_factor_that_is_too_large_is_an_outcome_with_a_record(program, shim, tmp_path):
    config = write(tmp_path / "block.json", CONFIG)
    for solver in ("cholmod", "lagged_cholesky"):
        folder = tmp_path / solver
        done = run(program, shim, config, "--out", folder, "--set", f"/linear_solver/name={json.dumps(solver)}", cholmod=1)
        assert done.returncode == 0, (done.returncode, done.stderr)
        record = json.loads((folder / "run.json").read_text())
        assert record["status"]["outcome"] == "linear_failure" and not record["status"]["valid"]
        assert "factor_too_large" in record["status"]["detail"] and "32-bit" in record["status"]["detail"]
        assert record["steps"][0]["status"] == "linear_failed"
        rows = [json.loads(line) for line in (folder / "trace.jsonl").read_text().splitlines()]
        assert rows[-1]["linear_status"] == "factor_too_large"


def test_a_condition_number_whose_factor_is_too_large_is_absent(program, shim, tmp_path):
    config = write(tmp_path / "block.json", {**CONFIG, "passes": {"time": False, "diagnose": True}})
    words = [config, "--out", tmp_path / "out", "--set", '/linear_solver/name="pcg"', "--set", "/time/steps=1"]
    assert run(program, shim, *words, cholmod=1).returncode == 0
    record = json.loads((tmp_path / "out/run.json").read_text())
    assert record["status"]["outcome"] == "ok"
    statuses = [table["statuses"] for table in record["summary"]["cond"].values()]
    assert statuses and all(set(s) == {"not_converged"} for s in statuses)
