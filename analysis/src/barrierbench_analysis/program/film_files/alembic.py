"""Alembic (.abc) by the package alembic3d, bindings of the Alembic project's library, which is installed on
demand: polygon meshes, subdivision surfaces, linear curves and points, where they are in the world at each
time.

Positions are float32 in Alembic, and faces turn clockwise seen from outside, as those of RenderMan do. The
format names neither a unit nor an upward axis. y up and metres are taken: Maya's files have y up and those of
3ds Max z up unless its exporter is set to Maya's axes (Autodesk, 3ds Max MAXScript help, Alembic_Export).
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.axes import Axes
from barrierbench_analysis.io.errors import UserError

from .film import (
    POLYGON,
    ROUNDED,
    SEGMENT,
    Cells,
    FilmFile,
    Shape,
    cells,
    chains,
    checked_file,
    mirrored,
    no_cells,
    package,
    reversed_faces,
)
from .joins import VERTEX

CUSTOM = Axes(1.0, "y")
ALLOWED = "PolyMesh, SubD, linear Curves, or Points alone"


def alembic3d(user: str, module: str = "AbcGeom"):
    return package(user, f"alembic3d.{module}", "alembic3d (BSD-3-Clause)", "alembic")


def _numbers(sample, kind: type) -> np.ndarray:
    """A copy of an array of a sample, whose memory goes with the sample."""
    return np.array(memoryview(sample), kind) if len(sample) else np.zeros(0, kind)


# --- cells of a sample, by the type of its object


def _faces(path: Path, name: str, sample, n_points: int) -> Cells:
    sizes, corners = (_numbers(of, np.int64) for of in (sample.getFaceCounts(), sample.getFaceIndices()))
    if sizes.sum() != len(corners) or len(corners) and not 0 <= corners.min() <= corners.max() < n_points:
        raise UserError(
            f"{path}: {name}: {len(corners)} corners, numbered from {corners.min(initial=0)} to"
            f" {corners.max(initial=0)}; {sizes.sum()} numbers below {n_points} are needed"
        )
    return cells(reversed_faces(corners, sizes), sizes, POLYGON)


def _curves(path: Path, name: str, sample, n_points: int) -> Cells:
    geometry = alembic3d(str(path))
    if sample.getType() != geometry.CurveType.kLinear:
        raise UserError(f"{path}: {name}: Curves that are not linear; allowed: linear ones")
    sizes = _numbers(sample.getCurvesNumVertices(), np.int64)
    if sizes.sum() != n_points:
        raise UserError(f"{path}: {name}: curves of {sizes.sum()} points; it has {n_points}")
    pairs = chains(sizes, sample.getWrap() == geometry.CurvePeriodicity.kPeriodic)
    return cells(pairs.ravel(), np.full(len(pairs), 2), SEGMENT)


def _points(path: Path, name: str, sample, n_points: int) -> Cells:
    return no_cells()


KINDS: dict[str, Callable[..., Cells]] = {
    "IPolyMesh": _faces,
    "ISubD": _faces,
    "ICurves": _curves,
    "IPoints": _points,
}
NO_SHAPES = ("IXform", "IFaceSet", "ICamera", "ILight")  # beside objects without a schema


# --- objects of an archive


@dataclass(frozen=True)
class Body:
    name: str
    kind: str  # of KINDS
    schema: object
    places: tuple  # schemas of the transforms above it, the nearest first

    def vertices(self, geometry) -> np.ndarray | None:
        """The numbers that our writer gives to its points."""
        held = self.schema.getArbGeomParams()
        if not held.valid() or held.getPropertyHeader(VERTEX) is None:
            return None
        found = geometry.IInt32GeomParam(held, VERTEX)
        return _numbers(found.getExpandedValue().getVals(), np.int64)

    def moving(self) -> list:
        """Its schemas that have more than one sample."""
        return [schema for schema in (self.schema, *self.places) if schema.getNumSamples() > 1]


def _walk(
    geometry, above, header, places: tuple = (), hidden: bool = False
) -> Iterator[tuple[str, str, object, tuple, bool]]:
    """Name, type, schema and transforms of all objects with a schema, and whether they are hidden. An object
    holds those below it, and hides them with itself.
    """
    meta = header.getMetaData()
    kinds = (*KINDS, "INuPatch", *NO_SHAPES)
    kind = next((kind for kind in kinds if getattr(geometry, kind).matches(meta)), None)
    held = getattr(geometry, kind)(above, header.getName()) if kind else header
    hidden = hidden or _is_hidden(geometry, header)
    if kind == "IXform":
        places = (held.getSchema(), *places)
    elif kind:
        yield header.getFullName(), kind, held.getSchema(), places, hidden
    for child in header.children:
        yield from _walk(geometry, held, child, places, hidden)


def _is_hidden(geometry, one) -> bool:
    """Whether an object is hidden at all times."""
    found = geometry.GetVisibilityProperty(one)
    if not found.valid() or found.getNumSamples() == 0:
        return False
    return found.isConstant() and geometry.GetVisibility(one) == geometry.ObjectVisibility.kVisibilityHidden


def _bodies(path: Path, archive) -> tuple[list[Body], tuple[str, ...]]:
    """Those with a shape, and notes on what is not read. Errors: UserError where there is none."""
    geometry = alembic3d(str(path))
    top = archive.getTop()
    every = [found for child in top.children for found in _walk(geometry, top, child)]
    hidden = [name for name, kind, *_, gone in every if gone and kind not in NO_SHAPES]
    shapes = [
        Body(*found[:4])
        for found in every
        if found[1] in KINDS and found[2].getNumSamples() > 0 and not found[4]
    ]
    solid = [body for body in shapes if body.kind != "IPoints"]
    read = solid or shapes
    if not read:
        have = ", ".join(f"{name} ({kind[1:]})" for name, kind, *_ in every[:5]) or "no object with a shape"
        raise UserError(f"{path}: no mesh (found: {have}); allowed: an archive with {ALLOWED}")
    names = [body.name for body in read]
    passed = (*names, *hidden)
    left = [name for name, kind, *_ in every if name not in passed and kind not in NO_SHAPES]
    notes = [f"not read: {', '.join(left)}"] if left else []
    if hidden:
        notes.append(f"not read: {', '.join(hidden)}: hidden")
    if smooth := [body.name for body in read if body.kind == "ISubD"]:
        notes.append(f"subdivision surfaces are read as their control meshes: {', '.join(smooth)}")
    return read, tuple(notes)


def _times_of(schema) -> list[float]:
    sampling = schema.getTimeSampling()
    return [sampling.getSampleTime(k) for k in range(schema.getNumSamples())]


def _times(path: Path, bodies: list[Body]) -> list[float]:
    """Those of everything that moves. Errors: UserError where two move at other times: what is between two
    samples of one of them the format does not say.
    """
    times: list[float] = []
    first = None
    for body in bodies:
        for schema in body.moving():
            own = _times_of(schema)
            times, first = times or own, first or body
            if own != times:
                lone = sorted(set(own) ^ set(times))[0]
                raise UserError(
                    f"{path}: {body.name}: its samples are at other times than those of {first.name} (one"
                    f" of them at {lone!r} s); allowed: the same times for all that moves"
                )
    return times


class _World:
    """Shapes in the world, of one archive."""

    def __init__(self, path: Path, archive, bodies: list[Body], times: list[float]) -> None:
        self.path, self.archive, self.bodies = path, archive, bodies
        select = alembic3d(str(path), "Abc").ISampleSelector
        self.times = [select(float(time)) for time in times or [0.0]]  # the nearest sample, which is there

    def shape(self, body: int, frame: int) -> Shape:
        one, time = self.bodies[body], self.times[frame]
        sample = one.schema.getValue(time)
        x = _numbers(sample.getPositions(), np.float64).reshape(-1, 3)
        if not len(x):
            raise UserError(f"{self.path}: {one.name}: no points; at least one is needed")
        mirror = False
        for place in one.places:
            if place.getNumSamples() == 0:
                continue
            matrix = np.array(place.getValue(time).getMatrix())
            if not np.array_equal(matrix, np.eye(4)):
                x = x @ matrix[:3, :3] + matrix[3, :3]
                mirror ^= bool(np.linalg.det(matrix[:3, :3]) < 0)
            if not place.getInheritsXforms(time):
                break
        read = KINDS[one.kind](self.path, one.name, sample, len(x))
        return Shape(x, *(mirrored(*read) if mirror else read))


def of_alembic(path: Path) -> FilmFile:
    abc = alembic3d(str(path), "Abc")
    try:
        archive = abc.IArchive(checked_file(path))
    except RuntimeError as error:
        why = " ".join(str(error).split())
        raise UserError(f"{path}: not an Alembic file that can be read: {why}") from None
    bodies, notes = _bodies(path, archive)
    times = _times(path, bodies)
    world = _World(path, archive, bodies, times)
    return FilmFile(
        path,
        [body.name for body in bodies],
        [f"{time!r} s" for time in times] or ["at rest"],
        times or None,
        world.shape,
        CUSTOM,
        (
            ROUNDED,
            "Alembic names no unit and no upward axis: m and y up are taken, or --scale and --up",
            *notes,
        ),
        [body.vertices(alembic3d(str(path))) for body in bodies],
    )
