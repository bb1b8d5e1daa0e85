"""Names and paths with control characters are shown on the standard output, not sent to the terminal."""

import json
from pathlib import Path

from test_cli import BLOCK, bench, sweep_spec, write

ESCAPE, SHOWN = "a\x1b[31mb", "a\\x1b[31mb"


def shown(done) -> str:
    assert done.returncode == 0 and SHOWN in done.stdout and "\x1b" not in done.stdout + done.stderr, (done.stdout, done.stderr)
    return done.stdout


def test_places_of_runs_and_names_of_records(program, tmp_path):
    out = tmp_path / ESCAPE
    words = ("run", BLOCK, "--set", "/time/steps=1", "--out", out)
    assert shown(bench(program, *words)).endswith(f"{tmp_path}/{SHOWN}/run.json\n")
    assert shown(bench(program, *words, "--resume")).startswith("already there\n")
    record = json.loads((out / "run.json").read_text())
    record["labels"]["note"] = ESCAPE
    write(out / "run.json", record)
    (row,) = [line for line in shown(bench(program, "run", out / "run.json", "--out", tmp_path / "again")).splitlines() if line.startswith(SHOWN)]
    head = bench(program, *words).stdout.splitlines()[0]
    assert row.index("ok") == head.index("outcome")  # the columns stand below their titles


def test_places_of_sweeps(program, tmp_path):
    spec, out = sweep_spec(tmp_path, [1]), tmp_path / ESCAPE
    shown(bench(program, "sweep", spec, "--out", out, "--dry-run"))
    assert bench(program, "sweep", spec, "--out", out).returncode == 0
    (out / next(out.glob("*/run.json"))).write_text("{")
    done = bench(program, "sweep", spec, "--out", out)
    assert done.returncode == 0 and "runs again" in done.stdout and "\x1b" not in done.stdout + done.stderr
    shown(bench(program, "plan", spec, "--out", out))


def test_the_file_that_is_checked(program, tmp_path):
    config = tmp_path / f"{ESCAPE}.json"
    config.write_text(Path(BLOCK).read_text())
    shown(bench(program, "check", config))
