"""One run of an engine: its adapter in its own environment, until it ends; how it ended, in a word."""

from __future__ import annotations

import json
import subprocess
import time
from pathlib import Path

import numpy as np

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
    lines = log.read_text(errors="replace").strip().splitlines() if log.exists() else []
    return lines[-1][:300] if lines else ""


def _frames(out: Path, scene: dict) -> tuple[str, str]:
    """Outcome and detail of what an adapter left."""
    path = out / "frames.npz"
    if not path.is_file() or not (out / "engine.json").is_file():
        return "no_frames", f"{out} lacks frames.npz or engine.json"
    x = np.load(path)["positions"]
    if not np.isfinite(x).all():
        bad = int(np.flatnonzero(~np.isfinite(x).all(axis=(1, 2)))[0])
        return "not_finite", f"frame {bad} of {scene['steps']}"
    wanted = (scene["steps"] + 1, len(scene["positions_m"]), 3)
    if x.shape != wanted:
        return "no_frames", f"frames of the shape {x.shape}; {wanted} is needed"
    return "ok", ""


def run(
    card: Card, scene: dict, out: Path, variant: str, sets: dict | None = None, limit_s: float | None = None
) -> dict:
    """outcome, detail, log, and where there is one the `run` that the adapter describes. Errors: none of the
    engine; OSError where nothing can be written.
    """
    out.mkdir(parents=True, exist_ok=True)
    log, file = out / "log.txt", out / "scene.json"
    for stale in (out / "frames.npz", out / "engine.json"):
        stale.unlink(missing_ok=True)
    answer = {"engine": card.name, "variant": variant, "log": str(log), "out": str(out), "run": None}
    if why := environment.why_not(card):
        log.write_text(f"{why}\n")
        return answer | {"outcome": "not_installed", "detail": why}
    file.write_text(json.dumps(scene))
    words = [f"--set={name}={_word(value)}" for name, value in (sets or {}).items()]
    command = [str(environment.python(card)), str(card.adapter), "--scene", str(file), "--out", str(out)]
    begun = time.perf_counter()
    try:
        with log.open("w") as said:
            done = subprocess.run(
                [*command, "--variant", variant, *words],
                stdout=said, stderr=subprocess.STDOUT, timeout=limit_s, check=False,
            )  # fmt: skip
    except subprocess.TimeoutExpired:
        return answer | {"outcome": "timed_out", "detail": f"after {limit_s:g} s"}
    answer["whole_s"] = time.perf_counter() - begun
    if done.returncode == REFUSED:
        return answer | {"outcome": "refused", "detail": last_line(log)}
    if done.returncode != 0:
        return answer | {"outcome": "crashed", "detail": f"exit code {done.returncode}: {last_line(log)}"}
    outcome, detail = _frames(out, scene)
    if (out / "engine.json").is_file():
        answer["run"] = json.loads((out / "engine.json").read_text())
    return answer | {"outcome": outcome, "detail": detail}


def _word(value) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
