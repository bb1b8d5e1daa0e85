"""Players of scenes inside a report: for runs that kept frames, a run beside its reference where both have
some. The library that draws stands in the page once.
"""

import base64
import importlib.util
import zlib
from dataclasses import dataclass, field

from barrierbench_analysis.figures.pictures.film import filmed, opened
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.pages.play.page import packed_library, page
from barrierbench_analysis.pages.play.verb import differences, every_within
from barrierbench_analysis.tables.words import counted, listed

from .gather import Entry, Folder

SLOT = "{{library}}"  # page.js puts the library there
MOST = 2
FILM_BYTES = 2_000_000  # of the arrays of one player


@dataclass(frozen=True)
class Player:
    title: str
    about: str
    packed: str  # its page without the library, compressed, base64


@dataclass
class Players:
    shown: list[Player] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    library: str = ""


def pairs(folder: Folder) -> list[tuple[Entry, ...]]:
    """Runs with frames, one choice a group: a run and its reference, a comparable one where there is one;
    else the first run alone.
    """
    found = []
    for entries in folder.groups.values():
        filmed_runs = [entry for entry in entries if entry.frames]
        beside = [
            (reference, entry)
            for entry in filmed_runs
            if (reference := folder.reference_of(entry)) and reference is not entry and reference.frames
        ]
        beside.sort(key=lambda pair: pair[1].row["comparability_verdict"] != "comparable")
        found += beside[:1] or [(entry,) for entry in filmed_runs[:1]]
    return found


def _player(runs: tuple[Entry, ...]) -> Player:
    """Errors: UserError, RecordError: frames that are not the record's, or are broken."""
    sources = [opened(run.path.parent) for run in runs]
    every = every_within(sources, lambda count: count <= FILM_BYTES)
    films = [filmed(source, every) for source in sources]
    notes = differences(films)
    kept = sum(len(film.steps) for film in films)
    if left := sum(film.left_out for film in films):
        notes.append(f"{kept} of {kept + left} frames are in this page; ./bench draw player shows all.")
    text = page(films, "gap", notes, shared_library=SLOT)
    title = " beside ".join(run.name for run in runs)
    about = f"{counted(kept, 'frame')}. {' '.join(notes)}".strip()
    return Player(title, about, base64.b64encode(zlib.compress(text.encode(), 9)).decode("ascii"))


def made(folder: Folder, most: int = MOST) -> Players:
    """At most so many players. A run whose frames cannot be read has none, which is said."""
    found, choice = Players(), pairs(folder)
    kept = sum(bool(entry.frames) for entry in folder.entries)
    if not kept:
        return found
    if importlib.util.find_spec("k3d") is None:
        found.notes.append("Runs kept frames, but the package k3d that draws them is not installed.")
        return found
    shown = set()
    for runs in choice:
        if len(found.shown) == most:
            break
        try:
            found.shown.append(_player(runs))
            shown |= {run.run for run in runs}
        except UserError as error:
            why = folder.told(str(error))
            found.notes.append(f"No player of {listed([run.run for run in runs])}: {why}")
    if found.shown:
        found.library = packed_library()
    if left := kept - len(shown):
        found.notes.append(
            f"{counted(left, 'more run')} kept frames: ./bench draw player RUN [RUN2] plays them."
        )
    return found
