"""A run that gets less memory than it needs: an outcome with a record, found by giving it less and less."""

import json
import os
import resource
import subprocess
from pathlib import Path

import pytest

from tests.hostile.test_hostile import is_sanitized

CONFIG = {"schema": "barrierbench.config/1", "scene": {"name": "drape", "n": 16}, "formulation": "log",
    "matching": {"rule": "equal_force", "load_N": 0.03, "limit_load_N_per_m": 4},
    "passes": {"time": True, "audit": False}, "time": {"steps": 2}, "threads": 1}


def limited(program: str, folder: Path, megabytes: int) -> subprocess.CompletedProcess:
    def limits() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (megabytes << 20, megabytes << 20))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    return subprocess.run([program, "run", "drape.json", "--out", folder], cwd=folder.parent, env=environment, capture_output=True,
                          text=True, check=False, timeout=60, preexec_fn=limits)


def test_memory_that_runs_out_is_an_outcome_with_a_record(program, tmp_path):
    if is_sanitized(program):
        pytest.skip("the sanitizers need an address space without a limit")
    (tmp_path / "drape.json").write_text(json.dumps(CONFIG))
    seen = {}
    assert limited(program, tmp_path / "enough", 4000).returncode == 0
    low, high = 150, 700  # MB: dies or is refused; has all it needs
    while high - low > 4:
        megabytes = (low + high) // 2
        folder = tmp_path / str(megabytes)
        done = limited(program, folder, megabytes)
        assert done.returncode in (0, 2, 75, 127), (megabytes, done.returncode, done.stderr[:500])
        record = json.loads((folder / "run.json").read_text()) if done.returncode == 0 else None
        outcome = record["status"]["outcome"] if record else done.returncode
        seen[megabytes] = outcome
        if outcome == "oom":
            assert "memory ran out" in record["status"]["detail"] and not record["status"]["valid"]
            assert len(record["steps"]) == record["summary"]["steps"] < 2
            assert not [p for p in folder.iterdir() if ".tmp" in p.name or p.name.endswith(".part")]
            return
        low, high = (low, megabytes) if outcome != 2 and record else (megabytes, high)
    raise AssertionError(f"no limit between none at all and enough ends in oom: {seen}")
