"""Runs that are killed and go on from their checkpoint: the same record, bit for bit, but for times."""

import json
import random
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest
from processes import comes_to, new_checkpoints, started, wait_until
from test_cli import bench, refused, write

DRAPE = {
    "schema": "barrierbench.config/1", "scene": {"name": "drape", "n": 6}, "formulation": "log",
    "matching": {"rule": "equal_force"}, "time": {"steps": 12}, "passes": {"time": True, "audit": True},
    "output": {"checkpoint_every": 2}, "threads": 1}
CREEPING = {
    "bodies": [{"name": "cloth", "mesh": {"generator": "grid", "n_x": 12, "n_y": 12}, "transform": {"translate_m": [0, 0, 0.32]},
                "material": {"youngs_N_per_m": 50, "membrane_creep_per_s": 5, "bending_J": 1e-3, "bending_creep_per_s": 5,
                             "bending_yield_rad": 0.01, "cloth_tension_N_per_m": 20, "cloth_shear_N_per_m": 5, "cloth_creep_per_s": 5}}],
    "obstacles": [{"name": "ball", "kind": "sphere", "radius_m": 0.3}]}
CASES = {
    "cholmod": {},
    "two threads": {"/threads": 2},
    "lagged_cholesky": {"/linear_solver/name": "lagged_cholesky"},
    "lagged_cholesky, two threads": {"/linear_solver/name": "lagged_cholesky", "/threads": 2},
    "pcg": {"/linear_solver/name": "pcg"},
    "ipc_adaptive": {"/formulation": "ipc2020"},
    "dart": {"/formulation": "dart"},
    "elasticity_inclusive": {"/formulation": "cubic_dynamic_lagged"},
    "device host": {"/device": "host"},
    "device host, ipc_adaptive": {"/device": "host", "/formulation": "ipc2020"},
    "creep": {"/scene": CREEPING, "/formulation/d_hat_m": 0.01, "/time/dt_s": 0.01, "/time/steps": 60},
    "bdf2": {"/integrator/name": "bdf2"},
    "newmark": {"/integrator/name": "newmark"},
    "bdf2 with retries": {"/integrator/name": "bdf2", "/step_solver/retries": 8, "/step_solver/max_iterations": 5},
    "everything that is written": {"/passes/diagnose": True, "/output/frames_every": 3, "/output/matrices": True,
                                   "/diagnose/every": 4},
}


def settings(overrides: dict) -> list[str]:
    return [word for key, value in overrides.items() for word in ("--set", f"{key}={json.dumps(value)}")]


def without_times(value):
    """A record or a row without what two runs of the same need not share."""
    if isinstance(value, dict):
        times = ("time", "wall_s", "solve_s", "unaccounted_s", "time_s", "surface_gap_time_s", "start_check_s", "peak_rss_bytes", "samples")
        if value.get("path") == "trace.jsonl":  # its lines have times, and are compared without them
            times += ("bytes", "sha256")
        return {k: without_times(v) for k, v in value.items() if k.removesuffix("_status") not in times}
    return [without_times(v) for v in value] if isinstance(value, list) else value


def result(folder: Path) -> dict:
    """All that a run has found, its trace and its files included."""
    record = json.loads((folder / "run.json").read_text())
    left = sorted(str(p.relative_to(folder)) for p in folder.rglob("*"))
    kept = {name: record[name] for name in ("ids", "config", "scene", "labels", "plan", "matching", "audit", "validity", "summary",
                                            "steps", "artifacts")}
    rows = [json.loads(line) for line in (folder / "trace.jsonl").read_text().splitlines()]
    return without_times({**kept, "outcome": record["status"]["outcome"], "rows": rows, "files": left})


def kill_until_done(program: str, config: Path, folder: Path, more: list[str], seed: int) -> int:
    """Kills at random moments behind new checkpoints and resumes until the run is over. Returns how often it was killed."""
    rng = random.Random(seed)
    for kills in range(100):
        with started(program, "run", config, "--out", folder, *more, *(["--resume"] if kills > 0 else [])) as process:
            if comes_to(new_checkpoints(folder, rng.randint(1, 2)), process, 300):
                time.sleep(rng.uniform(0, 0.05))  # a random moment is what it is about
                process.kill()
            _, reported = process.communicate(timeout=300)
        if process.returncode == 0:
            return kills
        assert process.returncode == -signal.SIGKILL, (process.returncode, reported)
    raise AssertionError("a hundred kills, and the run is not over")


@pytest.fixture
def config(tmp_path) -> Path:
    return write(tmp_path / "drape.json", DRAPE)


