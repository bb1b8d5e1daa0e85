"""A film for a config out of whatever holds frames: ./bench data film SOURCE OUT."""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from barrierbench_analysis.figures.surfaces.sequence import Mesh, Sequence, State
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.program.arguments import axes_arguments, options, parser_of, positive_number
from barrierbench_analysis.program.trajectories.readers import read_trajectory
from barrierbench_analysis.program.trajectories.trajectory import Trajectory, has_cells

from .formats import write
from .verb import in_new_folder

ABOUT = """
SOURCE: a folder of OBJ, PLY, STL, MSH or VTK frames, a PVD, PC2, MDD, NPZ, USD, Alembic or VTKHDF file, or a
run that kept frames. OUT becomes a folder of numbered PLY files (frame_000000.ply, ..., every bit) with
times.csv, whose first file is the `film` of a motion or the `rest_film` of a body."""


def times_of(source: Trajectory, frame_s: float | None) -> list[float]:
    """Seconds. Errors: UserError where the source has none and none are given, or where it has some and
    others are given.
    """
    if source.times_s is not None:
        if frame_s is not None:
            raise UserError(f"--frame-s: {source.source} has times of its own; allowed: without --frame-s")
        return source.times_s
    if frame_s is None:
        raise UserError(f"{source.source}: has no times in seconds; allowed: --frame-s, the time of a frame")
    numbers = source.frame_numbers or list(range(len(source.labels)))
    return [frame_s * number for number in numbers]


def vertices_of(source: Trajectory, body: str | None) -> np.ndarray:
    """Numbers of those of a body, of all without a name. Errors: UserError for a name that is none."""
    names = source.topology.names
    if body is None:
        if len(names) > 1:
            raise UserError(f"{source.source}: {len(names)} bodies; allowed: --body {', '.join(names)}")
        return np.arange(source.topology.n_vertices)
    if body not in names:
        raise UserError(f"--body: found {body!r}; allowed: {', '.join(names) or 'nothing: it names none'}")
    return np.flatnonzero(source.topology.body_of_vertices() == names.index(body))


def _cells(cells: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """Those between chosen vertices, numbered among these."""
    kept = cells[np.isin(cells, chosen).all(axis=1)]
    return np.searchsorted(chosen, kept)


def film_of(source: Trajectory, body: str | None, frame_s: float | None) -> Sequence:
    """The sequence that is written. Of solids the points alone: their mesh knows its cells."""
    chosen, topology = vertices_of(source, body), source.topology
    solid = len(topology.tetrahedra) > 0 or not has_cells(topology)
    none = np.zeros((0, 3), np.int64)
    triangles = none if solid else _cells(topology.triangles, chosen)
    edges = none[:, :2] if solid else _cells(topology.segments, chosen)
    mesh = Mesh(
        [body or "film"],
        np.zeros(len(chosen), np.int64),
        np.zeros(len(triangles), np.int64),
        triangles,
        edges,
    )

    def states() -> Iterator[State]:
        for number, points in enumerate(source.frames()):
            if not np.isfinite(points[chosen]).all():
                raise UserError(f"{source.source}: frame {number} holds a coordinate that is not finite")
            yield State(points[chosen], {}, {})

    times = times_of(source, frame_s)
    return Sequence("frame", mesh, True, list(range(len(times))), times, states)


def parse(argv: list[str]) -> argparse.Namespace:
    parser = parser_of(
        "data film",
        ABOUT,
        "./bench data film dance.pc2 out/dance --frame-s 0.041666667",
        "./bench data film results/runs/drape out/cloth --body cloth",
    )
    text = """
source SOURCE: a folder or file with frames, or a run
out OUT: a folder that is not there yet
--body BODY: of a run: the body whose vertices are wanted
--frame-s FRAME_S: time (s) of a frame, where the source has no times"""
    options(parser, text, source=Path, out=Path, frame_s=positive_number)
    axes_arguments(parser, "SOURCE")
    return parser.parse_args(argv)


@reported("data film")
def main(argv: list[str]) -> int:
    arguments = parse(argv)
    source = read_trajectory(arguments.source, unit_m=arguments.scale, up=arguments.up)
    film = film_of(source, arguments.body, arguments.frame_s)
    if len(film.steps) < 2:
        raise UserError(f"{arguments.source}: {len(film.steps)} frame; allowed: two or more")
    in_new_folder(arguments.out, lambda folder: write([film], "ply", folder))
    for note in source.notes:
        print(f"bench data film: {note}", file=sys.stderr)
    print(
        f"{arguments.out}: a film of {len(film.steps)} frames of {len(film.mesh.of_points)} vertices,"
        f" {film.times_s[0]:g} to {film.times_s[-1]:g} s;"
        f' "film": {{"file": "{arguments.out}/frame_000000.ply"}}'
    )
    return 0
