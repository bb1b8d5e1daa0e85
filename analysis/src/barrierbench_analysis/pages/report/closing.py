"""How a demonstration ends on the terminal: the answer, the failures that were expected, what to open."""

import textwrap
from pathlib import Path

from barrierbench_analysis.figures.plots.answer import STEM
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.pages.play.verb import play

from . import answer, verdict
from .gather import Folder, gathered
from .players import pairs
from .tables import shown_path

PLAYER = "player.html"


def _player(folder: Folder) -> Path | None:
    """The player of the first two runs that can be compared, made anew; None where no run kept frames, or
    what draws them is not installed.
    """
    out = folder.root / PLAYER
    for runs in pairs(folder)[:1]:
        try:
            play([run.path.parent for run in runs], out, "gap")
        except UserError:
            return None
        return out
    return None


def lines(root: Path, page: Path, drawn: Path) -> list[str]:
    """Lines of at most answer.WIDTH characters, paths apart. page: the report; drawn: the folder of figures.
    Errors: UserError without records. Cost: seconds, most of them for the player.
    """
    folder = gathered(root)
    files = [("report page", page), ("comparison figure", drawn / f"{STEM}.png"), ("player", _player(folder))]
    there = [f"  {name:<17}  {shown_path(file)}" for name, file in files if file and file.is_file()]
    said = [line for one in verdict.expectations(folder) for line in textwrap.wrap(one.text, answer.WIDTH)]
    return [*answer.lines(answer.of(folder)), "", *said, *[""] * bool(said), "Open:", *there]
