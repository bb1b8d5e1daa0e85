"""Who may write to a folder, what an earlier run leaves there, and when a sweep says `already there`."""

import json
import os
import shutil
import signal
from pathlib import Path

import pytest
from processes import started, wait_until

from test_cli import BLOCK, bench, frame, long_run, refused, sweep_spec, write

FRAMES = ["--set", "/output/frames_every=1", "--set", "/passes/time=false"]
MATRICES = ["--set", "/output/matrices=true", "--set", "/passes/diagnose=true"]
HANG = str(Path(BLOCK).with_name("hang.json"))


def names(folder: Path) -> list[str]:
    return sorted(p.name for p in folder.iterdir())


# --- already there


def change(record: Path, section: str, field: str, value) -> None:
    content = json.loads(record.read_text())
    assert content[section][field] != value
    content[section][field] = value
    write(record, content)


@pytest.mark.parametrize("section, field, value, reason", [
    ("ids", "build_id", "b" * 64, "another build"),
    ("ids", "run_id", "c" * 64, "another run_id"),
    ("ids", "machine_id", "d" * 64, "another machine"),
    ("provenance", "libraries", {"blas": "another"}, "another BLAS"),
    ("provenance", "threads", 77, "another number of threads"),
])
def test_the_record_of_another_program_or_machine_does_not_stand_for_a_run(program, tmp_path, section, field, value, reason):
    spec, out = sweep_spec(tmp_path, [1, 2]), tmp_path / "out"
    assert bench(program, "sweep", spec, "--out", out).returncode == 0
    one, two = sorted(out.glob("*/run.json"))
    kept = two.stat().st_mtime_ns
    change(one, section, field, value)
    done = bench(program, "sweep", spec, "--out", out)
    assert done.returncode == 0 and done.stdout.count("already there") == 1
    assert "runs again: " in done.stdout and reason in done.stdout
    assert json.loads(one.read_text())[section][field] != value
    assert two.stat().st_mtime_ns == kept


