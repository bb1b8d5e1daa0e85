"""Trajectories of films in one file: USD, Alembic, VTKHDF (film_files). Each body of the file is a body."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from barrierbench_analysis.program.film_files.film import FilmFile, Step
from barrierbench_analysis.program.film_files.formats import opened_film
from barrierbench_analysis.program.film_files.joins import VERTEX
from barrierbench_analysis.program.mesh_arrays import read_frame_file

from .sequence import of_parts
from .trajectory import Trajectory, has_cells, increasing


def of_film(path: Path) -> Trajectory:
    """Errors: UserError of the reader, and for times that do not increase; those of the frames: for a body
    whose topology changes, with its name and the time.
    """
    film = opened_film(path)
    frames = [[Step(film, body, k) for body, _ in enumerate(film.bodies)] for k, _ in enumerate(film.labels)]
    times = film.times_s and increasing(film.times_s, lambda k: f"{path}: time {k}")
    found = of_parts(frames, str(path), path.suffix.lower()[1:], times)
    counts = [len(read_frame_file(step).points) for step in frames[0]]
    found, first = _once(found, film) if film.join else (found, np.cumsum([0, *counts[:-1]]).tolist())
    named = all(film.bodies) and has_cells(found.topology)  # points alone are of whatever --topology says
    own = [(name, k) for name, k in zip(film.bodies, first) if k is not None] if named else []
    names, first_vertex = (tuple(of) for of in zip(*own)) if own else ((), ())
    topology = replace(found.topology, names=names, first_vertex=first_vertex)
    notes = (*film.notes, *found.notes)
    return replace(found, topology=topology, labels=film.labels, axes=film.axes, notes=notes)


def _once(found: Trajectory, film: FilmFile) -> tuple[Trajectory, list[int | None]]:
    """With every vertex once, and the first vertex of each body."""
    join, t = film.join, found.topology
    cells = {name: join.vertex[getattr(t, name)] for name in ("triangles", "segments", "tetrahedra")}
    lost = t.n_vertices - len(join.kept)
    counts = [len(film.at(body, 0).points) for body, _ in enumerate(film.bodies)]
    whole = replace(
        found,
        topology=replace(t, n_vertices=len(join.kept), **cells),
        frames=lambda: (
            join.points(x, f"{film.path} ({label})") for label, x in zip(film.labels, found.frames())
        ),
        notes=(f"{lost} points are joined to others that have the same number ({VERTEX})",),
    )
    return whole, join.first_vertices(counts)
