"""The verb render: a still of a run or of the start of a config, or all frames of a run in motion:
./bench draw still RUN [--step N] [--color gap|stretch|load|body].
"""

import argparse
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, tells
from barrierbench_analysis.program.arguments import (
    bicubic_argument,
    color_argument,
    finite_number,
    parser_of,
    set_argument,
)

from .animation import animate
from .coloring import COLORINGS
from .frame_pixels import RENDERERS, Look
from .picture_file import MEANS
from .preview import preview
from .still_picture import render

MOST_TIMES = 4  # 4^4 = 256 triangles for one


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = parser_of(
        "draw still",
        "A config in the place of RUN: its start is drawn, nothing is run.",
        "./bench draw still results/runs/drape --color gap --out drape.gif",
        "./bench draw still configs/scenes/sheets_on_ball.json --out start.png",
    )
    parser.add_argument("run", type=Path, metavar="RUN", help="folder of run.json; or a config")
    parser.add_argument("--step", type=int, help="a step with a frame, -1: the start (default: the last)")
    color_argument(parser, ["body", *COLORINGS], "body", "what colors mean")
    parser.add_argument(
        "--out",
        type=Path,
        help=f"{MEANS}; FILE.gif or FILE.mp4: all frames in motion (default: RUN/step_NNNNNN_COLOR.png;"
        " NAME_start.png of a config NAME.json)",
    )
    parser.add_argument(
        "--fps",
        type=finite_number,
        metavar="N",
        help="frames a second of a GIF or MP4 (default: for 5 s)",
    )
    set_argument(parser, "override of a config")
    look_arguments(parser)
    given = parser.parse_args(arguments)
    if min(given.size) < 16 or max(given.size) > 8000:
        raise UserError("--size: from 16 to 8000 pixels")
    return given


def look_arguments(parser: argparse.ArgumentParser) -> None:
    """How a picture is drawn, beside its colours."""
    numbers = {"nargs": 2, "type": finite_number, "default": (-60.0, 22.0)}
    words = "direction to the camera, degrees (default: -60 22)"
    parser.add_argument("--view", **numbers, metavar=("AZIMUTH", "ELEVATION"), help=words)
    pixels = {"nargs": 2, "type": int, "default": (1000, 720)}
    words = "pixels (default: 1000 720)"
    parser.add_argument("--size", **pixels, metavar=("WIDTH", "HEIGHT"), help=words)
    parser.add_argument(
        "--subdivide",
        type=int,
        choices=range(1, MOST_TIMES + 1),
        default=0,
        metavar="N",
        help=f"cut every triangle into 4, N times (1 to {MOST_TIMES}), for a surface that is curved between"
        " its vertices and smooth at rods; gaps are judged without",
    )
    bicubic_argument(parser)
    parser.add_argument(
        "--renderer",
        choices=RENDERERS,
        default=RENDERERS[0],
        help="own (default): soft shadows, obstacles without facets; vtk: drawn by VTK, which"
        " analysis/requirements-render.txt installs",
    )
    parser.add_argument("--bare", action="store_true", help="the picture alone, without title and legend")
    parser.add_argument(
        "--hide", nargs="+", default=(), metavar="BODY", help="bodies that are not drawn, such as a container"
    )


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


@tells("draw still")
def main(arguments: list[str]) -> int:
    print(written(parse(arguments)))
    return 0
