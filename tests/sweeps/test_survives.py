"""Sweeps that are killed, interrupted, short of disk space, or not alone in their folder: nothing is lost and nothing is made twice."""

import os
import resource
import signal
import socket
import time
from pathlib import Path

import pytest
from processes import started, wait_for, wait_until
from sweep_files import SHAPES, STEPS, bench, left_over, records, refused, results, verb, write_sweep

LONG = {"/time/steps": 600, "/output/checkpoint_every": 20}


def locks(out: Path) -> list[Path]:
    return list(out.glob("*/bench.lock"))


@pytest.fixture(scope="module")
def undisturbed(program, tmp_path_factory) -> dict:
    """What the long sweep finds when nobody disturbs it."""
    folder = tmp_path_factory.mktemp("undisturbed")
    assert bench(program, "sweep", write_sweep(folder, SHAPES, settings=LONG), "--out", folder / "out").returncode == 0
    found = results(folder / "out")
    assert len(found) == 3 and all(len(one["steps"]) == 600 for one in found.values())
    return found


@pytest.mark.parametrize("jobs", [1, 2])
@pytest.mark.parametrize("sent", [signal.SIGKILL, signal.SIGTERM])
def test_a_sweep_that_is_stopped_goes_on_to_the_same_records(program, tmp_path, undisturbed, jobs, sent):
    file, out = write_sweep(tmp_path, SHAPES, settings=LONG), tmp_path / "out"
    with started(program, "sweep", file, "--out", out, "--jobs", jobs) as sweep:
        wait_until(lambda: list(out.glob("*/checkpoint.bin")), sweep)
        sweep.send_signal(sent)
        _, reported = sweep.communicate(timeout=60)
    assert sweep.returncode == (75 if sent == signal.SIGTERM else -sent), reported
    if sent == signal.SIGTERM:
        assert f"records kept in {out}" in reported and not locks(out)
    assert list(out.glob("*/checkpoint.bin")) and len(records(out)) < 3
    if jobs == 2:  # without their parent the runs keep a checkpoint and end
        wait_for(lambda: not locks(out))
    done = bench(program, "sweep", file, "--out", out, "--jobs", jobs)
    assert done.returncode == 0, done.stderr
    found = results(out)
    assert found == undisturbed
    assert any(record["status"]["resumed_from_step"] for record in records(out).values())
    assert not left_over(out) and not list(out.rglob("bench.lock"))


def test_two_sweeps_in_one_folder_make_every_record_once(program, tmp_path):
    many = {"pointer": "/time/steps", "range": {"from": 100, "to": 111, "count": 12}}
    file, out = write_sweep(tmp_path, many), tmp_path / "out"
    with started(program, "sweep", file, "--out", out, "--jobs", 2) as one, started(program, "sweep", file, "--out", out) as two:
        message = [process.communicate(timeout=60) for process in (one, two)]
    assert {one.returncode, two.returncode} <= {0, 75} and 0 in (one.returncode, two.returncode), message
    rows = [line for out_text, _ in message for line in out_text.split("\n\n")[0].splitlines() if line.startswith("own: ")]
    made = [line.split("  ")[0] for line in rows if " ok " in line]
    assert len(records(out)) == 12 and sorted(set(made)) == sorted(f"own: {label}" for label in records(out))
    started_at = {path.parent.name: path.stat().st_mtime_ns for path in out.glob("*/run.json")}
    again = bench(program, "sweep", file, "--out", out)
    assert again.stdout.count("already there") == 12
    assert {path.parent.name: path.stat().st_mtime_ns for path in out.glob("*/run.json")} == started_at


def test_a_run_that_another_process_has_is_left_to_it(program, tmp_path):
    file, out = write_sweep(tmp_path, SHAPES, settings={"/time/steps": 10**6}), tmp_path / "out"
    with started(program, "sweep", file, "--out", out, "--index", 1) as other:
        wait_until(lambda: locks(out), other)
        short = bench(program, "sweep", file, "--out", out, "--jobs", 2, "--time-limit", "0.1")
        refused(short, "1 of 3 runs are made by other processes", f"in use by process {other.pid} on", code=75)
        seen = verb("status", out)
        assert "2 over (2 timeout), 1 running" in seen.stdout and f"process {other.pid} on" in seen.stdout and seen.returncode == 1
        other.kill()
        other.communicate()
    assert "1 dead" in verb("status", out).stdout
    assert bench(program, "sweep", file, "--out", out, "--index", 1, "--time-limit", "0.1").returncode == 0
    assert "3 over" in verb("status", out).stdout


