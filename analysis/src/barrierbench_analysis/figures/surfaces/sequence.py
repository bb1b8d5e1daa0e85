"""What is written of a run: a mesh that stays the same, and its states in the order of time."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.frames import (
    Frame,
    check_same_bodies,
    frame_of,
    frame_paths,
    frames_of,
    points_of_bodies,
    read_scene,
    scene_at,
    times_of,
)
from barrierbench_analysis.io.record_file import read_record

from .binding import Binding, joined, refined, whole
from .grid_splines import GridSplines
from .obstacle_mesh import obstacle_mesh

COUNTED = ("body",)  # fields that are numbers of something: not between their neighbours'


@dataclass(frozen=True)
class Mesh:
    """Elements of all states. `body` is the number of a body in `names`."""

    names: list[str]
    of_points: np.ndarray  # [n] body
    of_triangles: np.ndarray  # [k] body
    triangles: np.ndarray  # [k, 3]
    edges: np.ndarray  # [e, 2] rods


@dataclass(frozen=True)
class State:
    """One frame: points in m and further fields, the same in every state."""

    points: np.ndarray  # [n, 3]
    of_points: dict[str, np.ndarray]  # gap_rel, load_N, ...; nan where the run has none, as at the start
    of_triangles: dict[str, np.ndarray]  # stretch


@dataclass(frozen=True)
class Sequence:
    stem: str  # of its files
    mesh: Mesh
    moves: bool  # otherwise there is one state, for all times
    steps: list[int]  # -1: the start
    times_s: list[float]
    states: Callable[[], Iterator[State]]  # one after the other, read anew by every call


@dataclass(frozen=True)
class Run:
    folder: Path
    record: dict
    scene: dict
    steps: list[int]
    times_s: list[float]
    recorded: Frame  # the first one, as its file has it
    splines: GridSplines | None = None  # what frames are made finer with

    @cached_property
    def start(self) -> Frame:
        return self._drawn(self.recorded)

    @property
    def has_forces(self) -> bool:
        """Whether its frames have the force of contact on every vertex."""
        return bool((self.record.get("config") or {}).get("output", {}).get("contact_forces"))

    @property
    def frame_bytes(self) -> int:
        """Of a frame in single precision: position, gap, load and force of vertices, stretch of triangles."""
        return 4 * ((8 if self.has_forces else 5) * len(self.start.vertices) + len(self.start.triangles))

    def _drawn(self, frame: Frame) -> Frame:
        return self.splines.finer(frame) if self.splines else frame

    def frames(self) -> Iterator[Frame]:
        """Errors: UserError, RecordError: a frame that is not the record's, or has other bodies than the
        first one.
        """
        paths = frame_paths(self.record, self.folder)
        for step, frame in zip(self.steps, frames_of(self.record, self.folder, self.steps)):
            check_same_bodies(frame, self.recorded, paths[step])
            yield self._drawn(frame)

    def body(self, name: str) -> int:
        names = self.scene["bodies"]
        if name not in names:
            raise UserError(f"--body: found {name!r}; allowed: {', '.join(names)}")
        return names.index(name)


def opened(run: Path) -> Run:
    """Errors: UserError, RecordError: no run, no frames, a frame of a step that the record does not have."""
    run = run.parent if run.name == "run.json" else run
    if not (run / "run.json").is_file():
        raise UserError(f"{run}: no run.json in this folder; allowed: the folder of a run")
    record = read_record(run / "run.json")
    steps = list(frame_paths(record, run))
    start = frame_of(record, run, steps[0])
    return Run(run, record, read_scene(record, run), steps, times_of(record, steps, run), start)


def on_splines(run: Run, counts: tuple[int, int]) -> Run:
    """Bodies that are grids with `counts` points along columns and rows. Errors: UserError: a body that is no
    grid, or has more.
    """
    splines = GridSplines(run.record, run.scene, run.recorded, counts)
    return replace(run, scene=splines.scene(run.scene), splines=splines)


def triangles_of(frame: Frame, body: int) -> np.ndarray:
    """Indices of the triangles of a body."""
    return np.flatnonzero(np.asarray(frame.of_triangles["body"]) == body)


def simulated(frame: Frame, body: int) -> Binding:
    """A body as it is: its triangles, and the vertices of those and of its rods (of a solid, those of its
    surface). A body without either has its vertices.
    """
    chosen, of = triangles_of(frame, body), np.asarray(frame.of_vertices["body"])
    rods = frame.edges[of[frame.edges[:, 0]] == body] if len(frame.edges) else frame.edges
    used = np.unique(np.concatenate([frame.triangles[chosen].ravel(), rods.ravel()]).astype(int))
    used = used if len(used) else np.flatnonzero(of == body)
    itself = whole(len(frame.vertices))
    of_points = (of[used] for of in (itself.corners, itself.weights, itself.owner, itself.offset_m))
    return Binding(np.searchsorted(used, frame.triangles[chosen]), chosen, *of_points)


def finer(start: Frame, n_bodies: int, times: int, only: int | None, smooth: bool) -> list[Binding]:
    """Bindings of all bodies, those of one or of all with every triangle cut into 4, `times` times."""
    parts = [simulated(start, body) for body in range(n_bodies)]
    for body, part in enumerate(parts):
        if len(part.source) and only in (None, body):
            parts[body] = refined(start.vertices, start.triangles, part.source, times, smooth)
    return parts


def _edges_of(frame: Frame, bound: Binding) -> np.ndarray:
    """The rods of the frame, of points that are its vertices themselves."""
    number = np.full(len(frame.vertices), -1)
    own = np.flatnonzero(bound.owner < 0)
    number[bound.corners[own, 0]] = own
    return number[frame.edges].reshape(-1, 2)


def _field(values: dict[str, np.ndarray], name: str, count: int) -> np.ndarray:
    return np.asarray(values[name], float) if name in values else np.full(count, np.nan)


def _names_of_fields(run: Run) -> tuple[list[str], list[str]]:
    """Of points and of triangles, as the last frame has them: the first has fewer."""
    last = frame_of(run.record, run.folder, run.steps[-1])
    return tuple([n for n in of if n not in COUNTED] for of in (last.of_vertices, last.of_triangles))


def bodies(run: Run, parts: list[Binding]) -> Sequence:
    """The bodies of a run, each as its binding says."""
    bound, start = joined(parts), run.start
    of_points, of_triangles = _names_of_fields(run)
    mesh = Mesh(
        run.scene["bodies"],
        np.asarray(start.of_vertices["body"])[bound.corners[:, 0]],
        np.asarray(start.of_triangles["body"])[bound.source],
        bound.triangles,
        _edges_of(start, bound),
    )
    n, m = len(start.vertices), len(start.triangles)

    def states() -> Iterator[State]:
        for frame in run.frames():
            yield State(
                bound.points(frame.vertices, start.triangles),
                {name: bound.values(_field(frame.of_vertices, name, n)) for name in of_points},
                {name: _field(frame.of_triangles, name, m)[bound.source] for name in of_triangles},
            )

    return Sequence("frame", mesh, True, run.steps, run.times_s, states)


def finer_frame(start: Frame, frame: Frame, n_bodies: int, times: int) -> Frame:
    """A frame with every triangle cut into 4, `times` times, on a surface that is curved between the
    vertices, smooth where the start is."""
    bound = joined(finer(start, n_bodies, times, None, True))
    of_vertices = {name: bound.values(values) for name, values in frame.of_vertices.items()}
    of_vertices["body"] = np.asarray(frame.of_vertices["body"])[bound.corners[:, 0]]
    of_triangles = {name: np.asarray(v)[bound.source] for name, v in frame.of_triangles.items()}
    points = bound.points(frame.vertices, start.triangles)
    return Frame(points, bound.triangles, _edges_of(start, bound), of_vertices, of_triangles)


def obstacles(run: Run) -> Sequence | None:
    """The analytic obstacles of a run as meshes: one state where none of them moves. None without any."""
    if not run.scene["obstacles"]:
        return None
    moves = any("vertex" in o for o in run.scene["obstacles"])
    x = points_of_bodies(run.scene, run.start.vertices)
    center = (x.min(axis=0) + x.max(axis=0)) / 2
    reach = 1.6 * float(np.linalg.norm(x - center, axis=1).max())

    def parts_at(frame: Frame) -> list[tuple[np.ndarray, np.ndarray]]:
        return [obstacle_mesh(o, center, reach) for o in scene_at(run.scene, frame)["obstacles"]]

    parts = parts_at(run.start)
    starts = np.cumsum([0, *(len(points) for points, _ in parts)])
    mesh = Mesh(
        [o["name"] for o in run.scene["obstacles"]],
        np.repeat(np.arange(len(parts)), [len(points) for points, _ in parts]),
        np.repeat(np.arange(len(parts)), [len(triangles) for _, triangles in parts]),
        np.concatenate([triangles + first for (_, triangles), first in zip(parts, starts)]),
        np.zeros((0, 2), int),
    )

    def states() -> Iterator[State]:
        for frame in run.frames() if moves else [run.start]:
            yield State(np.concatenate([points for points, _ in parts_at(frame)]), {}, {})

    steps, times = (run.steps, run.times_s) if moves else (run.steps[:1], run.times_s[:1])
    return Sequence("obstacles", mesh, moves, steps, times, states)
