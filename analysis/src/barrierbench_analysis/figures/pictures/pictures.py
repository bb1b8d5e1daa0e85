"""The stills at the top of README: runs of seconds, drawn as ./bench draw still --bare draws them, with their
captions.

Exit codes: 0 all are made, 2 a run did not end ok, a picture is too large, or README has no place for them.
"""

import re
from pathlib import Path
from typing import NamedTuple

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.record_file import read_record
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import options, parser_of
from barrierbench_analysis.program.start import finished, settings_words

from .frame_pixels import Look
from .still_picture import render

RUNS = ROOT / "results/runs/pictures"
LARGEST = 200_000  # bytes of a PNG: a page that opens at once
SIZE = (900, 640)
MARKS = ("<!-- pictures -->", "<!-- /pictures -->")  # README's row stands between them
FIXED = ("--set", "/output/frames_every=10", "--set", "/passes/time=false")


class Picture(NamedTuple):
    """One row of PICTURES."""

    name: str  # docs/NAME.png
    scene: str  # configs/scenes/SCENE.json
    says: str
    sets: dict[str, object]  # of the run, by pointer
    view: tuple[float, float]
    subdivide: int


def _meshes(body: int, **counts: int) -> dict[str, object]:
    return {f"/scene/bodies/{body}/mesh/n_{axis}": n for axis, n in counts.items()}


SHEETS = {"/formulation/name": "cubic", "/scene/bodies/1/transform/angle_deg": 45, "/time/steps": 32}
SHEETS |= _meshes(0, x=14, y=14) | _meshes(1, x=14, y=14)
SOLIDS = _meshes(0, x=6, y=6, z=4) | _meshes(1, x=4, y=4, z=4)
SOLIDS |= {f"/scene/bodies/{body}/material/solid_youngs_Pa": 15000 for body in (0, 1)}
BALL, COILS = "two cloths that have fallen onto a ball", "a soft rod that has fallen in coils"
PICTURES = (
    Picture("picture_sheets", "sheets_on_ball", BALL, SHEETS, (-60, 22), 2),
    Picture("picture_noodle", "noodle", COILS, {}, (-60, 30), 2),
    Picture(
        "picture_solids", "solid_stack", "two soft solids, one sinking into the other", SOLIDS, (-25, 24), 1
    ),
)


def command_of(picture: Picture, folder: Path) -> list[str]:
    """The words of the run."""
    sets = settings_words(picture.sets)
    config = ROOT / "configs/scenes" / f"{picture.scene}.json"
    return ["run", str(config), "--out", str(folder), *FIXED, *sets, "--progress", "none"]


def title_of(picture: Picture, record: dict) -> str:
    """Scene, formulation, vertices."""
    changed = ", finer or softer than its file" if picture.sets else ""
    return (
        f"{picture.scene}{changed}; {record['labels']['formulation']} barrier;"
        f" {record['scene']['vertices']} vertices"
    )


def make(picture: Picture, runs: Path, docs: Path) -> str:
    """Runs the scene and draws its last frame; returns its title. Errors: UserError: a run that does not end
    ok, a picture that is too large.
    """
    folder = runs / picture.name
    finished(*command_of(picture, folder), "--replace", what=f"{picture.name}: ")
    record = read_record(folder / "run.json")
    if record["status"]["outcome"] != "ok":
        raise UserError(f"{folder}: found the outcome {record['status']['outcome']}; allowed: ok")
    title = title_of(picture, record)
    look = Look(view=picture.view, size=SIZE, subdivide=picture.subdivide, bare=True)
    path = render(folder, out=docs / f"{picture.name}.png", look=look, title=title)
    if (size := path.stat().st_size) > LARGEST:
        raise UserError(f"{path}: found {size} bytes; allowed: {LARGEST}")
    return title


def row_of(titles: dict[str, str]) -> str:
    """The row of pictures and that of their captions, as a table of Markdown."""
    shown = [picture for picture in PICTURES if picture.name in titles]
    images = " | ".join(f"![{picture.says}](docs/{picture.name}.png)" for picture in shown)
    says = " | ".join(f"{picture.says}: {titles[picture.name]}" for picture in shown)
    return f"| {images} |\n|{'---|' * len(shown)}\n| {says} |"


def placed(text: str, row: str) -> str:
    """A page with the row between its marks. Errors: UserError without them."""
    found = re.compile(f"({re.escape(MARKS[0])}\n).*?({re.escape(MARKS[1])})", re.DOTALL)
    if not found.search(text):
        raise UserError(f"README.md: no {MARKS[0]} ... {MARKS[1]}; allowed: both, each on its line")
    return found.sub(lambda match: f"{match[1]}{row}\n{match[2]}", text, count=1)


@reported("draw pictures")
def main(argv: list[str]) -> int:
    parser = parser_of("draw pictures", __doc__)
    text = "--runs DIR: folder of the records (default: results/runs/pictures)"
    options(parser, text, runs={"type": Path, "default": RUNS})
    given = parser.parse_args(argv)
    page = ROOT / "README.md"
    placed(input_file.read_text(page), "")  # before minutes of work
    titles = {}
    for picture in PICTURES:
        titles[picture.name] = make(picture, given.runs, ROOT / "docs")
        print(f"docs/{picture.name}.png: {titles[picture.name]}", flush=True)
    write_whole(page, placed(input_file.read_text(page), row_of(titles)))
    return 0
