"""Small sweeps of scenes that take milliseconds, and what they leave."""

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/experiments"))
from test_resume import without_times  # noqa: E402

BLOCK = ROOT / "configs/scenes/resting_block_1d.json"
STEPS = {"pointer": "/time/steps", "values": [2, 3]}
SHAPES = {"pointer": "/formulation", "values": ["log", "quadratic", "cubic"]}
QUICK = {"/passes/diagnose": False, "/threads": 1}


def write_sweep(folder: Path, *axes: dict, settings: dict | None = None, **more) -> Path:
    """A sweep file over the block of one degree of freedom."""
    file = folder / "own.json"
    data = {"schema": "barrierbench.sweep/1", "name": "own", "base": str(BLOCK), "set": {**QUICK, **(settings or {})}, "axes": list(axes)}
    file.write_text(json.dumps({**data, **more}))
    return file


def bench(program: str, *words, **options) -> subprocess.CompletedProcess:
    return subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False, **options)


def verb(*words) -> subprocess.CompletedProcess:
    """A verb in Python."""
    return subprocess.run([sys.executable, ROOT / "analysis", *map(str, words)], capture_output=True, text=True, check=False)


def planned(program: str, file: Path, *words) -> list[str]:
    """The names of the folders that a sweep would write."""
    done = bench(program, "sweep", file, "--dry-run", *words)
    assert done.returncode == 0, done.stderr
    return [Path(line).name for line in done.stdout.splitlines()]


def refused(done: subprocess.CompletedProcess, *message: str, code: int = 2) -> None:
    assert done.returncode == code, (done.returncode, done.stdout, done.stderr)
    for text in message:
        assert text in done.stderr, (text, done.stderr)


def records(out: Path) -> dict[str, dict]:
    """Label of the case -> record."""
    found = [json.loads(path.read_text()) for path in sorted(out.glob("*/run.json"))]
    return {record["labels"]["note"].removeprefix("own: "): record for record in found}


def results(out: Path) -> dict[str, dict]:
    """Label -> what the run has found, without times, what it was called with and where a process began."""
    sections = ("ids", "config", "scene", "labels", "matching", "audit", "validity", "summary", "steps", "comparability")
    return {label: without_times({"outcome": record["status"]["outcome"], **{name: record[name] for name in sections}})
            for label, record in records(out).items()}


def left_over(out: Path) -> list[str]:
    """What no finished sweep leaves."""
    return sorted(path.name for path in out.rglob("*") if ".tmp." in path.name or path.suffix == ".part" or path.name.startswith("checkpoint"))