def test_a_lock_of_another_host_holds_as_long_as_it_gives_signs_of_life(program, tmp_path):
    file, out = write_sweep(tmp_path, STEPS), tmp_path / "out"
    folder = out / Path(bench(program, "sweep", file, "--index", 0, "--dry-run").stdout.strip()).name
    folder.mkdir(parents=True)
    lock = folder / "bench.lock"
    lock.write_text(f"process 1 on not-{socket.gethostname()} since 2026-01-01T00:00:00.000Z")
    refused(bench(program, "sweep", file, "--out", out), "1 of 2 runs", "in use by process 1 on not-", code=75)
    assert lock.exists() and len(records(out)) == 1
    os.utime(lock, (time.time() - 61,) * 2)
    assert bench(program, "sweep", file, "--out", out).returncode == 0
    assert not lock.exists() and len(records(out)) == 2


def test_a_lock_gives_signs_of_life(program, tmp_path):
    with started(program, "sweep", write_sweep(tmp_path, {"pointer": "/time/steps", "values": [10**7]}), "--out", tmp_path / "out") as sweep:
        wait_until(lambda: locks(tmp_path / "out"), sweep)
        (lock,) = locks(tmp_path / "out")
        os.utime(lock, (0, 0))
        wait_until(lambda: time.time() - lock.stat().st_mtime < 60, sweep, 20)


def test_where_there_is_no_room_nothing_is_half_written(program, tmp_path):
    file, out = write_sweep(tmp_path, SHAPES), tmp_path / "out"

    def little_room():
        resource.setrlimit(resource.RLIMIT_FSIZE, (8192, 8192))

    done = bench(program, "sweep", file, "--out", out, "--jobs", 2, preexec_fn=little_room)
    assert done.returncode == 75 and "File too large" in done.stderr, (done.returncode, done.stderr)
    assert not records(out) and not [name for name in left_over(out) if ".tmp." in name]
    assert bench(program, "sweep", file, "--out", out).returncode == 0 and len(records(out)) == 3


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_cannot_be_written_is_said(program, tmp_path):
    out = tmp_path / "out"
    out.mkdir(mode=0o500)
    refused(bench(program, "sweep", write_sweep(tmp_path, STEPS), "--out", out, "--jobs", 2), str(out), "Permission denied")


def test_a_run_whose_process_dies_stops_no_other(program, tmp_path):
    file, out = write_sweep(tmp_path, {"pointer": "/time/steps", "values": [2, 10**7, 3]}), tmp_path / "out"
    with started(program, "sweep", file, "--out", out, "--jobs", 3) as sweep:
        under_way = lambda: [lock for lock in locks(out) if not (lock.parent / "run.json").exists()]  # not those that a run which has ended still holds
        wait_until(lambda: len(records(out)) == 2 and len(under_way()) == 1, sweep)
        (lock,) = under_way()
        os.kill(int(lock.read_text().split()[1]), signal.SIGABRT)
        reported = sweep.communicate(timeout=60)[1]
    assert sweep.returncode == 70 and "killed by signal 6" in reported and "steps=10000000" in reported
    assert len(records(out)) == 2


def test_progress_counts_the_runs_of_all_processes(program, tmp_path):
    many = {"pointer": "/time/steps", "range": {"from": 2, "to": 9, "count": 8}}
    done = bench(program, "sweep", write_sweep(tmp_path, many), "--out", tmp_path / "out", "--jobs", 2, "--progress-every", "0.005")
    assert done.returncode == 0 and "/8] " in done.stderr and "running" in done.stderr and "eta of all" in done.stderr
    assert "\033" not in done.stderr
