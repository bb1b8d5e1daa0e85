"""The verb fuzz without clang: what it makes of libFuzzer's words, of a target that crashes and of one that never ran."""

import stat
import subprocess
import sys
from pathlib import Path

import pytest
from barrierbench_analysis.front import fuzz

LOG = """INFO: Seed: 1
#2	INITED cov: 120 ft: 300 corp: 2/80b exec/s: 0 rss: 40Mb
#900	NEW    cov: 140 ft: 350 corp: 3/90b lim: 80 exec/s: 300 rss: 41Mb L: 10/80 MS: 1 CrossOver-
#1000	DONE   cov: 145 ft: 351 corp: 4/90b lim: 80 exec/s: 333 rss: 41Mb
stat::number_of_executed_units: 1000
stat::average_exec_per_sec:     333
"""

ROOT = Path(__file__).resolve().parents[2]


def target(build: Path, name: str, script: str) -> None:
    path = build / "tests" / "fuzz" / f"fuzz_{name}"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/bash\n{script}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)


def test_executions_and_coverage_are_read():
    assert fuzz.parse_log(LOG) == {"executions": 1000, "coverage": 145, "new_coverage": 25}
    cut = LOG[: LOG.index("#1000")]
    assert fuzz.parse_log(cut) == {"executions": 900, "coverage": 140, "new_coverage": 20}
    assert fuzz.parse_log("") == {"executions": 0, "coverage": None, "new_coverage": None}


def test_a_crash_is_a_failure_and_its_input_is_kept(tmp_path):
    target(tmp_path, "matrix", f"cat >&2 <<'END'\n{LOG}END\necho input > crash-1\nexit 77")
    row = fuzz.run_target("matrix", tmp_path, tmp_path / "found", seconds=1, runs=None, seed=1)
    assert row["failed"] and [Path(p).name for p in row["findings"]] == ["crash-1"]
    assert (tmp_path / "found" / "matrix" / "log.txt").read_text() == LOG
    assert fuzz.table([row]).splitlines()[1].split()[-1] == "1"


def test_a_target_that_ran_nothing_is_no_pass(tmp_path):
    target(tmp_path, "matrix", "exit 0")
    assert fuzz.run_target("matrix", tmp_path, tmp_path / "found", seconds=1, runs=None, seed=1)["failed"]


def test_a_clean_run_is_one(tmp_path):
    target(tmp_path, "matrix", f"cat >&2 <<'END'\n{LOG}END")
    row = fuzz.run_target("matrix", tmp_path, tmp_path / "found", seconds=None, runs=10, seed=1)
    assert not row["failed"] and row["findings"] == [] and row["executions"] == 1000


def test_targets_are_those_of_the_list():
    folder = fuzz.ROOT / "tests" / "fuzz"
    assert len(fuzz.targets()) >= 11
    for name in fuzz.targets():
        assert (folder / f"{name}.cpp").is_file(), name
    with pytest.raises(fuzz.UserError, match="'mesh'.*mesh_obj"):
        fuzz.chosen(["mesh"])


def test_an_unknown_target_ends_with_2():
    done = subprocess.run([sys.executable, str(ROOT / "analysis"), "dev", "fuzz", "nothing"], capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "found target 'nothing'" in done.stderr
