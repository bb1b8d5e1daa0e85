"""A film: the frames of one run as arrays of single precision, in the order of time.

What stays the same over the run (triangles, rods, bodies, obstacles) stands once. Not here: colours
(scales.py), the page (page.py).
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from barrierbench_analysis.figures.surfaces.grid_splines import GridSplines
from barrierbench_analysis.figures.surfaces.rasterizer import sharp_corners
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.frames import (
    Frame,
    check_same_bodies,
    frame_of,
    frame_paths,
    frames_of,
    read_scene,
    times_of,
)
from barrierbench_analysis.io.record_file import read_record

KINDS = ("plane", "sphere", "cylinder")  # obstacles that the page can draw


@dataclass
class Film:
    """One run. f frames, n vertices, m triangles, k edges of rods."""

    run: str
    labels: dict  # of the record: scene, formulation, ...
    outcome: str
    scene: dict  # of frames/scene.json
    steps: list[int]  # [f] -1: the start
    times_s: list[float]  # [f]
    start: Frame  # the first frame: triangles, edges and bodies of all
    positions: np.ndarray  # [f, n, 3] m
    gap_rel: np.ndarray  # [f, n] in units of d_hat; nan where nothing was computed, as at the start
    load_N: np.ndarray  # [f, n]; nan likewise
    stretch: np.ndarray  # [f, m] sigma_max - 1
    left_out: int  # frames of the run that are not in the film


def bytes_of_a_frame(frame: Frame) -> int:
    """What one frame adds to a film: position, gap and load of vertices, stretch of triangles."""
    return 4 * (5 * len(frame.vertices) + len(frame.triangles))


def kept(steps: list[int], every: int) -> list[int]:
    """Every so many frames, and always the first and the last one."""
    return [*steps[:-1:every], steps[-1]]


def _field(values: dict[str, np.ndarray], name: str, count: int) -> np.ndarray:
    found = values.get(name)
    return np.full(count, np.nan, np.float32) if found is None else np.asarray(found, np.float32)


def _checked_scene(record: dict, run: Path) -> dict:
    scene = read_scene(record, run)
    for number, obstacle in enumerate(scene["obstacles"]):
        if obstacle["kind"] not in KINDS:
            raise UserError(
                f"{run}/frames/scene.json#/obstacles/{number}/kind: found {obstacle['kind']!r}; allowed:"
                f" {', '.join(KINDS)}"
            )
    return scene


@dataclass
class Source:
    """A run whose frames are named but not read yet."""

    run: Path
    record: dict
    steps: list[int]
    frame_bytes: int
    splines: GridSplines | None = None  # makes its frames finer


def opened(run: str | Path, bicubic: tuple[int, int] | None = None) -> Source:
    """bicubic: points of bodies that are grids, along columns and rows. Errors: UserError, RecordError: no
    run, no frames, a first frame that cannot be read, a body that is no grid.
    """
    run = Path(run).parent if Path(run).name == "run.json" else Path(run)
    if not (run / "run.json").is_file():
        raise UserError(f"{run}: no run.json in this folder; allowed: the folder of a run")
    record = read_record(run / "run.json")
    steps = list(frame_paths(record, run))
    start, splines = frame_of(record, run, steps[0]), None
    if bicubic:
        splines = GridSplines(record, read_scene(record, run), start, bicubic)
        start = splines.finer(start)
    return Source(run, record, steps, bytes_of_a_frame(start), splines)


def filmed(source: Source, every: int = 1) -> Film:
    """Reads every so many frames. Errors: UserError, RecordError: a frame that is not the record's, is broken
    or has other bodies than the first one.
    """
    run, record = source.run, source.record
    steps, scene = kept(source.steps, every), _checked_scene(record, run)
    paths, frames = frame_paths(record, run), []
    if source.splines:
        scene = source.splines.scene(scene)
    for step, frame in zip(steps, frames_of(record, run, steps)):
        frames.append(source.splines.finer(frame) if source.splines else frame)
        check_same_bodies(frames[-1], frames[0], paths[step])
    n, m = len(frames[0].vertices), len(frames[0].triangles)
    return Film(
        run=str(run),
        labels=record["labels"],
        outcome=record["status"]["outcome"],
        scene=scene,
        steps=steps,
        times_s=times_of(record, steps, run),
        start=frames[0],
        positions=np.stack([frame.vertices.astype(np.float32) for frame in frames]),
        gap_rel=np.stack([_field(frame.of_vertices, "gap_rel", n) for frame in frames]),
        load_N=np.stack([_field(frame.of_vertices, "load_N", n) for frame in frames]),
        stretch=np.stack([_field(frame.of_triangles, "stretch", m) for frame in frames]),
        left_out=len(source.steps) - len(steps),
    )


def shaded_mesh(frame: Frame) -> tuple[np.ndarray, np.ndarray]:
    """Triangles for smooth shading: `source`, the vertex of the body that each drawn vertex follows, and
    [m, 3] indices of drawn vertices. A corner at a sharp edge has a drawn vertex of its own, so that its
    normal is that of its triangle.
    """
    n = len(frame.vertices)
    triangles = np.array(frame.triangles, np.int64).reshape(-1, 3)
    sharp = sharp_corners(frame.vertices, triangles)
    drawn = triangles.copy()
    drawn[sharp] = n + np.arange(int(sharp.sum()))
    return np.concatenate([np.arange(n), triangles[sharp]]), drawn
