"""Frames through the verb `audit` of the program: its answers, one a frame, and the total."""

import json
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError, passed_on
from barrierbench_analysis.program.start import piped
from barrierbench_analysis.program.trajectories.trajectory import MOST_METRES, Trajectory, surface_of

from .about import About
from .materials import CONFIG, written

CROSSED, CLEAN = 1, 0  # exit codes of the program that are answers
REACH_SHARE = 0.1  # of the mean edge of the first frame: gaps above it are not measured


def _reach_of(first: np.ndarray, sides: np.ndarray) -> float:
    """0 without edges, and where their ends are not finite."""
    if not len(sides) or not np.isfinite(first[sides]).all():
        return 0.0
    with np.errstate(over="ignore"):
        length = np.linalg.norm(first[sides[:, 1]] - first[sides[:, 0]], axis=1)
        return min(float(length.mean()) * REACH_SHARE, MOST_METRES)


def subject_of(trajectory: Trajectory, about: About, first: np.ndarray, reach_m: float | None) -> dict:
    """barrierbench.subject/1."""
    t = trajectory.topology
    n, moving = t.n_vertices, list(about.paths_m)  # an obstacle that moves has a vertex behind all others
    triangles = surface_of(t)
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]], t.segments])
    subject = {
        "schema": "barrierbench.subject/1",
        "n_vertices": n + len(moving),
        "reach_m": _reach_of(first, sides) if reach_m is None else reach_m,
        "planar": trajectory.planar,
        "bodies": [{"name": name, "first_vertex": first} for name, first in zip(t.names, t.first_vertex)],
        "triangles": triangles.tolist(),
        "segments": t.segments.tolist(),
        "given": about.given.tolist(),
        "obstacles": [
            {key: value for key, value in obstacle.items() if key != "points_m"}
            | ({"vertex": n + moving.index(k)} if k in moving else {})
            for k, obstacle in enumerate(trajectory.obstacles)
        ],
    }
    if about.half_thickness_m is not None:
        subject["half_thickness_m"] = about.half_thickness_m.tolist() + [0.0] * len(moving)
    return subject


def audited(
    trajectory: Trajectory, about: About, subject: dict, each: Callable[[int, np.ndarray], None]
) -> tuple[list[dict], dict, float]:
    """Answers of all frames, the total, and seconds that reading took. each: called with every frame as it is
    handed on. Errors: UserError of the trajectory, or with what the program says.
    """
    with tempfile.TemporaryDirectory(prefix="barrierbench-judge-") as folder:
        path = Path(folder) / "subject.json"
        if elastic := written(trajectory, about, Path(folder)):
            subject = subject | {"elastic": elastic}
        path.write_text(json.dumps(subject, allow_nan=False))
        with piped("audit", str(path)) as child, ThreadPoolExecutor(2) as pool:
            answers, errors = (pool.submit(stream.read) for stream in (child.stdout, child.stderr))
            try:
                reading = _hand_on(trajectory.frames(), about.paths_m, child, each)
            except BaseException:
                child.kill()
                raise
    if child.returncode not in (CLEAN, CROSSED):
        why = errors.result().decode().strip()
        why = why.replace(str(path), f"what was handed on of {trajectory.source}")
        why = why.replace(str(Path(folder) / CONFIG), "the materials of --about as a config")
        raise UserError(
            f"the program's audit ended with {child.returncode}: {why}", passed_on(child.returncode)
        )
    lines = [json.loads(line) for line in answers.result().splitlines()]
    return lines[:-1], lines[-1]["total"], reading


def _hand_on(
    frames: Iterator[np.ndarray], paths_m: dict[int, np.ndarray], child: subprocess.Popen, each: Callable
) -> float:
    """Seconds that reading took. A program that no longer reads has written why; its exit code shows it."""
    reading, number = 0.0, 0
    start = time.perf_counter()
    with suppress(BrokenPipeError), child.stdin:
        for x in frames:
            reading += time.perf_counter() - start
            whole = np.concatenate([x, *(path[number : number + 1] for path in paths_m.values())])
            child.stdin.write(np.ascontiguousarray(whole, "<f8").data)
            each(number, x)
            number += 1
            start = time.perf_counter()
    return reading
