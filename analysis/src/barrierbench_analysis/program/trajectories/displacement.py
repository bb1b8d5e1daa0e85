"""Trajectories whose files keep the points at rest and have the motion in a field: --displacement, and by
itself where points rest and a field has a usual name.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.mesh_arrays import MeshArrays

from .sequence import Notes, read_parts
from .trajectory import Trajectory, read_mesh

# As PolyFEM (solution), FEniCS and sfepy (u), MOOSE (disp_x, disp_y, disp_z) and others write it.
USUAL = ("displacement", "displacements", "displacement_field", "disp", "displ", "u", "solution", "depl")
AXES = ("_x", "_y", "_z")
NO_FIELD = "none"  # of --displacement


def parts_of_field(fields: dict[str, int], name: str) -> tuple[str, ...] | None:
    """The names of the field itself, or of its components. None: the file has it not."""
    if fields.get(name, 0) in (2, 3):
        return (name,)
    known = {other.lower(): other for other, components in fields.items() if components == 1}
    found = [known[key] for axis in AXES if (key := f"{name}{axis}".lower()) in known]
    return tuple(found) if len(found) >= 2 else None


def vector_fields(fields: dict[str, int]) -> list[str]:
    """Names that --displacement takes."""
    stems = [
        name[:-2] for name, components in fields.items() if components == 1 and name[-2:].lower() == "_x"
    ]
    return [n for n, components in fields.items() if components in (2, 3)] + [
        stem for stem in stems if parts_of_field(fields, stem)
    ]


def usual_field(fields: dict[str, int]) -> str | None:
    names = vector_fields(fields)
    return next((name for usual in USUAL for name in names if name.lower() == usual), None)


def _moved(part: MeshArrays, names: tuple[str, ...]) -> np.ndarray:
    """[n, 3] the points and the field."""
    if not names:
        return part.points
    field = np.concatenate([part.values[name] for name in names], axis=1)
    out = part.points.copy()
    out[:, : field.shape[1]] += field
    return out


def _rest(trajectory: Trajectory, first: list[MeshArrays]) -> bool:
    """No point of any frame is elsewhere than in the first one."""
    none = [()] * len(first)
    every = read_parts(trajectory.files, first, none, Notes())
    return all(
        np.array_equal(part.points, known.points, equal_nan=True)
        for parts in every
        for part, known in zip(parts, first)
    )


def with_field(trajectory: Trajectory, name: str, first: list[MeshArrays]) -> Trajectory:
    """The points of every part that has the field, and the field."""
    names = [parts_of_field(part.fields, name) or () for part in first]
    notes = Notes()

    def read() -> Iterator[np.ndarray]:
        for parts in read_parts(trajectory.files, first, names, notes):
            yield np.concatenate([_moved(part, wanted) for part, wanted in zip(parts, names)])

    without = [path.name for path, wanted in zip(trajectory.files[0], names) if not wanted]
    note = f"the field {name!r} is added to the points, which rest"
    if without:
        note += f"; {', '.join(without)} has it not and stays where it is"
    return replace(trajectory, frames=read, heard=notes, notes=(*trajectory.notes, note), displacement=name)


def displaced(trajectory: Trajectory, chosen: str | None) -> Trajectory:
    """By the field that is requested, or by a usual one where the points rest. Errors: UserError for a field
    that no file has, and for points that move beside it.
    """
    if trajectory.files is None:
        if chosen not in (None, NO_FIELD):
            raise UserError(
                f"--displacement {chosen}: {trajectory.source} has no fields; allowed: for .vtu, .vtp, .vtk"
            )
        return trajectory
    first = [read_mesh(path) for path in trajectory.files[0]]
    known = {name: width for part in first for name, width in part.fields.items()}
    if chosen == NO_FIELD:
        return trajectory
    if chosen is not None:
        if not any(parts_of_field(part.fields, chosen) for part in first):
            have = ", ".join(vector_fields(known)) or "no field of 2 or 3 components"
            raise UserError(f"--displacement {chosen}: {trajectory.source} has {have}")
        if not _rest(trajectory, first):
            raise UserError(
                f"--displacement {chosen}: the points of {trajectory.source} move by themselves; allowed:"
                " points that rest, or --displacement none"
            )
        return with_field(trajectory, chosen, first)
    if not (usual := usual_field(known)):
        return trajectory
    if len(trajectory.files) == 1:
        note = f"one frame with the field {usual!r}: --displacement {usual} adds it to the points"
        return replace(trajectory, notes=(*trajectory.notes, note))
    return with_field(trajectory, usual, first) if _rest(trajectory, first) else trajectory
