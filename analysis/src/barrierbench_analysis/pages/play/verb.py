"""One self-contained HTML file that plays the frames of a run, or of two runs side by side: ./bench draw
player RUN [RUN2].
"""

import argparse
from collections.abc import Callable
from pathlib import Path

from barrierbench_analysis.figures.pictures.film import Film, filmed, kept, opened
from barrierbench_analysis.figures.surfaces.sequence import Run
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import (
    bicubic_argument,
    color_argument,
    count_from_1,
    options,
    parser_of,
    positive_number,
)
from barrierbench_analysis.tables.run_rows import case_name, own_name

from .page import page, page_bytes
from .scales import COLOURS

LIMIT_MB = 50  # a page that a browser opens at once and that can be sent by mail
SAME_TIME_S = 1e-9  # times that differ by less are those of one state


def _megabytes(count: float) -> str:
    return f"{count / 1e6:.1f} MB"


def _film_bytes(sources: list[Run], every: int) -> int:
    return sum(len(kept(source.steps, every)) * source.frame_bytes for source in sources)


def every_within(sources: list[Run], fits: Callable[[int], bool]) -> int:
    """The first of every 1, 2, 3, ... frames whose bytes fit; if none does only the first and the last frame
    are left.
    """
    every, most = 1, max(len(source.steps) for source in sources)
    while not fits(_film_bytes(sources, every)) and every < most:
        every += 1
    return every


def chosen_every(sources: list[Run], asked: int | None, limit_mb: float) -> tuple[int, str]:
    """Every how many frames a page keeps, and a sentence where the limit decides. Errors: UserError: not even
    the first and the last frame fit.
    """
    if asked is not None:
        return asked, ""
    limit = 1e6 * limit_mb
    whole = page_bytes(_film_bytes(sources, 1))
    every = every_within(sources, lambda count: page_bytes(count) <= limit)
    if (least := page_bytes(_film_bytes(sources, every))) > limit:
        raise UserError(
            f"--limit-mb: found {limit_mb:g}; allowed: {least / 1e6:.1f} or more, what the first and the"
            " last frame take"
        )
    if every == 1:
        return 1, ""
    return every, (
        f"Of every {every} frames one is kept: all {sum(len(s.steps) for s in sources)} take up to"
        f" {_megabytes(whole)} (--limit-mb {limit_mb:g}; --every 1 keeps them)."
    )


def differences(films: list[Film]) -> list[str]:
    """Sentences on what makes two films unlike: scenes, times."""
    if len(films) < 2:
        return []
    one, two = films
    found = []
    if one.labels["scene"] != two.labels["scene"]:
        found.append(f"The scenes differ: {one.labels['scene']} and {two.labels['scene']}.")
    same = len(one.times_s) == len(two.times_s) and all(
        abs(a - b) <= SAME_TIME_S for a, b in zip(one.times_s, two.times_s)
    )
    if not same:
        ends = [f"{len(film.times_s)} frames up to t = {film.times_s[-1]:g} s" for film in films]
        found.append(
            f"The times of the frames differ: {ends[0]} in the first run, {ends[1]} in the second. Each view"
            " shows its last frame up to the time of the slider."
        )
    return found


def default_out(runs: list[Path]) -> Path:
    """play.html in the folder of the first run; of two runs the name says the second one."""
    folders = [run.parent if run.name == "run.json" else run for run in runs]
    name = "play.html" if len(runs) == 1 else f"play_beside_{folders[1].resolve().name}.html"
    return folders[0] / name


def play(
    runs: list[Path],
    out: Path,
    colour: str,
    every: int | None = None,
    limit_mb: float = LIMIT_MB,
    bicubic: tuple[int, int] | None = None,
) -> list[str]:
    """Writes the page; returns what is to be said about it. Errors: UserError, RecordError."""
    sources = [opened(run, bicubic) for run in runs]
    every, cut = chosen_every(sources, every, limit_mb)
    films = [filmed(source, every) for source in sources]
    notes = differences(films) + ([cut] if cut else [])
    write_whole(out, page(films, colour, notes))
    shown = " beside ".join(
        f"{len(film.times_s)} frames of {own_name(film.labels) or film.labels['scene']},"
        f" {case_name(film.labels)} ({film.outcome})"
        for film in films
    )
    return [*notes, f"{out} ({_megabytes(out.stat().st_size)}): {shown}"]


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = parser_of("draw player", "Frames are written by runs with --set /output/frames_every=1.")
    text = f"""
runs RUN: folder of run.json; one or two
--out: the HTML file (default: play.html in the folder of RUN)
--every N: one of every N frames, and the last one (default: 1, or what --limit-mb needs)
--limit-mb MB: most that the file may take where --every is not given (default: {LIMIT_MB})"""
    kinds = {"runs": {"type": Path, "nargs": "+"}, "limit_mb": {"type": positive_number, "default": LIMIT_MB}}
    options(parser, text, out=Path, every=count_from_1, **kinds)
    color_argument(parser, COLOURS, "gap", "what colors mean at first; the page can change it")
    bicubic_argument(parser)
    args = parser.parse_args(arguments)
    if len(args.runs) > 2:
        raise UserError(f"found {len(args.runs)} runs; allowed: one, or two side by side")
    return args


@reported("draw player")
def main(arguments: list[str]) -> int:
    args = parse(arguments)
    out = args.out or default_out(args.runs)
    print("\n".join(play(args.runs, out, args.color, args.every, args.limit_mb, args.bicubic)))
    return 0