@pytest.mark.parametrize("name", CASES)
def test_a_run_that_is_killed_at_random_ends_as_one_that_is_not(program, config, tmp_path, name):
    more = settings(CASES[name])
    whole = bench(program, "run", config, "--out", tmp_path / "whole", *more)
    assert whole.returncode == 0, whole.stderr
    kills = kill_until_done(program, config, tmp_path / "killed", more, seed=len(name))
    assert kills >= 2, "killed too seldom to say anything"
    expected, found = result(tmp_path / "whole"), result(tmp_path / "killed")
    assert sum(step["contacts"]["total"] for step in expected["steps"]) > 0 and len(expected["rows"]) > 12
    assert expected["outcome"] == "ok"
    if "retries" in name:
        assert expected["summary"]["retries"] > 0
    if "written" in name:
        assert len(expected["artifacts"]) > 8
    for part, value in expected.items():
        assert found[part] == value, part
    record = json.loads((tmp_path / "killed/run.json").read_text())
    status, summary = record["status"], record["summary"]
    assert status["resumed_from_step"] > 0 and status["resumed_from_step"] % 2 == 0
    assert len(record["steps"]) == len([s for s in record["steps"] if s["wall_s"] > 0])
    assert sum(s["wall_s"] for s in record["steps"]) == pytest.approx(summary["wall_s"])
    unkilled = json.loads((tmp_path / "whole/run.json").read_text())
    assert unkilled["status"]["resumed_from_step_status"] == "whole"


def killed(program: str, config: Path, folder: Path, how=signal.SIGKILL) -> subprocess.CompletedProcess:
    """Stopped in its second pass; a signal that comes when the run is over, on a busy machine, is sent to another one."""
    for _ in range(3):
        with started(program, "run", config, "--out", folder) as process:
            comes_to(new_checkpoints(folder, 7), process, 300)
            process.send_signal(how)
            out, reported = process.communicate(timeout=300)
        assert process.returncode in (0, 75, -signal.SIGKILL), reported
        if (folder / "trace.jsonl.part").exists():
            return subprocess.CompletedProcess(process.args, process.returncode, out, reported)
        shutil.rmtree(folder)
    raise AssertionError("over three times before it could be stopped")


