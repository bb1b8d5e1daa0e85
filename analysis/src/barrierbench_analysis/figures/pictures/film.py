"""A film: the frames of one run as arrays of single precision, in the order of time.

What stays the same over the run (triangles, rods, bodies, obstacles) stands once. Not here: colours
(scales.py), the page (page.py).
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from barrierbench_analysis.figures.surfaces import sequence
from barrierbench_analysis.figures.surfaces.rasterizer import sharp_corners
from barrierbench_analysis.figures.surfaces.sequence import Run
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.frames import Frame, with_vectors

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
    contact_N: np.ndarray | None  # [f, n, 3] force of contact; nan likewise; None: its frames have none
    friction_N: np.ndarray | None  # [f, n, 3] force of friction
    left_out: int  # frames of the run that are not in the film

    @property
    def force_N(self) -> np.ndarray:
        """[f, n] length of the force of contact on a vertex; of frames without forces `load_N`, the sum of
        loads there.
        """
        return self.load_N if self.contact_N is None else np.linalg.norm(self.contact_N, axis=-1)

    @property
    def arrows_N(self) -> np.ndarray | None:
        """[f, n, 3] the force of contact and friction on every vertex."""
        if self.contact_N is None or self.friction_N is None:
            return self.contact_N
        return self.contact_N + self.friction_N


def kept(steps: list[int], every: int) -> list[int]:
    """Every so many frames, and always the first and the last one."""
    return [*steps[:-1:every], steps[-1]]


def _field(values: dict[str, np.ndarray], name: str, count: int) -> np.ndarray:
    found = values.get(name)
    return np.full(count, np.nan, np.float32) if found is None else np.asarray(found, np.float32)


def _forces(frames: list[Frame], name: str) -> np.ndarray | None:
    """Of contact or friction; None where no frame has any."""
    found = [with_vectors(frame.of_vertices).get(f"{name}_N") for frame in frames]
    if all(values is None for values in found):
        return None
    shape = frames[0].vertices.shape
    return np.stack([np.full(shape, np.nan, "f4") if v is None else np.asarray(v, np.float32) for v in found])


def opened(run: str | Path, bicubic: tuple[int, int] | None = None) -> Run:
    """bicubic: points of bodies that are grids, along columns and rows. Errors: UserError, RecordError: no
    run, no frames, a first frame that cannot be read, a body that is no grid, an obstacle of another kind.
    """
    found = sequence.opened(Path(run))
    for number, obstacle in enumerate(found.scene["obstacles"]):
        if obstacle["kind"] not in KINDS:
            raise UserError(
                f"{found.folder}/frames/scene.json#/obstacles/{number}/kind: found {obstacle['kind']!r};"
                f" allowed: {', '.join(KINDS)}"
            )
    return sequence.on_splines(found, bicubic) if bicubic else found


def filmed(source: Run, every: int = 1) -> Film:
    """Reads every so many frames. Errors: UserError, RecordError: a frame that is not the record's, is broken
    or has other bodies than the first one.
    """
    numbers = kept(list(range(len(source.steps))), every)
    steps, times = ([of[k] for k in numbers] for of in (source.steps, source.times_s))
    frames = list(replace(source, steps=steps, times_s=times).frames())
    n, m = len(source.start.vertices), len(source.start.triangles)
    return Film(
        str(source.folder), source.record["labels"], source.record["status"]["outcome"], source.scene, steps,
        times_s=times, start=frames[0],
        positions=np.stack([frame.vertices.astype(np.float32) for frame in frames]),
        gap_rel=np.stack([_field(frame.of_vertices, "gap_rel", n) for frame in frames]),
        load_N=np.stack([_field(frame.of_vertices, "load_N", n) for frame in frames]),
        stretch=np.stack([_field(frame.of_triangles, "stretch", m) for frame in frames]),
        contact_N=_forces(frames, "contact"),
        friction_N=_forces(frames, "friction"),
        left_out=len(source.steps) - len(steps),
    )  # fmt: skip


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