@pytest.mark.parametrize("content", ["", "{", '{"schema": {"name": "barrierbench.run"}}', "half"])
def test_a_record_that_cannot_be_read_is_not_there(program, tmp_path, content):
    spec, out = sweep_spec(tmp_path, [1]), tmp_path / "out"
    bench(program, "sweep", spec, "--out", out)
    (record,) = out.glob("*/run.json")
    text = record.read_text()
    write(record, text[: len(text) // 2] if content == "half" else content)
    done = bench(program, "sweep", spec, "--out", out)
    assert done.returncode == 0 and "already there" not in done.stdout
    reason = "run.json#/schema/version: found null" if "schema" in content else "cannot be read"
    assert "runs again: " in done.stdout and reason in done.stdout
    assert json.loads(record.read_text())["status"]["outcome"] == "ok"


def test_a_record_whose_files_are_gone_does_not_stand_for_a_run(program, tmp_path):
    spec, out = sweep_spec(tmp_path, [1]), tmp_path / "out"
    words = ["sweep", spec, "--out", out, "--set", "/output/frames_every=1"]
    assert bench(program, *words).returncode == 0
    (record,) = out.glob("*/run.json")
    files = [artifact["path"] for artifact in json.loads(record.read_text())["artifacts"]]
    assert "trace.jsonl" in files and "frames/start.ply" in files
    for name in ("trace.jsonl", "frames/start.ply"):
        assert "already there" in bench(program, *words).stdout
        (record.parent / name).unlink()
        done = bench(program, *words)
        assert done.returncode == 0 and f"runs again: {name} is gone" in done.stdout and "already there" not in done.stdout
        assert all((record.parent / file).is_file() for file in files)


def test_another_plugin_of_the_same_name_is_another_run(program, build_folder, tmp_path):
    built = build_folder / "examples/plugins/plugin_inverse_shape.so"
    if not built.exists():
        pytest.skip(f"{built} is not built")
    plugin = Path(shutil.copy(built, tmp_path / "shape.so"))
    sweep = ["--plugin", plugin, "sweep", sweep_spec(tmp_path, [1]), "--out", tmp_path / "out"]
    assert bench(program, *sweep).returncode == 0
    assert bench(program, *sweep).stdout.count("already there") == 1
    with plugin.open("ab") as file:
        file.write(b"\0")
    done = bench(program, *sweep)
    assert done.returncode == 0 and "another set of plugins" in done.stdout and "already there" not in done.stdout


# --- one writer a folder


@pytest.mark.parametrize("verb", ["run", "sweep"])
def test_a_folder_has_one_writer(program, tmp_path, verb):
    out = tmp_path / "out"
    arguments = long_run(tmp_path) if verb == "run" else ["sweep", sweep_spec(tmp_path, [1000000]), "--out", out]
    with started(program, *arguments) as first:
        place = "bench.lock" if verb == "run" else "*/bench.lock"  # a sweep holds the folders of its runs
        wait_until(lambda: any(f"process {first.pid} on " in lock.read_text() for lock in out.glob(place)), first)
        second = bench(program, *arguments)
        assert second.returncode == 75 and f"in use by process {first.pid} on " in second.stderr and str(out) in second.stderr
        assert first.poll() is None and not list(out.rglob("run.json"))
        first.kill()
        first.communicate()
    short = ["run", BLOCK, "--set", "/time/steps=1"] if verb == "run" else ["sweep", sweep_spec(tmp_path, [1])]
    after = bench(program, *short, "--out", out)
    assert after.returncode == 0, after.stderr
    assert not list(out.glob("bench.lock")) and not list(out.glob("*steps=1-*/bench.lock"))


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_an_interrupted_sweep_says_what_it_kept_and_goes_on(program, tmp_path, sent):
    out = tmp_path / "out"
    with started(program, "sweep", sweep_spec(tmp_path, [1, 2, 1000000]), "--out", out) as sweep:
        wait_until(lambda: len(list(out.glob("*/run.json"))) == 2 and list(out.glob("*1000000*/bench.lock")), sweep)
        sweep.send_signal(sent)
        _, err = sweep.communicate(timeout=30)
    assert sweep.returncode == 75, err
    assert "2 of 3 records kept" in err and str(out) in err and "the same command" in err
    assert len(list(out.glob("*/run.json"))) == 2 and not list(out.rglob("*.part")) and not list(out.rglob("bench.lock"))
    done = bench(program, "sweep", sweep_spec(tmp_path, [1, 2, 3]), "--out", out)
    assert done.returncode == 0 and done.stdout.count("already there") == 2


def test_a_hang_up_ends_a_run_as_a_termination_does(program, tmp_path):
    with started(program, *long_run(tmp_path)) as run:
        wait_until(frame(tmp_path, 1).exists, run)
        run.send_signal(signal.SIGHUP)
        _, err = run.communicate(timeout=30)
    assert run.returncode == 75 and "interrupted" in err and "--resume" in err
    assert names(tmp_path / "out") == ["checkpoint.bin", "checkpoint.log", "frames.part", "trace.jsonl.part"]


def test_under_nohup_a_hang_up_is_ignored(program, tmp_path):
    def nohup():
        signal.signal(signal.SIGHUP, signal.SIG_IGN)

    with started(program, *long_run(tmp_path), restore_signals=False, preexec_fn=nohup) as run:
        wait_until(frame(tmp_path, 1).exists, run)
        run.send_signal(signal.SIGHUP)
        there = len(names(tmp_path / "out/frames.part"))
        wait_until(lambda: len(names(tmp_path / "out/frames.part")) > there + 2, run)  # it goes on
        run.send_signal(signal.SIGTERM)
        run.communicate(timeout=30)
    assert run.returncode == 75


# --- what an earlier run left


def test_frames_and_matrices_of_an_earlier_run_go_and_nothing_else(program, tmp_path):
    out = tmp_path / "out"
    assert bench(program, "run", HANG, "--out", out, "--set", "/time/steps=3", *FRAMES, *MATRICES).returncode == 0
    assert names(out / "frames") == ["scene.json", "start.ply", *(f"step_{k:06}.ply" for k in range(3))]
    assert len(names(out / "matrices")) >= 3
    mine = write(out / "frames/notes.txt", "mine")
    changed = write(out / "frames/step_000002.ply", "edited by hand")
    stranger = write(out / "matrices/step_000099_iteration_000.mtx", "of no run")
    assert bench(program, "run", HANG, "--out", out, "--set", "/time/steps=1", *FRAMES, "--replace").returncode == 0
    record = json.loads((out / "run.json").read_text())
    assert [a["path"] for a in record["artifacts"]] == ["frames/scene.json", "frames/start.ply", "frames/step_000000.ply", "trace.jsonl"]
    assert names(out / "frames") == ["notes.txt", "scene.json", "start.ply", "step_000000.ply", "step_000002.ply"]
    assert names(out / "matrices") == [stranger.name]
    assert mine.read_text() == "mine" and changed.read_text() == "edited by hand"


def test_an_earlier_run_stays_whole_until_the_next_is_over(program, tmp_path):
    out = tmp_path / "out"
    short = ["run", BLOCK, "--out", out, "--set", "/time/steps=2", *FRAMES]
    assert bench(program, *short).returncode == 0
    before = {p: p.read_bytes() for p in out.rglob("*") if p.is_file()}
    assert len(before) == 6
    with started(program, *long_run(tmp_path), "--replace") as run:
        wait_until(frame(tmp_path, 1).exists, run)
        run.terminate()
        run.communicate(timeout=30)
    assert run.returncode == 75
    kept = ("checkpoint.bin", "checkpoint.log", "checkpoint.next.bin", "trace.jsonl.part")
    assert {p: p.read_bytes() for p in out.rglob("*") if p.is_file() and p.name not in kept and p.parent.name != "frames.part"} == before
    assert (out / "checkpoint.bin").exists() and (out / "frames.part").exists()  # the new run can go on


def test_what_a_killed_run_left_goes_with_the_next(program, tmp_path):
    out = tmp_path / "out"
    with started(program, *long_run(tmp_path)) as run:
        wait_until(frame(tmp_path, 1).exists, run)
        run.kill()
        run.communicate()
    left = names(out)
    assert "bench.lock" in left and "frames.part" in left
    write(out / "frames.part/mine.txt", "mine")
    write(out / f"run.json.tmp.{run.pid}", "{")
    assert bench(program, "run", BLOCK, "--out", out, "--set", "/time/steps=1", "--replace").returncode == 0
    assert names(out) == ["frames.part", "run.json", "trace.jsonl"]
    assert names(out / "frames.part") == ["mine.txt"]


@pytest.mark.parametrize("name", ["run.json", "trace.jsonl", "frames", "matrices"])
def test_what_is_in_the_way_is_named_before_the_first_step(program, tmp_path, name):
    """Found at the end, it would cost the new run and the earlier one."""
    earlier = write(tmp_path / "run.json", "{}") if name != "run.json" else None
    in_the_way = tmp_path / name
    if "." in name:
        in_the_way.mkdir()
    else:
        in_the_way.write_text("mine")
    done = bench(program, "run", BLOCK, "--out", tmp_path, *FRAMES, *(["--replace"] if earlier else []))
    refused(done, str(in_the_way), "in the way")
    assert "step" not in done.stdout
    assert earlier is None or earlier.read_text() == "{}"
    assert in_the_way.is_dir() if "." in name else in_the_way.read_text() == "mine"


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_may_only_be_read(program, tmp_path):
    tmp_path.chmod(0o555)
    refused(bench(program, "run", BLOCK, "--out", tmp_path), "Permission denied")
    tmp_path.chmod(0o755)