def cut(data: bytes) -> bytes:
    return data[:len(data) * 2 // 3]


def flip(data: bytes) -> bytes:
    at = len(data) * 3 // 4
    return data[:at] + bytes([data[at] ^ 1]) + data[at + 1:]


def test_what_is_no_checkpoint_of_this_run_is_refused_and_stays(program, config, tmp_path):
    folder = tmp_path / "run"
    assert killed(program, config, folder).returncode == -signal.SIGKILL
    file = folder / "checkpoint.bin"
    good = file.read_bytes()
    program_line = good.split(b"\n")[1]
    other_build = good.replace(program_line, b"program " + b"0" * 64, 1)
    damaged = {"cut": (cut(good), "cut off or damaged"), "flipped": (flip(good), "cut off or damaged"),
               "another build": (other_build, "another build"), "empty": (b"", "no checkpoint"), "text": (b"hello\n" * 9, "no checkpoint"),
               "more": (good + b"x", "cut off or damaged")}
    for name, (data, says) in damaged.items():
        file.write_bytes(data)
        refused(bench(program, "run", config, "--out", folder, "--resume"), "checkpoint.bin", says)
        assert file.read_bytes() == data, name
    file.write_bytes(good)
    for other, says in {"/time/steps=13": "/time/steps is 12 there and 13 in this run", "/threads=2": "another number of threads (2, not 1)",
                        "/formulation=\"cubic\"": "/formulation/name is \"log\" there and \"cubic\" in this run"}.items():
        refused(bench(program, "run", config, "--out", folder, "--resume", "--set", other), "checkpoint.bin", "another run", says)
    trace = folder / "trace.jsonl.part"
    rows = trace.read_bytes()
    trace.write_bytes(rows[:100])
    refused(bench(program, "run", config, "--out", folder, "--resume"), "trace.jsonl.part", "shorter")
    trace.write_bytes(rows)
    done = bench(program, "run", config, "--out", folder, "--resume")
    assert done.returncode == 0 and not file.exists(), done.stderr
    assert "already there" in bench(program, "run", config, "--out", folder, "--resume").stdout
    refused(bench(program, "run", folder / "run.json", "--resume"), "--resume")


@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_keeps_the_checkpoint(program, config, tmp_path, how):
    folder = tmp_path / "run"
    stopped = killed(program, config, folder, how)
    assert stopped.returncode == 75 and "--resume" in stopped.stderr and "checkpoint.bin" in stopped.stderr
    assert (folder / "checkpoint.bin").exists() and (folder / "trace.jsonl.part").exists()
    assert not [p for p in folder.iterdir() if ".tmp" in p.name]
    again = bench(program, "run", config, "--out", folder, "--resume")
    assert again.returncode == 0, again.stderr
    assert json.loads((folder / "run.json").read_text())["status"]["resumed_from_step"] > 0
    assert not [p for p in folder.iterdir() if p.name.endswith(".part") or p.name.startswith("checkpoint")]


def test_without_resume_a_run_begins_anew_and_its_checkpoint_goes(program, config, tmp_path):
    folder = tmp_path / "run"
    killed(program, config, folder)
    assert bench(program, "run", config, "--out", folder).returncode == 0
    record = json.loads((folder / "run.json").read_text())
    assert record["status"]["resumed_from_step"] is None and not (folder / "checkpoint.bin").exists()


def test_a_sweep_goes_on_inside_a_case(program, config, tmp_path):
    spec = write(tmp_path / "sweep.json", {"schema": "barrierbench.sweep/1", "name": "formulations", "base": str(config),
                                           "axes": [{"pointer": "/formulation", "values": ["log", "cubic"]}]})
    out = tmp_path / "out"
    with started(program, "sweep", spec, "--out", out) as process:
        wait_until(lambda: list(out.glob("*/checkpoint.bin")), process, 300)
        process.kill()
    assert len(list(out.glob("*/checkpoint.bin"))) == 1
    done = bench(program, "sweep", spec, "--out", out, "--resume")
    assert done.returncode == 0, done.stderr
    resumed = [json.loads(p.read_text())["status"]["resumed_from_step"] for p in sorted(out.glob("*/run.json"))]
    assert len(resumed) == 2 and len([step for step in resumed if step]) == 1


def test_a_time_limit_is_an_outcome(program, config, tmp_path):
    """Long enough for the start, too short for a hundred steps of a larger drape."""
    done = bench(program, "run", config, "--out", tmp_path / "run", "--set", "/scene/n=24", "--set", "/time/steps=100000",
                 "--set", "/matching={\"rule\": \"equal_force\", \"load_N\": 1, \"limit_load_N_per_m\": 1}", "--time-limit", "3")
    assert done.returncode == 0, done.stderr
    record = json.loads((tmp_path / "run/run.json").read_text())
    status = record["status"]
    assert status["outcome"] == "timeout" and "3 s" in status["detail"] and "pass time" in status["detail"]
    assert not status["valid"] and record["summary"]["steps"] == len(record["steps"]) > 0
    assert record["summary"]["wall_s"] > 0 and (tmp_path / "run/checkpoint.bin").exists()
    refused(bench(program, "run", config, "--time-limit", "0"), "--time-limit", code=2)



def test_a_record_that_time_ended_gives_way(program, config, tmp_path):
    out = tmp_path / "out"
    assert bench(program, "run", config, "--out", out, "--time-limit", "1e-6").returncode == 0
    assert json.loads((out / "run.json").read_text())["status"]["outcome"] == "timeout"
    again = bench(program, "run", config, "--out", out, "--resume")
    assert again.returncode == 0 and "already there" not in again.stdout
    assert json.loads((out / "run.json").read_text())["status"]["outcome"] == "ok"
    assert "already there" in bench(program, "run", config, "--out", out, "--resume").stdout


@pytest.mark.parametrize("spoil", ["gone", "another byte"])
def test_a_frame_that_is_not_as_it_was_is_refused_and_the_others_stay(program, config, tmp_path, spoil):
    out, more = tmp_path / "out", settings({"/output/frames_every": 1, "/passes/time": False})
    with started(program, "run", config, "--out", out, *more) as process:
        wait_until(lambda: (out / "frames.part/step_000001.ply").exists() and (out / "checkpoint.bin").exists(), process, 300)
        process.kill()
    frames = sorted((out / "frames.part").iterdir())
    assert len(frames) >= 3
    victim, kept = out / "frames.part/step_000000.ply", tmp_path / "kept.ply"
    kept.write_bytes(victim.read_bytes())
    if spoil == "gone":
        victim.unlink()
    else:
        victim.write_bytes(kept.read_bytes()[:-1] + bytes([kept.read_bytes()[-1] ^ 1]))
    reported = bench(program, "run", config, "--out", out, *more, "--resume")
    assert reported.returncode == 2 and "step_000000.ply" in reported.stderr
    victim.write_bytes(kept.read_bytes())
    assert sorted((out / "frames.part").iterdir()) == frames
    assert bench(program, "run", config, "--out", out, *more, "--resume").returncode == 0
    assert not (out / "frames.part").exists()


def test_an_attempt_that_failed_leaves_neither_matrices_nor_samples(program, config, tmp_path):
    more = settings({**CASES["bdf2 with retries"], "/passes/diagnose": True, "/output/matrices": True, "/passes/time": False})
    assert bench(program, "run", config, "--out", tmp_path / "out", *more).returncode == 0
    record = json.loads((tmp_path / "out/run.json").read_text())
    rows = [json.loads(line) for line in (tmp_path / "out/trace.jsonl").read_text().splitlines()]
    last = {}  # step -> iterations of its last attempt
    for row in rows:
        last[row["step"]] = row["iteration"] + 1
    assert record["summary"]["retries"] > 0 and len(rows) > sum(last.values())
    names = [a["path"] for a in record["artifacts"] if a["kind"] == "matrix"]
    assert names
    for name in names:
        step, iteration = (int(part) for part in Path(name).stem.removesuffix("_exact").removeprefix("step_").split("_iteration_"))
        assert iteration < last[step], name
    assert sorted(str(p.relative_to(tmp_path / "out")) for p in (tmp_path / "out/matrices").glob("*.mtx")) == sorted(names)
    assert record["summary"]["cond"]["full/none"]["log10_cond"]["n"] == sum(last.values())
