"""Checkpoints: results do not depend on them, they do not grow with the steps, and a run that a limit ends keeps one."""

import json
import signal
from pathlib import Path

import pytest
from processes import started, wait_until
from test_cli import BLOCK, bench, refused, write
from test_resume import DRAPE, result, settings

SOLVERS = {
    "cholmod": {"/linear_solver/name": "cholmod"},
    "lagged_cholesky": {"/linear_solver/name": "lagged_cholesky"},
    **{f"pcg {name}": {"/linear_solver/name": "pcg", "/linear_solver/preconditioner": name}
       for name in ("none", "jacobi", "block_jacobi", "ic0", "schwarz", "mas")},
    **{f"pcg_resident {name}": {"/linear_solver/name": "pcg_resident", "/linear_solver/resident_preconditioner": name}
       for name in ("block_jacobi", "multilevel_schwarz")},
    **{f"device host {name}": {"/device": "host", "/linear_solver/resident_preconditioner": name}
       for name in ("block_jacobi", "multilevel_schwarz")},
    "retries": {"/linear_solver/name": "lagged_cholesky", "/step_solver/retries": 8, "/step_solver/max_iterations": 5},
}


# A run without a calibration run: its first steps come at once.
GIVEN = {"/matching": {"rule": "as_given"}, "/strain_limit/stiffness_policy/k_s_N_per_m": 50,
         "/formulation": {"name": "log", "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 50}}}


@pytest.fixture
def config(tmp_path) -> Path:
    return write(tmp_path / "drape.json", DRAPE)


def record_of(folder: Path) -> dict:
    return json.loads((folder / "run.json").read_text())


def left(folder: Path) -> list[str]:
    return sorted(p.name for p in folder.iterdir())


def test_every_solver_and_preconditioner_of_the_registry_is_a_case(program):
    lines = [line for kind in ("linear_solvers", "preconditioners") for line in bench(program, "list", kind).stdout.splitlines()]
    listed = {line.split()[0] for line in lines if line.startswith("  ") and not line.startswith("   ")} - {"cudss"}  # of a card
    assert {"cholmod", "pcg", "schwarz", "ic0"} <= listed
    assert listed <= set(" ".join(SOLVERS).split())


@pytest.mark.parametrize("name", SOLVERS)
def test_a_checkpoint_changes_no_number(program, config, tmp_path, name):
    found = {}
    for every in (0, 1, 3):
        more = settings({**SOLVERS[name], "/output/checkpoint_every": every, "/time/steps": 7})
        done = bench(program, "run", config, "--out", tmp_path / str(every), *more)
        assert done.returncode == 0, done.stderr
        found[every] = {part: value for part, value in result(tmp_path / str(every)).items() if part not in ("ids", "config")}
    assert found[0]["outcome"] == "ok" and sum(step["contacts"]["total"] for step in found[0]["steps"]) > 0
    if name == "retries":
        assert found[0]["summary"]["retries"] > 0
    for every in (1, 3):
        assert found[every]["summary"]["state_hash"] == found[0]["summary"]["state_hash"]
        for part, value in found[0].items():
            assert found[every][part] == value, (every, part)


def stop_again_and_again(program: str, config: Path, folder: Path, more: list[str]) -> list[tuple[str, int]]:
    """Stops a run after every six steps until it is over; returns the passes and steps at which that was."""
    stops = []
    while True:
        done = bench(program, "run", config, "--out", folder, *more, "--step-limit", "6", "--resume")
        assert done.returncode == 0, done.stderr
        record = record_of(folder)
        if record["status"]["outcome"] != "timeout":
            return stops
        assert (folder / "checkpoint.bin").exists() and "run.json.part" not in left(folder)
        diagnoses = "pass diagnose" in record["status"]["detail"]
        assert (folder / "trace.jsonl").exists() == diagnoses
        stops.append(("diagnose" if diagnoses else "time", len(record["steps"])))
        assert len(stops) < 20


@pytest.mark.parametrize("name", ["cholmod", "lagged_cholesky", "pcg schwarz", "pcg_resident multilevel_schwarz", "device host multilevel_schwarz"])
def test_a_run_that_a_limit_stops_goes_on_where_it_was(program, config, tmp_path, name):
    """Without any checkpoint but those that the limit itself leaves."""
    more = settings({**GIVEN, **SOLVERS[name], "/output/checkpoint_every": 0, "/output/frames_every": 5, "/time/steps": 20})
    assert bench(program, "run", config, "--out", tmp_path / "whole", *more).returncode == 0
    stops = stop_again_and_again(program, config, tmp_path / "stopped", more)
    assert stops == [(name, steps) for name in ("time", "diagnose") for steps in (6, 12, 18)]
    expected, found = result(tmp_path / "whole"), result(tmp_path / "stopped")
    assert expected["outcome"] == "ok" and len(expected["artifacts"]) == 2 + 4 + 1 + 1
    for part, value in expected.items():
        assert found[part] == value, part
    assert record_of(tmp_path / "stopped")["status"]["resumed_from_step"] > 0


def test_a_longer_record_of_the_same_run_stays(program, config, tmp_path):
    folder, words = tmp_path / "run", settings({**GIVEN, "/time/steps": 100000})
    assert bench(program, "run", config, "--out", folder, *words, "--step-limit", "40").returncode == 0
    earlier = (folder / "run.json").read_bytes()
    assert json.loads(earlier)["status"]["outcome"] == "timeout" and len(json.loads(earlier)["steps"]) == 40
    kept = {file.name: file.read_bytes() for file in folder.glob("checkpoint*")}
    reported = bench(program, "run", config, "--out", folder, *words, "--resume", "--time-limit", "0.000001")  # stopped before the resumed pass goes on
    refused(reported, "run.json stays", "--resume goes on", code=75)
    assert kept and {file.name: file.read_bytes() for file in folder.glob("checkpoint*")} == kept and (folder / "run.json").read_bytes() == earlier
    for file in folder.glob("checkpoint*"):
        file.unlink()
    for limit in (("--time-limit", "0.000001"), ("--step-limit", "5")):  # before the start is looked at, and within the steps
        reported = bench(program, "run", config, "--out", folder, *words, "--resume", *limit)
        refused(reported, "run.json stays", "steps of this run", code=75)
        assert (folder / "run.json").read_bytes() == earlier
        assert ("--resume goes on" in reported.stderr) == (folder / "checkpoint.bin").exists() == (limit[0] == "--step-limit")
    again = bench(program, "run", config, "--out", folder, *words, "--step-limit", "5")
    assert again.returncode == 75 and "checkpoint.bin goes" in again.stderr and "without --resume" in again.stderr
    assert (folder / "run.json").read_bytes() == earlier


def test_a_step_limit_counts_the_steps_of_each_pass_and_process(program, config, tmp_path):
    folder, more = tmp_path / "run", settings({**GIVEN, "/time/steps": 5, "/passes/time": True, "/passes/diagnose": True})
    for resumed, cut, steps in ((-1, "time", 3), (3, "diagnose", 3), (3, None, 5)):
        done = bench(program, "run", config, "--out", folder, *more, "--step-limit", "3", "--resume")
        assert done.returncode == 0, done.stderr
        status = record_of(folder)["status"]
        assert len(record_of(folder)["steps"]) == steps and (status["resumed_from_step"] or -1) == resumed
        if cut:
            assert status["outcome"] == "timeout" and status["detail"].startswith(f"pass {cut}: the step limit of 3 was reached before step 3")
    assert status["outcome"] == "ok"
    for wrong in ("0", "-1", "2.5", "x"):
        refused(bench(program, "run", config, "--step-limit", wrong), "--step-limit", code=2)


def test_a_sweep_goes_on_from_where_its_limit_stopped_it(program, config, tmp_path):
    spec = write(tmp_path / "sweep.json", {"schema": "barrierbench.sweep/1", "name": "formulations", "base": str(config),
                                           "set": {**GIVEN, "/time/steps": 50}, "axes": [{"pointer": "/formulation/stiffness_policy/kappa_N_per_m", "values": [50, 60]}]})
    out = tmp_path / "out"
    assert bench(program, "sweep", spec, "--out", out, "--step-limit", "3").returncode == 0
    stopped = [json.loads(p.read_text())["status"]["outcome"] for p in sorted(out.glob("*/run.json"))]
    assert stopped == ["timeout", "timeout"] and len(list(out.glob("*/checkpoint.bin"))) == 2
    done = bench(program, "sweep", spec, "--out", out)
    assert done.returncode == 0 and "it ended as timeout" in done.stdout, done.stderr
    for record in (json.loads(p.read_text()) for p in out.glob("*/run.json")):
        assert record["status"]["outcome"] == "ok" and record["status"]["resumed_from_step"] == 3
    assert not list(out.glob("*/checkpoint*"))
    assert bench(program, "sweep", spec, "--out", out).stdout.count("already there") == 2


def test_a_sweep_begins_anew_where_the_checkpoint_is_of_another_run(program, config, tmp_path):
    """And what it then writes is no mixture of both."""
    spec = write(tmp_path / "sweep.json", {"schema": "barrierbench.sweep/1", "name": "one", "base": str(config),
                                           "set": {**GIVEN, "/time/steps": 50}, "axes": [{"pointer": "/time/dt_s", "values": [0.01]}]})
    out = tmp_path / "out"
    stopped = ["sweep", spec, "--out", out, "--step-limit"]
    assert bench(program, *stopped, "2").returncode == 0
    (folder,) = (p.parent for p in out.glob("*/checkpoint.bin"))
    begun = bench(program, *stopped, "3", "--set", "/threads=2")
    assert begun.returncode == 0 and "checkpoint.bin goes" in begun.stderr and "threads" in begun.stderr
    assert record_of(folder)["status"]["outcome"] == "timeout" and len(record_of(folder)["steps"]) == 3
    assert bench(program, "sweep", spec, "--out", out, "--set", "/threads=2").returncode == 0
    assert bench(program, "run", config, "--out", tmp_path / "whole", *settings({**GIVEN, "/time/steps": 50, "/time/dt_s": 0.01, "/threads": 2})).returncode == 0
    whole, found = record_of(tmp_path / "whole"), record_of(folder)
    assert found["status"]["resumed_from_step"] == 3 and found["summary"]["state_hash"] == whole["summary"]["state_hash"]
    assert [s["t_s"] for s in found["steps"]] == [s["t_s"] for s in whole["steps"]]


def test_a_run_that_is_stopped_before_its_first_step_leaves_no_folder(program, tmp_path):
    pierced = {"schema": "barrierbench.config/1", "scene": {"name": "drape", "n": 40}, "formulation": "log",
               "matching": {"rule": "equal_force"}, "time": {"steps": 5}}
    config, out = write(tmp_path / "config.json", pierced), tmp_path / "out"
    with started(program, "run", config, "--out", out) as process:
        wait_until((out / "bench.lock").exists, process)
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate(timeout=120)
    assert process.returncode == 75, err
    assert not out.exists()


@pytest.mark.parametrize("ends", ["whole", "stalls", "limit"])
def test_the_last_state_of_a_run_has_a_frame(program, tmp_path, ends):
    more = {"/time/steps": 1000000 if ends == "limit" else 6, "/output/frames_every": 4, "/passes/time": False}
    if ends == "stalls":
        more |= {"/time/steps": 100, "/matching": {"rule": "as_given"},
                 "/formulation": {"name": "cubic", "d_hat_m": 0.01, "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 1}}}
    limit = ["--step-limit", "7"] if ends == "limit" else []
    assert bench(program, "run", BLOCK, "--out", tmp_path / "out", *settings(more), *limit).returncode == 0
    record = record_of(tmp_path / "out")
    assert (record["status"]["outcome"] == "ok") == (ends == "whole")
    last = record["steps"][-1]["step"]
    frames = [a["path"] for a in record["artifacts"] if a["kind"] == "frame"]
    assert last > 0 and frames[-1] == f"frames/step_{last:06}.ply"
    assert frames == sorted(set(frames)) == sorted(f"frames/{p.name}" for p in (tmp_path / "out/frames").glob("st*.ply"))
    assert len(frames) == 2 + last // 4 + (last % 4 != 0)


def test_a_checkpoint_does_not_grow_with_the_steps(program, tmp_path):
    """The log grows by what a step adds; the checkpoints beside it stay as long as they were."""
    more = settings({"/time/steps": 1000000, "/output/checkpoint_every": 1, "/passes/time": True})

    def sizes(name: str, log_is_longer_than: int) -> tuple[int, int]:
        folder = tmp_path / name
        log = folder / "checkpoint.log"
        with started(program, "run", BLOCK, "--out", folder, *more) as process:
            wait_until(lambda: (folder / "checkpoint.next.bin").exists() and log.stat().st_size > log_is_longer_than, process, 100)
            process.kill()
            process.communicate()
        # one of the two may have been half written when it was killed
        return log.stat().st_size, max(file.stat().st_size for file in folder.glob("checkpoint*.bin"))

    first_log, first = sizes("short", 12000)
    later_log, later = sizes("long", 9 * first_log)
    assert first > 0 and later_log > 9 * first_log
    assert abs(later - first) < 200, (first, later)
