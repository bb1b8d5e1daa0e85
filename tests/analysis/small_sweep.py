"""A sweep of two formulations in contact that takes a second, as the program makes it."""

import json
import subprocess
from pathlib import Path

BLOCK = Path(__file__).resolve().parents[2] / "configs/scenes/resting_block_1d.json"


def sweep_of(program, folder: Path) -> Path:
    """Runs it; the folder of its records."""
    spec = folder / "spec.json"
    spec.write_text(json.dumps({
        "schema": "barrierbench.sweep/1", "name": "small", "base": str(BLOCK), "set": {"/time/steps": 30, "/passes/diagnose": True},
        "axes": [{"cases": [{"label": "log", "set": {"/formulation": "log"}}, {"label": "cubic", "set": {"/formulation": "cubic"}}]}]}))
    done = subprocess.run([program, "sweep", spec, "--out", folder / "out"], capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, done.stderr
    return folder / "out"
