"""The same sweep by one process, GNU parallel, Snakemake, and Slurm on two nodes of this machine: one and the same table.
An engine that is not installed is skipped with what it needs."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest
from sweep_files import ROOT, SHAPES, STEPS, bench, records, write_sweep

CLUSTER = ROOT / "examples/cluster"
TWO_NODES = ROOT / "tests/sweeps/two_node_slurm.sh"
# What says when, how long and by which process: all else is what the runs have found.
OF_THE_RUN = ("_s", "_s_status", "_utc", "rss_bytes", "argv", "load_avg", "command", "run_s", "_bytes")


def snakemake() -> str | None:
    """SNAKEMAKE, or the one that snakemake.sh has installed."""
    found = os.environ.get("SNAKEMAKE", str(ROOT / "build/snakemake/bin/snakemake"))
    return found if Path(found).is_file() else None


def called(words: list, environment: dict) -> None:
    """Errors: skip for exit code 77, as two_node_slurm.sh has it."""
    done = subprocess.run([str(word) for word in words], env=environment, capture_output=True, text=True, check=False, timeout=900)
    if done.returncode == 77:
        pytest.skip(done.stderr.strip().splitlines()[-1])
    assert done.returncode == 0, done.stdout + done.stderr


def by_parallel(spec: Path, out: Path, environment: dict) -> None:
    if shutil.which("parallel") is None:
        pytest.skip("GNU parallel is not installed (apt-get install parallel)")
    called([CLUSTER / "parallel.sh", spec, out, 2], environment)


def by_snakemake(spec: Path, out: Path, environment: dict) -> None:
    if snakemake() is None:
        pytest.skip("Snakemake is not installed (examples/cluster/snakemake.sh SPEC DIR SHARDS installs it)")
    called([CLUSTER / "snakemake.sh", spec, out, 2, "--cores", 2], {**environment, "SNAKEMAKE": snakemake()})
    assert (out / "table.csv").is_file()


def by_slurm(spec: Path, out: Path, environment: dict) -> None:
    called([TWO_NODES, out.parent / "slurm", CLUSTER / "slurm.sh", spec, out, 2, "--wait"], environment)
    jobs = (out.parent / "slurm/jobs.txt").read_text()
    assert "NodeList=n1" in jobs and "NodeList=n2" in jobs


def by_snakemake_on_slurm(spec: Path, out: Path, environment: dict) -> None:
    """This Slurm has no accounting, so the state of a job is read from squeue."""
    if snakemake() is None:
        pytest.skip("Snakemake is not installed (examples/cluster/snakemake.sh SPEC DIR SHARDS installs it)")
    options = ["--executor", "slurm", "--jobs", 2, "--slurm-no-account", "--slurm-status-command", "squeue",
               "--slurm-init-seconds-before-status-checks", 2, "--seconds-between-status-checks", 2]
    called([TWO_NODES, out.parent / "slurm", CLUSTER / "snakemake.sh", spec, out, 2, *options], {**environment, "SNAKEMAKE": snakemake()})
    assert (out / "table.csv").is_file()
    jobs = (out.parent / "slurm/jobs.txt").read_text().splitlines()
    assert len(jobs) == 2 and all("JobState=COMPLETED" in job for job in jobs)


def table(out: Path) -> pd.DataFrame:
    file = out.parent / f"{out.name}.csv"
    done = subprocess.run([sys.executable, ROOT / "analysis", "data", "collect", out, file], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    found = pd.read_csv(file, dtype=str)
    return found[[name for name in found.columns if not name.endswith(OF_THE_RUN) and not name.startswith("provenance_env_")]]  # Snakemake sets OMP_NUM_THREADS


@pytest.mark.parametrize("engine", [by_parallel, by_snakemake, by_slurm, by_snakemake_on_slurm], ids=lambda engine: engine.__name__[3:])
def test_every_engine_collects_the_table_of_one_process(program, tmp_path, engine):
    spec = write_sweep(tmp_path, STEPS, SHAPES, settings={"/time/dt_s": 0.01})
    front = tmp_path / "bench"
    front.write_text(f'#!/usr/bin/env bash\ncase "$1" in status|collect) exec {sys.executable} {ROOT}/analysis "$@";; *) exec {program} "$@";; esac\n')
    front.chmod(0o755)
    engine(spec, tmp_path / "many", {**os.environ, "BENCH": str(front)})
    assert bench(program, "sweep", spec, "--out", tmp_path / "one").returncode == 0
    assert len(records(tmp_path / "many")) == 6
    one, many = table(tmp_path / "one"), table(tmp_path / "many")
    assert len(one.columns) > 100 and list(one["newton_iterations"]) != [one["newton_iterations"][0]] * 6
    pd.testing.assert_frame_equal(one, many)


def test_a_slurm_that_cannot_run_here_says_why(tmp_path):
    done = subprocess.run(["bash", TWO_NODES, tmp_path / "slurm", "true"], env={"PATH": "/nowhere:/bin"}, capture_output=True, text=True, check=False)
    if done.returncode == 0:
        pytest.skip("Slurm lies in /bin here")
    assert done.returncode == 77 and "is not installed" in done.stderr
