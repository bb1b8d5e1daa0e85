"""The verb render: a still of a run or of the start of a config, or all frames of a run in motion:
./bench draw still RUN [--step N] [--color gap|stretch|load|body].
"""

import argparse
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path

from barrierbench_analysis.figures.captions import caption
from barrierbench_analysis.io.errors import UserError, passed_on, reported
from barrierbench_analysis.io.frames import read_frame, scene_at, without_bodies
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.whole_file import write_whole, write_whole_bytes
from barrierbench_analysis.program.arguments import (
    bicubic_argument,
    color_argument,
    finite_number,
    options,
    parser_of,
    set_argument,
)
from barrierbench_analysis.program.start import started

from .animation import animate
from .coloring import COLORINGS, OF_A_START, annotate
from .frame_pixels import RENDERERS, Look, drawn
from .still_picture import MEANS, picture_file, png, render, shown

MOST_TIMES = 4  # 4^4 = 256 triangles for one


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = parser_of(
        "draw still",
        "A config in the place of RUN: its start is drawn, nothing is run.",
        "./bench draw still results/runs/drape --color gap --out drape.gif",
        "./bench draw still configs/scenes/sheets_on_ball.json --out start.png",
        "./bench draw still scene.json --color crossing --out start.png",
    )
    options(parser, "run RUN: folder of run.json; or a config", run=Path)
    color_argument(parser, ["body", *COLORINGS], "body", "what colors mean")
    text = f"""
--step: a step with a frame, -1: the start (default: the last)
--out: {MEANS}; FILE.gif or FILE.mp4: all frames in motion (default: RUN/step_NNNNNN_COLOR.png;
    NAME_start.png of a config NAME.json)
--fps N: frames a second of a GIF or MP4 (default: for 5 s)"""
    options(parser, text, step=int, out=Path, fps=finite_number)
    set_argument(parser, "override of a config")
    look_arguments(parser)
    given = parser.parse_args(arguments)
    if min(given.size) < 16 or max(given.size) > 8000:
        raise UserError("--size: from 16 to 8000 pixels")
    return given


def look_arguments(parser: argparse.ArgumentParser) -> None:
    """How a picture is drawn, beside its colours."""
    text = f"""
--view AZIMUTH ELEVATION: direction to the camera, degrees (default: -60 22)
--size WIDTH HEIGHT: pixels (default: 1000 720)
--subdivide N: cut every triangle into 4, N times (1 to {MOST_TIMES}), for a surface that is curved between
    its vertices and smooth at rods; gaps are judged without
--renderer: own (default): soft shadows, obstacles without facets; vtk: drawn by VTK, which
    analysis/requirements-render.txt installs
--bare: the picture alone, without title and legend
--hide BODY: bodies that are not drawn, such as a container"""
    options(
        parser,
        text,
        view={"nargs": 2, "type": finite_number, "default": (-60.0, 22.0)},
        size={"nargs": 2, "type": int, "default": (1000, 720)},
        subdivide={"type": int, "choices": range(1, MOST_TIMES + 1), "default": 0},
        renderer={"choices": RENDERERS, "default": RENDERERS[0]},
        hide={"nargs": "+", "default": ()},
    )
    bicubic_argument(parser)


def _is_film(out: Path | None) -> bool:
    return out is not None and out.suffix.lower() in (".gif", ".mp4")


def written(given: argparse.Namespace) -> Path:
    """What was asked for. Errors: UserError, RecordError."""
    view, size, hidden, bicubic = (
        v and tuple(v) for v in (given.view, given.size, given.hide, given.bicubic)
    )
    look = Look(given.color, view, size, given.subdivide, given.bare, hidden, bicubic, given.renderer)
    if look.bicubic and look.subdivide:
        raise UserError("--bicubic: found beside --subdivide; allowed: one of the two")
    is_config = given.run.is_file() and given.run.name != "run.json"
    if given.fps is not None and not (_is_film(given.out) and 0 < given.fps <= 240):
        raise UserError(
            f"--fps: found {given.fps:g}; allowed: above 0, at most 240, for a GIF or MP4 (--out)"
        )
    if given.step is not None and (is_config or _is_film(given.out)):
        raise UserError("--step: is of one still of a run, not of a config, GIF or MP4")
    if given.overrides and not is_config:
        raise UserError("--set: is of a config; a run is drawn as it was")
    if is_config:
        return preview(given.run, given.out, look, given.overrides)
    if _is_film(given.out):
        return animate(given.run, given.out, look, given.fps)
    return render(given.run, given.step, given.out, look)


@reported("draw still")
def main(arguments: list[str]) -> int:
    print(written(parse(arguments)))
    return 0


# --- preview


def _start(config: Path, overrides: list[str], color: str, scratch: Path) -> subprocess.CompletedProcess:
    """The program's check of a config, with its start below `scratch`, in which what crosses is marked where
    the colours mean that. Errors: UserError without one.
    """
    words = [word for one in overrides for word in ("--set", one)]
    if color == "crossing":
        words += ["--export", str(scratch / "frames" / "start.ply")]
    done = started("check", str(config), *words, "--start-frame", str(scratch))
    if not (scratch / "frames" / "start.ply").is_file():
        said = done.stderr.strip() or f"{config}: the program ended with {done.returncode}"
        raise UserError(said, passed_on(done.returncode))
    return done


def preview(config: Path, out: Path | None, look: Look, overrides: list[str]) -> Path:
    """Writes a PNG and its caption; returns the PNG. A start in which something crosses is drawn, and that is
    said. Errors: UserError.
    """
    if look.color not in OF_A_START or look.subdivide or look.bicubic:
        raise UserError(
            "--color, --subdivide, --bicubic: are of runs; a config is drawn with --color body or crossing,"
            " as it is"
        )
    path = picture_file(out or Path(), f"{config.stem}_start.png")
    with tempfile.TemporaryDirectory() as scratch:
        done = _start(config, overrides, look.color, Path(scratch))
        frame = read_frame(Path(scratch) / "frames" / "start.ply")
        scene = scene_at(read_object(Path(scratch) / "frames" / "scene.json"), frame)
    if done.returncode != 0:
        print(done.stderr.strip(), file=sys.stderr)
    pixels, scale = drawn(without_bodies(frame, scene, look.hidden), scene, look, None)
    title = f"{config.stem}, start"
    legend = partial(annotate, scene=scene, frame=frame, color=look.color, scale=scale)
    write_whole_bytes(path, png(look, pixels, title, legend))
    said = "as the program checks it: " + (done.stdout if done.returncode == 0 else done.stderr).strip()
    write_whole(path.with_suffix(".txt"), caption(f"{title}, {said} {shown(look)}", []))
    return path
