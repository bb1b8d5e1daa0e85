"""What `bench judge` says of a run, and what is measured beside it: error against a reference, energy."""

import contextlib
import io
import json
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.studies.judge import verb

from .scene import about

BALANCE = ("gained_J", "gained_of_every_second_frame_J", "lost_J", "exchanged_J", "why_not")  # of `energy`


def width_of(scene: dict) -> float:
    """The longest side of the box around the start, m: what errors are relative to."""
    return float(np.ptp(np.array(scene["positions_m"]), axis=0).max())


def error_of(x: np.ndarray, reference: np.ndarray, scene: dict) -> dict:
    """Distances of vertices that move freely from the reference, root mean square over vertices, in widths of
    the scene: of the last frame, and over all frames.
    """
    free = np.setdiff1d(np.arange(x.shape[1]), scene["given"]["vertices"])
    apart = np.linalg.norm(x[:, free] - reference[:, free], axis=2)
    of_frames = np.sqrt((apart**2).mean(axis=1)) / width_of(scene)
    return {"error_last": float(of_frames[-1]), "error_mean": float(np.sqrt((of_frames[1:] ** 2).mean()))}


def energy_of(frames: list[dict]) -> dict:
    """Kinetic energy of the mean velocities between frames and energy of gravity in the middle, J: the most
    that was gained above the start, and what is left at the end. Elastic energy is in neither.
    """
    rows = [f for f in frames if "gravity_J" in f]
    moving = rows[1:]
    numbers = [f["gravity_J"] for f in rows] + [f.get("kinetic_J") for f in moving]
    if len(rows) < 2 or None in numbers:  # absent, or beyond double
        return {}
    gravity = np.array([f["gravity_J"] for f in rows])
    kinetic = np.array([f["kinetic_J"] for f in moving])
    total = kinetic + (gravity[1:] + gravity[:-1]) / 2 - gravity[0]
    return {"energy_most_J": float(total.max()), "energy_last_J": float(total[-1])}


def judge(folder: Path, scene: dict) -> dict:
    """The numbers of the judgement of folder/frames.npz; the whole lies in folder/judgement."""
    file = folder / "about.json"
    write_whole(file, json.dumps(about(scene)) + "\n")
    out = folder / "judgement"
    words = [str(folder / "frames.npz"), "--about", str(file), "--out", str(out)]
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        code = verb.main(words)
    if code not in (verb.CLEAN, verb.NOT_CLEAN):
        return {"verdict": "not_judged"}
    record = read_object(out / "judgement.json")
    frames, total = record["frames"], record["total"]
    beyond = [max(-(f.get("gap_obstacles_m") or 0.0), 0.0) for f in frames]
    deep = [f.get("depth_bodies_m") or f.get("deepest_m") or 0.0 for f in frames]
    return {
        "verdict": record["verdict"],
        "frames_crossing": sum(f["crossings"] > 0 for f in frames),
        "frames_in_obstacles": sum(f["obstacle_violations"] > 0 for f in frames),
        "crossings_most": max(f["crossings"] for f in frames),
        "passages": total["passages"],
        "depth_obstacles_m": max(beyond),
        "depth_bodies_m": max(deep),
        "stretch_most": max((s for f in frames if (s := f.get("stretch_max"))), default=None),
        **energy_of(frames),
        **{key: value for key, value in (record["energy"] or {}).items() if key in BALANCE},
    }
