"""A small run with frames, and a way to damage a copy of it."""

import hashlib
import json
import subprocess
from pathlib import Path

CONFIG = {
    "schema": "barrierbench.config/1",
    "scene": {
        "bodies": [
            {"name": "cloth", "mesh": {"generator": "grid", "n_x": 6, "n_y": 6, "size_x_m": 0.4, "size_y_m": 0.4},
             "transform": {"translate_m": [0.03, 0.01, 0.106]}, "velocity_m_per_s": [0, 0, -0.5]},
            {"name": "rod", "mesh": {"generator": "rod", "n_segments": 3, "length_m": 0.2},
             "transform": {"translate_m": [0, 0, 0.2]}, "limited": False,
             "material": {"springs_N_per_m": 100, "line_density_kg_per_m": 0.1}},
        ],
        "obstacles": [{"name": "ball", "kind": "sphere", "point_m": [0, 0, 0], "radius_m": 0.1}],
    },
    "formulation": {"name": "log", "d_hat_m": 0.005},
    "strain_limit": {"limit": 0.05},
    "time": {"dt_s": 0.01, "steps": 5},
    "output": {"frames_every": 1},
    "passes": {"time": False},
}


def run_of(program: str, out: Path, *sets: str) -> Path:
    """The folder of a run of CONFIG."""
    file = out.with_suffix(".json")
    file.write_text(json.dumps(CONFIG))
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
