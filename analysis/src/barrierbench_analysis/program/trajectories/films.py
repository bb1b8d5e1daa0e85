"""Trajectories of films in one file: USD, Alembic, VTKHDF (film_files). Each body of the file is a body."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from barrierbench_analysis.program.film_files.film import Step
from barrierbench_analysis.program.film_files.formats import opened_film
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
    named = all(film.bodies) and has_cells(found.topology)  # points alone are of whatever --topology says
    names = tuple(film.bodies) if named else ()
    first = tuple(np.cumsum([0, *counts[:-1]]).tolist()) if names else ()
    topology = replace(found.topology, names=names, first_vertex=first)
    return replace(found, topology=topology, labels=film.labels, axes=film.axes, notes=film.notes)
