"""USD (.usd, .usda, .usdc, .usdz) by Pixar's package usd-core, which is installed on demand: meshes, linear
curves, tetrahedra and points where the stage has them in the world at each time.

Points are float32 in USD. What a stage leaves out has the value that USD gives it: y up and centimetres
(UsdGeom: upAxis, metersPerUnit).
"""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.axes import Axes
from barrierbench_analysis.io.errors import UserError

from .film import (
    POLYGON,
    ROUNDED,
    SEGMENT,
    TETRAHEDRON,
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

ALLOWED = "Mesh, TetMesh, linear BasisCurves, or Points alone"
MOST_NAMES = 5  # of prims in a note
# Attributes by which a prim changes in time, beside its place.
MOVING = ("points", "faceVertexCounts", "faceVertexIndices", "curveVertexCounts", "tetVertexIndices")


def pxr(user: str, module: str = "UsdGeom"):
    return package(user, f"pxr.{module}", "usd-core (Tomorrow Open Source Technology License 1.0)", "usd")


def _array(attribute, time, kind: type = np.int64) -> np.ndarray:
    found = attribute.Get(time)
    return np.zeros(0, kind) if found is None else np.array(found, kind)


# --- cells of a prim, by its type


def _mesh(path: Path, prim, time, n_points: int) -> Cells:
    mesh = pxr(str(path)).Mesh(prim)
    counts, indices = mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr()
    sizes, corners = _array(counts, time), _array(indices, time)
    if sizes.sum() != len(corners) or len(corners) and not 0 <= corners.min() <= corners.max() < n_points:
        raise UserError(
            f"{path}: {prim.GetPath()}: {len(corners)} corners, numbered from {corners.min(initial=0)} to"
            f" {corners.max(initial=0)}; {sizes.sum()} numbers below {n_points} are needed"
        )
    if mesh.GetOrientationAttr().Get() == "leftHanded":
        corners = reversed_faces(corners, sizes)
    return cells(corners, sizes, POLYGON)


def _curves(path: Path, prim, time, n_points: int) -> Cells:
    curves = pxr(str(path)).BasisCurves(prim)
    if curves.GetTypeAttr().Get(time) != "linear":
        raise UserError(f"{path}: {prim.GetPath()}: cubic BasisCurves; allowed: linear ones")
    sizes = _array(curves.GetCurveVertexCountsAttr(), time)
    if sizes.sum() != n_points:
        raise UserError(f"{path}: {prim.GetPath()}: curves of {sizes.sum()} points; it has {n_points}")
    pairs = chains(sizes, curves.GetWrapAttr().Get(time) == "periodic")
    return cells(pairs.ravel(), np.full(len(pairs), 2), SEGMENT)


def _tetrahedra(path: Path, prim, time, n_points: int) -> Cells:
    corners = _array(pxr(str(path)).TetMesh(prim).GetTetVertexIndicesAttr(), time).reshape(-1, 4)
    return cells(corners.ravel(), np.full(len(corners), 4), TETRAHEDRON)


def _points(path: Path, prim, time, n_points: int) -> Cells:
    return no_cells()


def _vertices(geometry, prim) -> np.ndarray | None:
    """The numbers that our writer gives to its points."""
    found = geometry.PrimvarsAPI(prim).GetPrimvar(VERTEX)
    values = np.array(found.Get()) if found and found.HasValue() else np.zeros(0)
    return values if values.dtype.kind == "i" and values.ndim == 1 else None


KINDS: dict[str, Callable[..., Cells]] = {"Mesh": _mesh, "BasisCurves": _curves, "TetMesh": _tetrahedra}


# --- prims of a stage


def _listed(prims: list) -> str:
    more = f" and {len(prims) - MOST_NAMES} more" if len(prims) > MOST_NAMES else ""
    return ", ".join(str(prim.GetPath()) for prim in prims[:MOST_NAMES]) + more


@dataclass(frozen=True)
class Prims:
    """Those of a stage that have a shape."""

    read: list
    cells: list[Callable[..., Cells]]  # of each that is read
    notes: tuple[str, ...]


def _hidden(path: Path, prim) -> str | None:
    """Why a prim is not drawn. Errors: UserError for one that is drawn elsewhere than its points are."""
    geometry, skeletons = pxr(str(path)), pxr(str(path), "UsdSkel")
    if prim.IsA(geometry.PointInstancer):
        raise UserError(f"{path}: {prim.GetPath()}: a PointInstancer; allowed: {ALLOWED}, each a prim")
    image = geometry.Imageable(prim)
    purpose = image.ComputePurpose()
    if purpose in ("guide", "proxy"):
        return f"of the purpose {purpose}"
    if not image.GetVisibilityAttr().ValueMightBeTimeVarying() and image.ComputeVisibility() == "invisible":
        return "invisible"
    bound = skeletons.BindingAPI(prim)
    if skeletons.Root.Find(prim) and (
        bound.GetJointIndicesPrimvar().HasValue() or bound.GetBlendShapesAttr().HasValue()
    ):
        raise UserError(
            f"{path}: {prim.GetPath()}: its points are moved by a skeleton (UsdSkel); allowed: points with"
            " the motion in them (UsdSkel.BakeSkinning)"
        )
    return None


def _prims(path: Path, stage) -> Prims:
    """Errors: UserError where none has a shape."""
    geometry, usd = pxr(str(path)), pxr(str(path), "Usd")
    found, points, left = [], [], {}
    every = list(stage.Traverse(usd.TraverseInstanceProxies(usd.PrimDefaultPredicate)))
    for prim in every:
        if not prim.IsA(geometry.Gprim) and not prim.IsA(geometry.PointInstancer):
            continue
        kind = next((name for name in KINDS if prim.IsA(getattr(geometry, name))), None)
        if why := _hidden(path, prim):
            left.setdefault(why, []).append(prim)
        elif kind:
            found.append((prim, KINDS[kind]))
        elif prim.IsA(geometry.Points):
            points.append((prim, _points))
        else:
            left.setdefault(f"a {prim.GetTypeName()} (obstacles: --about)", []).append(prim)
    if found and points:
        left["points beside what has cells"] = [prim for prim, _ in points]
    if not found and not points:
        kinds = Counter(str(prim.GetTypeName()) or "no type" for prim in every)
        have = ", ".join(f"{name} {count}" for name, count in sorted(kinds.items())) or "no prim"
        raise UserError(f"{path}: no mesh (found: {have}); allowed: a stage with {ALLOWED}")
    notes = [f"not read: {_listed(prims)}: {why}" for why, prims in left.items()]
    smooth = [prim for prim, kind in found if kind is _mesh and _is_smooth(geometry, prim)]
    if smooth:
        notes.append(f"subdivision surfaces are read as their control meshes: {_listed(smooth)}")
    if holes := [prim for prim, kind in found if kind is _mesh and _has_holes(geometry, prim)]:
        notes.append(f"faces that are holes (holeIndices) are read as all others: {_listed(holes)}")
    prims, kinds = zip(*(found or points))
    return Prims(list(prims), list(kinds), tuple(notes))


def _has_holes(geometry, prim) -> bool:
    holes = geometry.Mesh(prim).GetHoleIndicesAttr()
    return any(len(holes.Get(time) or ()) for time in holes.GetTimeSamples() or [0.0])


def _is_smooth(geometry, prim) -> bool:
    return geometry.Mesh(prim).GetSubdivisionSchemeAttr().Get() != "none"


# --- times


def _codes_of(geometry, prim) -> set[float]:
    """Time codes at which a prim has a sample of its shape or its place."""
    codes = set()
    for name in MOVING:
        if attribute := prim.GetAttribute(name):
            codes |= set(attribute.GetTimeSamples())
    while prim and not prim.IsPseudoRoot():
        if prim.IsA(geometry.Xformable):
            codes |= set(geometry.Xformable(prim).GetTimeSamples())
        prim = prim.GetParent()
    return codes


def _stage(path: Path):
    """Errors: UserError for a file that is none, or that refers to one that is not there."""
    usd, tf = pxr(str(path), "Usd"), pxr(str(path), "Tf")
    try:
        stage = usd.Stage.Open(checked_file(path))
        stage.Reload()  # a file that was read before and has changed since
    except tf.ErrorException as error:
        why = str(error).strip().splitlines()[0].rpartition(" : ")[2]
        raise UserError(f"{path}: not a USD file that can be read: {why}") from None
    if errors := stage.GetCompositionErrors():
        raise UserError(f"{path}: {str(errors[0]).strip()}; a stage with all its files is needed")
    return stage


class _World:
    """Shapes in the world: of one stage, frame after frame. Prims live as long as their stage."""

    def __init__(self, path: Path, stage, prims: Prims, times: list) -> None:
        self.path, self.stage, self.prims, self.times = path, stage, prims, times
        self.frame, self.places = -1, None

    def shape(self, body: int, frame: int) -> Shape:
        geometry, prim, time = pxr(str(self.path)), self.prims.read[body], self.times[frame]
        if frame != self.frame:
            self.frame, self.places = frame, geometry.XformCache(time)
        x = _array(geometry.PointBased(prim).GetPointsAttr(), time, np.float64).reshape(-1, 3)
        if not len(x):
            raise UserError(f"{self.path}: {prim.GetPath()}: no points; at least one is needed")
        place = np.array(self.places.GetLocalToWorldTransform(prim))
        if not np.array_equal(place, np.eye(4)):
            x = x @ place[:3, :3] + place[3, :3]
        read = self.prims.cells[body](self.path, prim, time, len(x))
        return Shape(x, *(mirrored(*read) if np.linalg.det(place[:3, :3]) < 0 else read))


def of_usd(path: Path) -> FilmFile:
    geometry, usd = pxr(str(path)), pxr(str(path), "Usd")
    stage = _stage(path)
    prims = _prims(path, stage)
    each = [_codes_of(geometry, prim) for prim in prims.read]
    codes, rate = sorted(set().union(*each)), stage.GetTimeCodesPerSecond()
    if not (np.isfinite(rate) and rate > 0):
        raise UserError(f"{path}: found {rate} time codes per second; a number above 0 is needed")
    unit = geometry.GetStageMetersPerUnit(stage)
    if not (np.isfinite(unit) and unit > 0):
        raise UserError(f"{path}: found metersPerUnit {unit}; a finite number above 0 is needed")
    times = [code / rate for code in codes]
    notes = [ROUNDED, *prims.notes]
    between = [prim for prim, own in zip(prims.read, each) if own and own != set(codes)]
    if between:
        notes.append(f"at times between samples of their own positions are straight: {_listed(between)}")
    if not geometry.StageHasAuthoredMetersPerUnit(stage):
        notes.append("the stage names no metersPerUnit: that of USD is taken (0.01), or --scale")
    if not stage.HasAuthoredMetadata("upAxis"):
        notes.append("the stage names no upAxis: that of USD is taken (y), or --up")
    world = _World(path, stage, prims, [usd.TimeCode(code) for code in codes] or [usd.TimeCode.Default()])
    return FilmFile(
        path,
        [str(prim.GetPath()) for prim in prims.read],
        [f"{time!r} s" for time in times] or ["at rest"],
        times or None,
        world.shape,
        Axes(unit, geometry.GetStageUpAxis(stage).lower()),
        tuple(notes),
        [_vertices(geometry, prim) for prim in prims.read],
    )
