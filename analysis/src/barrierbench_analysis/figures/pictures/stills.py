"""Stills of the last frames of several runs in one picture, each under its label and outcome.

Runs need frames (/output/frames_every). A run that a body has passed through another in is drawn like any
other: its outcome says so.
"""

import math
import tempfile
from pathlib import Path
from typing import NamedTuple

import matplotlib.image as image
import matplotlib.pyplot as plt

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.titles import broken
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.record_file import read_record
from barrierbench_analysis.io.whole_file import write_figure
from barrierbench_analysis.program.arguments import finite_number, options, parser_of
from barrierbench_analysis.program.progress import counted

from .frame_pixels import Look
from .still_picture import MEANS, picture_file, render

MOST = 60  # runs in one picture
COLUMNS = 5  # that are as wide as a page
SIZE, LINE_IN = 10, 0.25  # points of a title, inches of a line of it
PIXELS = (360, 280)
VIEW = (-60.0, 22.0)  # degrees, of a scene that has none of its own


class Still(NamedTuple):
    """What stands above it, a run with frames, and how it is looked at."""

    title: str
    folder: Path
    look: Look


def label_of(record: dict) -> str:
    """What tables call it, of a sweep without the sweep's name; of an earlier record scene, step solver and
    formulation. Below it, how it ended.
    """
    labels, status = record["labels"], record["status"]
    of_sweep = (record.get("ids") or {}).get("sweep_id")
    name = (of_sweep and labels["note"].partition(": ")[2]) or labels["note"]
    name = name or f"{labels['scene']}, {labels['step_solver']} {labels['formulation']}"
    crossings = (record.get("audit") or {}).get("crossings") or 0
    return f"{name}\n{status['outcome']}" + (f"\n{crossings} crossings" if crossings else "")


def sheet(stills: list[Still], out: Path, columns: int) -> Path:
    """A PNG of the last frame of each, in rows of so many. out: as picture_file takes it. Errors: UserError,
    RecordError.
    """
    out = picture_file(out, "stills.png")
    rows = math.ceil(len(stills) / columns)
    width = 2 * style.WIDE_IN / COLUMNS  # inches of one picture
    fig, axes = plt.subplots(rows, columns, squeeze=False, layout="constrained")
    titles = [broken(fig, still.title, 0.94 * width, SIZE) for still in stills]
    lines = max(title.count("\n") for title in titles) + 1
    fig.set_size_inches(columns * width, rows * (width * PIXELS[1] / PIXELS[0] + lines * LINE_IN))
    for axis in axes.flat:
        axis.set_axis_off()
    with tempfile.TemporaryDirectory() as scratch:
        for axis, still, title in counted(zip(axes.flat, stills, titles), len(stills), "stills: run"):
            file = render(still.folder, out=Path(scratch) / "still.png", look=still.look)
            axis.imshow(image.imread(file))
            axis.set_title(title, fontsize=SIZE)
    write_figure(fig, out, dpi=130, bbox_inches="tight", pad_inches=0.05, metadata={"Software": None})
    plt.close(fig)
    return out


@reported("draw sheet")
def main(argv: list[str]) -> int:
    """0: drawn; 2: a run without a record or frames."""
    parser = parser_of("draw sheet", __doc__)
    text = f"""
runs RUN: folders of run.json
--out FILE.png: {MEANS}
--columns N: pictures in a row (default: 3)
--view AZIMUTH ELEVATION
--hide BODY: bodies that are not drawn"""
    kinds = {"runs": {"nargs": "+", "type": Path}, "out": {"type": Path, "required": True}}
    kinds |= {"columns": {"type": int, "default": 3}, "hide": {"nargs": "+", "default": ()}}
    options(parser, text, **kinds, view={"type": finite_number, "nargs": 2, "default": VIEW})
    given = parser.parse_args(argv)
    if given.columns < 1 or len(given.runs) > MOST:
        raise UserError(
            f"found {len(given.runs)} runs in {given.columns} columns; allowed: 1 to {MOST} runs in 1 or more"
        )
    look = Look(view=tuple(given.view), size=PIXELS, bare=True, hidden=tuple(given.hide))
    folders = [run.parent if run.name == "run.json" else run for run in given.runs]
    stills = [Still(label_of(read_record(folder / "run.json")), folder, look) for folder in folders]
    print(sheet(stills, given.out, given.columns))
    return 0
