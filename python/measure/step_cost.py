"""What a step costs from Python beside the same step of the program: medians of runs in turn.

PYTHONPATH=build/release/python python python/measure/step_cost.py [ROUNDS]
Prints one line a scene: seconds of all steps by the program (wall_s of its record), seconds of the loop over
Simulation.step, their ratio; and the loop over what the record of the same process says of the C++ steps within it,
which other load on the machine does not touch. One thread; only the steps count, not what comes before them.
"""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import barrierbench as bb

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("BARRIERBENCH_PROGRAM", str(ROOT / "build/release/experiments/barrierbench"))
COMMON = {
    "schema": "barrierbench.config/1",
    "formulation": {"name": "cubic", "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 1000}},
    "strain_limit": {"enabled": False},
    "matching": {"rule": "as_given"},
    "passes": {"time": True, "audit": False},
    "threads": 1,
}
SCENES = {
    "drape 8 x 8": {"scene": {"name": "drape", "layers": 1, "n": 8}, "time": {"steps": 40}},
    "drape 24 x 24": {"scene": {"name": "drape", "layers": 1, "n": 24}, "time": {"steps": 15}},
}


def of_program(config: dict, folder: Path) -> tuple[float, str]:
    file = folder / "config.json"
    file.write_text(json.dumps(config))
    subprocess.run(
        [PROGRAM, "run", str(file), "--out", str(folder / "run"), "--progress", "none"],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    summary = json.loads((folder / "run/run.json").read_text())["summary"]
    return summary["wall_s"], summary["state_hash"]


def of_python(config: dict) -> tuple[float, str, float]:
    """Seconds of the loop, the state, seconds within C++."""
    with bb.Simulation(config) as sim:
        start = time.perf_counter()
        while not sim.done:
            sim.step()
        loop = time.perf_counter() - start
        return loop, sim.state_hash, sim.record()["summary"]["wall_s"]


def main(rounds: int) -> None:
    for name, scene in SCENES.items():
        config, program, python, shares = COMMON | scene, [], [], []
        for _ in range(rounds):
            with tempfile.TemporaryDirectory() as folder:
                a, b = of_program(config, Path(folder)), of_python(config)
            if a[1] != b[1]:
                raise SystemExit(f"{name}: the states differ")
            program.append(a[0])
            python.append(b[0])
            shares.append(b[0] / b[2])
        a, b = statistics.median(program), statistics.median(python)
        ratio = f"ratio {b / a:.3f}, over its own C++ steps {statistics.median(shares):.4f}"
        print(f"{name}: program {a:.4f} s, Python {b:.4f} s, {ratio}", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 7)
