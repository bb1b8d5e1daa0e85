"""One run of an engine: its adapter in its own environment, until it ends; how it ended, in a word."""

import json
import subprocess
from pathlib import Path

import numpy as np

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.whole_file import write_whole

from . import environment
from .card import Card

REFUSED = 3  # exit code of an adapter, as engines/common.py has it
OUTCOMES = {
    "ok": "all frames are there, and finite",
    "not_installed": "its environment is not there",
    "refused": "the scene holds something that the engine has no words for",
    "crashed": "the adapter ended with an error",
    "timed_out": "it ran longer than it was given",
    "not_finite": "a state holds numbers that are none",
    "no_frames": "the adapter ended well and left no frames, or too few",
}


def last_line(log: Path) -> str:
    lines = input_file.read_text(log).strip().splitlines() if log.exists() else []
    return lines[-1][:300] if lines else ""


def positions(folder: Path) -> np.ndarray:
    """What an adapter left: [frames, n, 3] m. Errors: UserError, and ValueError for no NPZ file."""
    with input_file.opened(folder / "frames.npz", input_file.TRAJECTORY) as raw, np.load(raw) as arrays:
        return arrays["positions"].astype(float)


def _frames(out: Path, scene: dict) -> tuple[str, str]:
    """Outcome and detail of what an adapter left."""
    path = out / "frames.npz"
    if not path.is_file() or not (out / "engine.json").is_file():
        return "no_frames", f"{out} lacks frames.npz or engine.json"
    x = positions(out)
    if not np.isfinite(x).all():
        bad = int(np.flatnonzero(~np.isfinite(x).all(axis=(1, 2)))[0])
        return "not_finite", f"frame {bad} of {scene['steps']}"
    wanted = (scene["steps"] + 1, len(scene["positions_m"]), 3)
    if x.shape != wanted:
        return "no_frames", f"frames of the shape {x.shape}; {wanted} is needed"
    return "ok", ""


def _ended(card: Card, jobs: dict[Path, dict], out: Path, variant: str, sets: dict, limit_s) -> dict:
    """Starts the adapter with the scenes of all jobs, folder -> scene, and waits: outcome and detail, `ok`
    where it ended well; what it said is in out/log.txt.
    """
    log = out / "log.txt"
    if why := environment.why_not(card):
        write_whole(log, f"{why}\n")
        return {"outcome": "not_installed", "detail": why}
    words = ["--variant", variant, *(f"--set={name}={_word(value)}" for name, value in sets.items())]
    for folder, scene in jobs.items():
        folder.mkdir(parents=True, exist_ok=True)
        for stale in (folder / "frames.npz", folder / "engine.json"):
            stale.unlink(missing_ok=True)
        write_whole(folder / "scene.json", json.dumps(scene))
        words += ["--scene", str((folder / "scene.json").resolve()), "--out", str(folder.resolve())]
    command = [str(environment.python(card)), str(card.adapter), *words]
    try:
        with log.open("w") as said:  # in its own folder: engines leave files where they are started
            done = subprocess.run(
                command, cwd=out, stdout=said, stderr=subprocess.STDOUT, timeout=limit_s, check=False
            )
    except subprocess.TimeoutExpired:
        return {"outcome": "timed_out", "detail": f"after {limit_s:g} s"}
    if done.returncode == REFUSED:
        return {"outcome": "refused", "detail": last_line(log)}
    if done.returncode != 0:
        return {"outcome": "crashed", "detail": f"exit code {done.returncode}: {last_line(log)}"}
    return {"outcome": "ok", "detail": ""}


def run(
    card: Card, scene: dict, out: Path, variant: str, sets: dict | None = None, limit_s: float | None = None
) -> dict:
    """outcome, detail, log, and where there is one the `run` that the adapter describes. Errors: none of the
    engine; OSError where nothing can be written.
    """
    out.mkdir(parents=True, exist_ok=True)
    answer = {
        "engine": card.name,
        "variant": variant,
        "log": str(out / "log.txt"),
        "out": str(out),
        "run": None,
    }
    ended = _ended(card, {out: scene}, out, variant, sets or {}, limit_s)
    if ended["outcome"] != "ok":
        return answer | ended
    outcome, detail = _frames(out, scene)
    if (out / "engine.json").is_file():
        answer["run"] = json.loads(input_file.read_text(out / "engine.json"))
    return answer | {"outcome": outcome, "detail": detail}


def run_all(
    card: Card, scenes: dict[str, dict], out: Path, variant: str, sets: dict, limit_s: float | None = None
) -> dict[str, np.ndarray]:
    """Frames of several scenes under the same settings, by one process, in out/NAME. Errors: UserError with
    the first that is not ok, and the log.
    """
    out.mkdir(parents=True, exist_ok=True)
    jobs = {out / name: scene for name, scene in scenes.items()}
    ended = _ended(card, jobs, out, variant, sets, limit_s)
    states = {}
    for folder, scene in jobs.items():
        outcome, detail = _frames(folder, scene) if ended["outcome"] == "ok" else ended.values()
        if outcome != "ok":
            raise UserError(f"{folder.name}: {outcome}: {detail} (log: {out / 'log.txt'})")
        states[folder.name] = positions(folder).astype(float)
    return states


def _word(value) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
