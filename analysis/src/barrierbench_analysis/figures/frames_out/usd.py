"""Frames as USD: `bench data frames --format usd`."""

from pathlib import Path

import numpy as np

from barrierbench_analysis.figures.surfaces.sequence import Sequence
from barrierbench_analysis.io.errors import TRY_AGAIN, UserError
from barrierbench_analysis.program.film_files.joins import VERTEX
from barrierbench_analysis.program.film_files.usd import pxr

from .objects import CURVES, SURFACE, Part, parts_of

FOR = "--format usd"
ROOT = "/World"


def _names(parts: list[Part], valid) -> list[str]:
    """Of prims: those of the bodies, with other characters than letters and digits replaced, each once."""
    names: list[str] = []
    for part in parts:
        name = one = valid(part.name)
        more = 1
        while one in names:
            more += 1
            one = f"{name}_{more}"
        names.append(one)
    return names


def _prim(stage, path: str, part: Part):
    """With its cells and the numbers of its vertices, and without points yet."""
    geometry, vt, types = pxr(FOR), pxr(FOR, "Vt"), pxr(FOR, "Sdf").ValueTypeNames
    made = _cells(stage, path, part)
    numbers = geometry.PrimvarsAPI(made).CreatePrimvar(VERTEX, types.IntArray, geometry.Tokens.vertex)
    numbers.Set(vt.IntArray.FromNumpy(part.numbers.astype(np.int32)))
    return made


def _cells(stage, path: str, part: Part):
    geometry, vt = pxr(FOR), pxr(FOR, "Vt")

    def integers(values: np.ndarray):
        return vt.IntArray.FromNumpy(values.astype(np.int32))

    if part.kind == SURFACE:
        mesh = geometry.Mesh.Define(stage, path)
        mesh.CreateSubdivisionSchemeAttr("none")
        mesh.CreateFaceVertexCountsAttr(integers(np.full(len(part.triangles), 3)))
        mesh.CreateFaceVertexIndicesAttr(integers(part.triangles.ravel()))
        return mesh
    if part.kind == CURVES:
        curves = geometry.BasisCurves.Define(stage, path)
        curves.CreateTypeAttr("linear")
        curves.CreateCurveVertexCountsAttr(integers(part.counts))
        return curves
    return geometry.Points.Define(stage, path)


def _stage(sequence: Sequence, path: Path):
    """An empty one: m, z up, time codes that are seconds."""
    geometry, usd = pxr(FOR), pxr(FOR, "Usd")
    stage = usd.Stage.CreateNew(str(path))
    geometry.SetStageMetersPerUnit(stage, 1.0)
    geometry.SetStageUpAxis(stage, "Z")
    stage.SetTimeCodesPerSecond(1.0)
    if sequence.moves:
        first, last = sequence.times_s[0], sequence.times_s[-1]
        stage.SetStartTimeCode(first)
        stage.SetEndTimeCode(last)
        if last > first:
            stage.SetFramesPerSecond((len(sequence.times_s) - 1) / (last - first))
    stage.SetDefaultPrim(geometry.Xform.Define(stage, ROOT).GetPrim())
    return stage


def write_usd(sequence: Sequence, folder: Path) -> None:
    """STEM.usd (binary): a prim a body below /World, points as float32 at every time. Errors: UserError where
    the package is not installed, and where the library cannot write.
    """
    geometry, usd, vt = pxr(FOR), pxr(FOR, "Usd"), pxr(FOR, "Vt")
    valid, path = pxr(FOR, "Tf").MakeValidIdentifier, folder / f"{sequence.stem}.usd"
    try:
        stage, parts = _stage(sequence, path), parts_of(sequence.mesh)
        prims = [_prim(stage, f"{ROOT}/{n}", part) for n, part in zip(_names(parts, valid), parts)]
        codes = (
            [usd.TimeCode(time) for time in sequence.times_s] if sequence.moves else [usd.TimeCode.Default()]
        )
        for code, state in zip(codes, sequence.states()):
            for prim, part in zip(prims, parts):
                points = vt.Vec3fArray.FromNumpy(state.points[part.numbers].astype(np.float32))
                prim.GetPointsAttr().Set(points, code)
                prim.GetExtentAttr().Set(geometry.PointBased.ComputeExtent(points), code)
        stage.Save()
    except pxr(FOR, "Tf").ErrorException as error:
        why = " ".join(str(error).split())
        raise UserError(f"{path.name}: USD cannot write it: {why}", TRY_AGAIN) from None
