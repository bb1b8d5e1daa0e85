"""All frames of a run in one GIF or MP4, each drawn as a still: ./bench draw still RUN --out
FILE.gif|.mp4."""

import errno
import importlib.util
import io
import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from PIL import Image

from barrierbench_analysis.figures.captions import caption
from barrierbench_analysis.io.errors import BAD_INPUT, TRY_AGAIN, UserError
from barrierbench_analysis.io.frames import frame_of, frame_paths, read_scene, scene_at
from barrierbench_analysis.io.record_file import read_record
from barrierbench_analysis.io.whole_file import check_can_be_written, whole, write_whole
from barrierbench_analysis.program import processes
from barrierbench_analysis.program.progress import counted
from barrierbench_analysis.tables.run_rows import run_row

from .coloring import annotate, top_of
from .frame_pixels import Look, Shared, drawn_of_run, focus_of
from .still_picture import annotated, shown, title_of, when

SUFFIXES = (".gif", ".mp4")
SAMPLED = 24  # frames that decide what the camera has to hold
SECONDS = 5.0  # that a film takes where no rate is asked for
SLOWEST, FASTEST = 2, 30  # frames a second of such a film


@dataclass(frozen=True)
class Film:
    """What each frame is drawn with."""

    run: Path
    look: Look
    shared: Shared
    title: str


def _shared(record: dict, run: Path, steps: list[int], look: Look) -> Shared:
    """Camera and colours that hold for every frame."""
    scene = read_scene(record, run)
    sampled = {steps[k] for k in np.linspace(0, len(steps) - 1, min(SAMPLED, len(steps))).astype(int)}
    points, tops = [], []
    for step in steps:
        frame = frame_of(record, run, step)
        tops.append(top_of(frame, look.color))
        if step in sampled:
            points.append(focus_of(frame, scene_at(scene, frame), look))
    return Shared(np.concatenate(points), max((top for top in tops if top is not None), default=None))


def _still(film: Film, record: dict, step: int) -> Image.Image:
    pixels, scale, frame, scene = drawn_of_run(record, film.run, step, film.look, film.shared)
    if film.look.bare:
        return Image.fromarray(np.uint8(np.round(255 * pixels)))
    legend = partial(annotate, scene=scene, frame=frame, color=film.look.color, scale=scale)
    made = annotated(pixels, f"{film.title}, {when(record, step)}", legend)
    return Image.open(io.BytesIO(made)).convert("RGB")


def _stills(film: Film, record: dict, steps: list[int]) -> Iterator[Image.Image]:
    """In the order of the steps, drawn on all cores."""
    with processes.pool(min(len(steps), len(os.sched_getaffinity(0)))) as pool:
        yield from counted(pool.map(partial(_still, film, record), steps), len(steps), "render: frame")


def _write_gif(file: Path, stills: Iterator[Image.Image], rate: float) -> None:
    """One palette for all, so that nothing flickers."""
    images = list(stills)
    palette = images[-1].quantize(256, dither=Image.Dither.NONE)
    first, *others = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    first.save(file, format="GIF", save_all=True, append_images=others, duration=round(1000 / rate), loop=0)


def encoder() -> str:
    """ffmpeg of the system, or that of the package imageio-ffmpeg. Errors: UserError without either."""
    if found := shutil.which("ffmpeg"):
        return found
    if importlib.util.find_spec("imageio_ffmpeg"):
        return importlib.import_module("imageio_ffmpeg").get_ffmpeg_exe()
    raise UserError(
        "--out FILE.mp4: found no ffmpeg; allowed: FILE.gif, or MP4 after apt-get install ffmpeg or"
        " .venv/bin/pip install imageio-ffmpeg"
    )


def _write_mp4(file: Path, stills: Iterator[Image.Image], rate: float) -> None:
    command = encoder()
    first = next(stills)
    size = f"{first.width}x{first.height}"
    even = "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white"  # H.264 halves the colours
    words = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size, "-r", f"{rate:g}", "-i", "-", "-vf", even]
    words += ["-pix_fmt", "yuv420p", "-f", "mp4", str(file)]
    pipe = subprocess.PIPE
    child = subprocess.Popen([command, "-y", "-v", "error", *words], stdin=pipe, stderr=pipe)
    with suppress(BrokenPipeError):  # what it says tells why
        for still in (first, *stills):
            child.stdin.write(still.tobytes())
    said = child.communicate()[1].decode(errors="replace").strip()
    if child.returncode != 0:
        why = said[-300:] or "without a word"
        raise UserError(
            f"--out FILE.mp4: {command} ended with {child.returncode}: {why}",
            TRY_AGAIN if os.strerror(errno.ENOSPC) in said or child.returncode < 0 else BAD_INPUT,
        )


def animate(run: Path, out: Path, look: Look, rate: float | None = None) -> Path:
    """Writes the film and its caption; returns the film. rate: frames a second. Errors: UserError,
    RecordError.
    """
    run = run.parent if run.name == "run.json" else run
    record = read_record(run / "run.json")
    steps = [step for step in frame_paths(record, run) if step >= 0 or look.color == "body"]
    if len(steps) < 2:
        found = f"{len(steps)} frame{'s' * (len(steps) != 1)}"
        raise UserError(f"{run}: found {found} with --color {look.color}; two are needed for a film")
    if out.suffix.lower() == ".mp4":
        encoder()  # before anything is drawn
    rate = rate or min(max(len(steps) / SECONDS, SLOWEST), FASTEST)
    film = Film(run, look, _shared(record, run, steps, look), title_of(record))
    write = _write_gif if out.suffix.lower() == ".gif" else _write_mp4
    check_can_be_written(out)
    with whole(out) as part:
        write(part, _stills(film, record, steps), rate)
    text = f"{film.title}, {len(steps)} frames from {when(record, steps[0])} to {when(record, steps[-1])}."
    write_whole(out.with_suffix(".txt"), caption(f"{text} {shown(look)}", [run_row(record)]))
    return out
