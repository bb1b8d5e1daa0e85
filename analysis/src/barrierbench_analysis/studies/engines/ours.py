"""The same scene under this program: its frames at the times of an engine's, its time and iterations."""

import json
import shutil
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.frames import frames_of
from barrierbench_analysis.io.record_file import read_record
from barrierbench_analysis.io.whole_file import bytes_of, write_whole, write_whole_bytes
from barrierbench_analysis.program.start import started


@dataclass(frozen=True)
class Config:
    """A config with what is changed of it: pointer -> value."""

    file: Path
    set: dict = field(default_factory=dict)

    def sets(self) -> list[str]:
        """--set of the program, POINTER=JSON."""
        return [f"{pointer}={json.dumps(value)}" for pointer, value in self.set.items()]


def run(
    config: Config, scene: dict, out: Path, parts: int = 1, more: dict | None = None, limit_s: float = 600
) -> dict:
    """As launch.run, for `parts` steps a frame; more: settings of this run alone. Errors: none of the run."""
    changed = {
        **config.set,
        "/time/dt_s": scene["dt_s"] / parts,
        "/time/steps": scene["steps"] * parts,
        "/output/frames_every": 1,
        **(more or {}),
    }
    folder, log = out / "run", out / "log.txt"
    shutil.rmtree(folder, ignore_errors=True)
    out.mkdir(parents=True, exist_ok=True)
    answer = {"engine": "barrierbench", "log": str(log), "out": str(out), "run": None}
    words = [word for one in Config(config.file, changed).sets() for word in ("--set", one)]
    try:
        done = started("run", str(config.file), *words, "--out", str(folder), timeout=limit_s)
    except subprocess.TimeoutExpired:
        return answer | {"outcome": "timed_out", "detail": f"after {limit_s:g} s"}
    write_whole(log, done.stdout + done.stderr)
    if done.returncode != 0:
        return answer | {"outcome": "crashed", "detail": (done.stderr.strip().splitlines() or [""])[-1]}
    record = read_record(folder / "run.json")
    status = record["status"]["outcome"]
    if status != "ok":
        return answer | {"outcome": "crashed", "detail": f"outcome {status}"}
    _write_frames(record, folder, scene, out, parts)
    summary = record["summary"]
    answer["run"] = {
        "version": record["ids"].get("build_id", ""),
        "settings": changed,
        "dt_s": scene["dt_s"] / parts,
        "stepping_s": summary["solve_s"],
        "iterations_a_step": summary["newton_iterations"] / summary["steps"],
        "notes": {"contacts_most": max(step["contacts"]["total"] for step in record["steps"])},
    }
    return answer | {"outcome": "ok", "detail": ""}


def _write_frames(record: dict, folder: Path, scene: dict, out: Path, parts: int) -> None:
    """Of the start and of the ends of frames: step `parts` - 1 ends the first. Vertices that stand for
    obstacles that move come last, and are left out.
    """
    n = len(scene["positions_m"])
    steps = [-1, *range(parts - 1, scene["steps"] * parts, parts)]
    states = np.array([frame.vertices[:n] for frame in frames_of(record, folder, steps)], float)
    arrays = {
        "positions": states,
        "triangles": np.array(scene["triangles"], int).reshape(-1, 3),
        "times_s": scene["dt_s"] * np.arange(len(states)),
    }
    if "segments" in scene:
        arrays["segments"] = np.array(scene["segments"], int)
    write_whole_bytes(out / "frames.npz", bytes_of(lambda file: np.savez_compressed(file, **arrays)))
