"""The start of a config as a still, without a run: ./bench draw still CONFIG."""

import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path

from barrierbench_analysis.figures.captions import caption
from barrierbench_analysis.io.errors import UserError, passed_on
from barrierbench_analysis.io.frames import read_frame, scene_at, without_bodies
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.whole_file import write_whole, write_whole_bytes
from barrierbench_analysis.program.start import started

from .coloring import annotate
from .frame_pixels import Look, drawn
from .picture_file import picture_file
from .still_picture import png, shown


def _start(config: Path, overrides: list[str], scratch: Path) -> subprocess.CompletedProcess:
    """The program's check of a config, with its start below `scratch`. Errors: UserError without one."""
    words = [word for one in overrides for word in ("--set", one)]
    done = started("check", str(config), *words, "--start-frame", str(scratch))
    if not (scratch / "frames" / "start.ply").is_file():
        said = done.stderr.strip() or f"{config}: the program ended with {done.returncode}"
        raise UserError(said, passed_on(done.returncode))
    return done


def preview(config: Path, out: Path | None, look: Look, overrides: list[str]) -> Path:
    """Writes a PNG and its caption; returns the PNG. A start in which something crosses is drawn, and that is
    said. Errors: UserError.
    """
    if look.color != "body" or look.subdivide or look.bicubic:
        raise UserError(
            "--color, --subdivide, --bicubic: are of runs; a config is drawn with --color body, as it is"
        )
    path = picture_file(out or Path(), f"{config.stem}_start.png")
    with tempfile.TemporaryDirectory() as scratch:
        done = _start(config, overrides, Path(scratch))
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
