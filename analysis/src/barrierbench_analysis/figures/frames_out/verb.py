"""Files of the frames of a run for other tools: ./bench data frames RUN OUT --format NAME."""

import argparse
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np

from barrierbench_analysis.figures.surfaces.binding import Binding, Fit, bound_mesh
from barrierbench_analysis.figures.surfaces.sequence import (
    Run,
    bodies,
    finer,
    obstacles,
    on_splines,
    opened,
    simulated,
    triangles_of,
)
from barrierbench_analysis.figures.surfaces.uv_binding import bound_by_uv
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.program.arguments import (
    bicubic_argument,
    number_type,
    options,
    parser_of,
    positive_number,
)
from barrierbench_analysis.program.mesh_arrays import MESHES, read_frame_file

from .formats import WRITERS, write

REACH = 0.05  # of the diagonal of a body's box: how far a vertex may be from its surface
MOST_TIMES = 6  # 4^6 = 4096 triangles for one
ABOUT = """
OUT becomes a folder. obj, ply, vtu: a file a frame, frame_000000.obj, ...; pc2: frame.pc2 and frame.obj, its
first state; npz: frame.npz, arrays of NumPy; usd, abc: frame.usd or frame.abc, bodies and times in one file,
positions in single precision, by packages that are installed on demand (analysis/requirements-usd.txt,
requirements-alembic.txt). vtu and npz have forces as vectors (--set /output/contact_forces=true).
obstacles.obj, ...: the analytic obstacles as triangles. times.csv: number, step and time (s) of every frame.
frames.pvd, of vtu: what ParaView opens. Rods are lines, solids their surface. Lengths are m, z is up; of abc
y is up."""


def _body_with_surface(run: Run, name: str) -> tuple[int, np.ndarray]:
    body = run.body(name)
    chosen = triangles_of(run.start, body)
    if len(chosen) == 0:
        raise UserError(f"--body: {name} has no triangles; allowed: a body with a surface")
    return body, chosen


def _limit(run: Run, chosen: np.ndarray, asked: float | None) -> float:
    x = run.start.vertices[np.unique(run.start.triangles[chosen])]
    return REACH * float(np.linalg.norm(np.ptp(x, axis=0))) if asked is None else asked


def _check_close(file: Path, fit: Fit, limit: float, name: str) -> None:
    far = int(np.argmax(fit.distance_m))
    if fit.distance_m[far] > limit:
        raise UserError(
            f"{file}: vertex {far} is {fit.distance_m[far]:.6g} m from the surface of {name} at the start;"
            f" allowed: {limit:.6g} m (--reach)"
        )


def with_mesh(
    run: Run, file: Path, name: str, smooth: bool, reach: float | None, by_uv: bool
) -> tuple[list[Binding], str]:
    """Bindings of all bodies, that of one from a file, and a sentence on it. Errors: UserError: a file that
    is none, a body that is none, a vertex that is too far away, or whose texture coordinates (by_uv) the body
    has not.
    """
    body, chosen = _body_with_surface(run, name)
    if run.steps[0] != -1:
        raise UserError(f"{run.folder}: no frame of the start, which a mesh is bound to")
    cells = read_frame_file(file, uvs=by_uv)
    if not len(cells.triangles):
        raise UserError(f"{file}: no triangle; at least one is needed")
    if by_uv:
        bound, fit = bound_by_uv(cells, file, run, name, chosen)
        how = f"by texture coordinates; largest way from the place in the file {fit.error_m:.6g} m"
    else:
        bound, fit = bound_mesh(
            cells.points, cells.triangles, run.start.vertices, run.start.triangles, chosen, smooth
        )
        limit = _limit(run, chosen, reach)
        _check_close(file, fit, limit, name)
        how = (
            f"to {name}; largest distance {fit.distance_m.max():.6g} m (allowed: {limit:.6g}), largest error"
            f" at the start {fit.error_m:.3g} m"
        )
    parts = [bound if k == body else simulated(run.start, k) for k, _ in enumerate(run.scene["bodies"])]
    said = f"{len(cells.points)} vertices and {len(cells.triangles)} triangles bound"
    return parts, f"{file}: {said} {f'to {name} ' if by_uv else ''}{how}"


def with_finer(run: Run, times: int, name: str | None, smooth: bool) -> list[Binding]:
    """Bindings of all bodies, those of one or of all with triangles refined. Errors: UserError."""
    only = None if name is None else _body_with_surface(run, name)[0]
    return finer(run.start, len(run.scene["bodies"]), times, only, smooth)


