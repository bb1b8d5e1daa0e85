"""The figures of a report as data URIs: those of ./bench draw figures for groups whose runs one figure can
hold, and for larger groups one that puts a mark for each run.
"""

import base64
import glob
import struct
import tempfile
import textwrap
from dataclasses import dataclass, field
from pathlib import Path

from barrierbench_analysis.figures.plots import answer, condition, over_time
from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.tables import series
from barrierbench_analysis.tables.records import Records, load
from barrierbench_analysis.tables.words import counted, listed

from . import marks
from .gather import Folder

OVER_TIME = {"condition": condition.figure, "iterations": over_time.iterations, "gaps": over_time.gaps}
MOST_RUNS = 12  # of a group whose runs are drawn over time: three figures of series.MOST
MOST_GROUPS = 6


@dataclass(frozen=True)
class Figure:
    group: str
    uri: str
    width: int  # pixels
    height: int
    caption: str  # what is shown; the text for those who do not see it, too
    settings: str  # of its runs, machine and day

    @property
    def first(self) -> str:
        """The first sentence of the caption."""
        return self.caption.split(". ", 1)[0].rstrip(".") + "."

    @property
    def rest(self) -> str:
        return self.caption.partition(". ")[2]


@dataclass
class Figures:
    shown: list[Figure] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)  # what is left out, and why
    answer: Figure | None = None  # the log over the cubic


def figure_of(group: str, png: Path) -> Figure:
    """A picture and the caption beside it (style.save). Errors: OSError."""
    data = input_file.read_bytes(png)
    width, height = struct.unpack(">II", data[16:24])  # of IHDR, the first chunk of every PNG
    shown, _, settings = input_file.read_text(png.with_suffix(".txt")).partition("\n\n")
    uri = f"data:image/png;base64,{base64.b64encode(data).decode('ascii')}"
    return Figure(group, uri, width, height, " ".join(shown.split()), " ".join(settings.split()))


def _pictures(paths: list[Path]) -> list[Path]:
    """Those that a page shows: eigenvalues stay with ./bench draw figures."""
    return [path for path in paths if path.suffix == ".png" and not path.stem.endswith(condition.EIGENVALUES)]


def _over_time(records: Records, group: str, out: Path) -> list[Path]:
    return _pictures([path for draw in OVER_TIME.values() for path in draw(records, group, out)])


def _kept(group: str, where: Path) -> list[Path]:
    """What ./bench draw figures has drawn of a group, in the order of OVER_TIME."""
    names = [f"{name}_{group}" for name in OVER_TIME]
    there = [(name, path) for name in names for path in sorted(where.glob(f"{glob.escape(name)}*.png"))]
    return _pictures(
        [path for name, path in there if f"{path.stem}{series.MORE}".startswith(name + series.MORE)]
    )


def _answer(folder: Folder, kept: Path | None, scratch: Path) -> Figure | None:
    """The log over the cubic; None where no fixed log stands beside a fixed cubic."""
    there = kept and kept / f"{answer.STEM}.png"
    paths = [there] if there and there.is_file() else answer.figure(folder.rows.values(), scratch)
    return figure_of("", paths[0]) if paths else None


def drawn(folder: Folder, kept: Path | None = None) -> Figures:
    """kept: a folder where the figures of these very records have just been drawn. A trace that is not its
    record's leaves its group without figures, which is said. Cost: 1 to 5 s a group.
    """
    found = Figures()
    small = [group for group, entries in folder.groups.items() if len(entries) <= MOST_RUNS]
    large = [group for group in folder.groups if group not in small]
    with tempfile.TemporaryDirectory() as scratch:
        found.answer = _answer(folder, kept, Path(scratch))
        for group in small[:MOST_GROUPS]:
            try:
                paths = _kept(group, kept) if kept else []
                if not paths:
                    files = [entry.path for entry in folder.groups[group]]
                    paths = _over_time(load(folder.root, files), group, Path(scratch))
            except UserError as error:
                why = textwrap.shorten(folder.told(str(error)), 300)
                found.notes.append(f"{group} has no figures: {why}")
                continue
            found.shown += [figure_of(group, path) for path in paths]
        for group in large[:MOST_GROUPS]:
            for path in marks.figure(folder.groups[group], group, Path(scratch)):
                found.shown.append(figure_of(group, path))
    for some, what in ((small, "groups"), (large, "larger groups")):
        if left := some[MOST_GROUPS:]:
            found.notes.append(
                f"Left out to keep the page small: figures of {counted(len(left), what[:-1], what)}"
                f" ({listed(left)}); ./bench draw figures draws them."
            )
    if large:
        which = f"Groups of more than {MOST_RUNS} runs ({listed(large)})"
        found.notes.append(f"{which} have a mark for each run instead of lines over time.")
    return found
