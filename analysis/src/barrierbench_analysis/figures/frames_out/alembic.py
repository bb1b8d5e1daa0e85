"""Frames as Alembic: `bench data frames --format abc`."""

from pathlib import Path

import numpy as np

from barrierbench_analysis.figures.surfaces.sequence import Sequence
from barrierbench_analysis.io.errors import TRY_AGAIN, UserError
from barrierbench_analysis.program.film_files.alembic import CUSTOM, alembic3d
from barrierbench_analysis.program.film_files.film import package
from barrierbench_analysis.program.film_files.joins import VERTEX

from .objects import CURVES, SURFACE, Part, parts_of

FOR = "--format abc"
ABOUT = "m, y up"  # beside the data, which name neither


def _imath():
    return package(FOR, "imath", "alembic3d (BSD-3-Clause)", "alembic")


def _filled(array, values: np.ndarray):
    np.asarray(memoryview(array))[:] = values
    return array


def _integers(values: np.ndarray):
    return _filled(_imath().IntArray(len(values)), values)


def _object(geometry, above, sampling, name: str, part: Part):
    """Without points yet, and with the numbers of its vertices."""
    kind = {SURFACE: geometry.OPolyMesh, CURVES: geometry.OCurves}.get(part.kind, geometry.OPoints)
    made = kind(above, name, sampling)
    scope, held = geometry.GeometryScope.kVertexScope, made.getSchema().getArbGeomParams()
    numbers = geometry.OInt32GeomParam(held, VERTEX, False, scope, 1)
    numbers.set(geometry.OInt32GeomParamSample(_integers(part.numbers), scope))
    return made


def _sample(geometry, part: Part, points):
    """Faces turn clockwise seen from outside, as Alembic has them."""
    if part.kind == SURFACE:
        corners = part.triangles[:, [0, 2, 1]].ravel()
        sizes = np.full(len(part.triangles), 3)
        return geometry.OPolyMeshSchemaSample(points, _integers(corners), _integers(sizes))
    if part.kind == CURVES:
        linear = geometry.CurveType.kLinear
        return geometry.OCurvesSchemaSample(points, _integers(part.counts), linear)
    return geometry.OPointsSchemaSample(points, _integers(np.arange(len(part.numbers))))


def _names(parts: list[Part]) -> list[str]:
    """Each once; a / would be a path."""
    names: list[str] = []
    for part in parts:
        name = part.name.replace("/", "_")
        names.append(name if name not in names else f"{name}_{len(names)}")
    return names


def _sampling(sequence: Sequence):
    """The times themselves, where it moves."""
    core = alembic3d(FOR, "AbcCoreAbstract")
    if not sequence.moves:
        return core.TimeSampling()
    times = core.TimeVector()
    times[:] = sequence.times_s
    return core.TimeSampling(core.TimeSamplingType(core.AcyclicFlag.kAcyclic), times)


def write_alembic(sequence: Sequence, folder: Path) -> None:
    """STEM.abc (Ogawa): an object a body, positions as float32 at every time, y up. Errors: UserError where
    the package is not installed, and where the library cannot write.
    """
    abc, geometry, path = alembic3d(FOR, "Abc"), alembic3d(FOR), folder / f"{sequence.stem}.abc"
    parts = parts_of(sequence.mesh)
    try:
        archive = abc.CreateArchiveWithInfo(str(path), "barrierbench", ABOUT)
        sampling = abc.Argument(archive.addTimeSampling(_sampling(sequence)))
        objects = [
            _object(geometry, archive.getTop(), sampling, name, part)
            for name, part in zip(_names(parts), parts)
        ]
        for state in sequence.states():
            x = CUSTOM.of_metres(state.points).astype(np.float32)
            for one, part in zip(objects, parts):
                points = _filled(_imath().V3fArray(len(part.numbers)), x[part.numbers])
                one.getSchema().set(_sample(geometry, part, points))
    except RuntimeError as error:
        why = " ".join(str(error).split())
        raise UserError(f"{path.name}: Alembic cannot write it: {why}", TRY_AGAIN) from None