def in_new_folder(out: Path, fill: Callable[[Path], None]) -> None:
    """A folder beside `out`, which `fill` fills and which then takes its place. Errors: UserError where it
    exists; those of fill leave nothing.
    """
    if out.exists() or out.is_symlink():
        raise UserError(f"{out}: there already; allowed: a folder that is not there yet")
    out.parent.mkdir(parents=True, exist_ok=True)
    part = out.with_name(f"{out.name}.tmp.{os.getpid()}")
    try:
        part.mkdir()
        fill(part)
        part.rename(out)
    except OSError as error:
        error.filename = str(error.filename or out).replace(str(part), str(out))
        raise
    finally:
        shutil.rmtree(part, ignore_errors=True)


def export(run: Run, parts: list[Binding], kind: str, out: Path) -> str:
    """Writes the folder `out`, beside it first, then in its place; returns what is in it. Errors: UserError
    where it exists.
    """
    sequences = [s for s in (bodies(run, parts), obstacles(run)) if s is not None]
    in_new_folder(out, lambda folder: write(sequences, kind, folder))
    mesh = sequences[0].mesh
    return (
        f"{out}: {len(run.steps)} frames ({kind}) of {len(mesh.of_points)} points, {len(mesh.triangles)}"
        f" triangles, {len(mesh.edges)} edges of rods"
    )


def parse(argv: list[str]) -> argparse.Namespace:
    parser = parser_of(
        "data frames",
        ABOUT,
        "./bench data frames results/runs/drape out/drape --format obj --subdivide 2 --smooth",
        "./bench data frames results/runs/duck out/duck --format pc2 --render-mesh fine.obj --body duck"
        " --smooth",
    )
    one_of = parser.add_mutually_exclusive_group()
    text = f"""
--render-mesh FILE: a mesh of triangles ({", ".join(MESHES)}) in the place that --body has at the start: it
    follows the surface of the body and is written in its place
--subdivide N: cut every triangle (of --body, or of all) into 4, N times (1 to {MOST_TIMES})"""
    times = number_type(f"a number from 1 to {MOST_TIMES}", lambda n: 1 <= n <= MOST_TIMES, int)
    options(one_of, text, render_mesh=Path, subdivide=times)
    bicubic_argument(one_of)
    text = f"""
run RUN: folder of run.json
out OUT: a folder that is not there yet
--format: what other tool reads it
--bind: with --render-mesh. closest (default): to the closest point of the surface. uv: to the point of the
    surface that has the same texture coordinates; both are OBJ files with vt
--body NAME: the body that is drawn finer
--smooth: normals between those of the vertices instead of those of the triangles; with --subdivide a surface
    that is curved between the vertices, except at edges that are sharp at the start
--reach M: largest distance (m) of a vertex of --render-mesh from the surface (default: {REACH:g} of the
    diagonal of the body's box)"""
    bind = {"choices": ("closest", "uv"), "default": "closest"}
    wanted = {"choices": WRITERS, "required": True}
    options(parser, text, run=Path, out=Path, format=wanted, bind=bind, reach=positive_number)
    return parser.parse_args(argv)


def _check_together(given: argparse.Namespace) -> None:
    if given.render_mesh and not given.body:
        raise UserError("--render-mesh: no --body; allowed: with the name of the body that it follows")
    if given.bind == "uv" and not given.render_mesh:
        raise UserError("--bind uv: nothing to bind; allowed: with --render-mesh")
    if given.bind == "uv" and (given.reach or given.smooth):
        option = "--reach" if given.reach else "--smooth"
        raise UserError(
            f"{option}: vertices lie on the surface that has their coordinates; allowed: without --bind uv"
        )
    if given.reach and not given.render_mesh:
        raise UserError("--reach: nothing to bind; allowed: with --render-mesh")
    if (given.body or given.smooth) and not (given.render_mesh or given.subdivide):
        option = "--body" if given.body else "--smooth"
        raise UserError(f"{option}: nothing is drawn finer; allowed: with --render-mesh or --subdivide")


@reported("data frames")
def main(argv: list[str]) -> int:
    given = parse(argv)
    _check_together(given)
    run, note = opened(given.run), ""
    if given.bicubic:
        run = on_splines(run, tuple(given.bicubic))
    if given.render_mesh:
        parts, note = with_mesh(
            run, given.render_mesh, given.body, given.smooth, given.reach, given.bind == "uv"
        )
    elif given.subdivide:
        parts = with_finer(run, given.subdivide, given.body, given.smooth)
    else:
        parts = [simulated(run.start, body) for body, _ in enumerate(run.scene["bodies"])]
    print("\n".join(line for line in (note, export(run, parts, given.format, given.out)) if line))
    return 0
