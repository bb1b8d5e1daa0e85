"""A small run with frames, and a way to damage a copy of it."""

import hashlib
import json
import subprocess
from pathlib import Path

from tests.falling_cloth import CLOTH_ON_BALL


def run_of(program: str, out: Path, *sets: str) -> Path:
    """The folder of a run with a frame a step."""
    file = out.with_suffix(".json")
    file.write_text(json.dumps({**CLOTH_ON_BALL, "output": {"frames_every": 1}}))
    words = [word for pair in sets for word in ("--set", pair)]
    done = subprocess.run([program, "run", file, "--out", out, *words], capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stderr
    return out


def put(run: Path, name: str, content: bytes) -> None:
    """Another content of a file of a run, which the record names as its own."""
    (run / name).write_bytes(content)
    record = json.loads((run / "run.json").read_text())
    for file in record["artifacts"]:
        if file["path"] == name:
            file.update(sha256=hashlib.sha256(content).hexdigest(), bytes=len(content))
    (run / "run.json").write_text(json.dumps(record))
