"""Trajectories of lists of files: collections of ParaView (.pvd) with their times, and of what stands for
several files of one time (file_lists.py). Several parts of one time are one frame.
"""

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, replace
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.file_lists import beside, files_of_list, root_of

from .sequence import no_frames, of_obstacles, of_parts
from .trajectory import Trajectory, increasing

PartName = tuple[int, str]  # part and group


@dataclass(frozen=True)
class Entry:
    """One <DataSet>."""

    number: int  # in the file, from 0
    time_s: float
    part: PartName
    file: str


def of_list(paths: list[Path], source: str, times_s: list[float] | None = None) -> Trajectory:
    """A .vtm or .pvtu a frame."""
    return of_lists([[path] for path in paths], source, paths[0].suffix.lower()[1:], times_s)


def of_lists(frames: list[list[Path]], source: str, kind: str, times_s: list[float] | None) -> Trajectory:
    """Frames of files, of which each may be a list of files."""
    every, hidden = [], set()
    for paths in frames:
        found: list[Path] = []
        for path in paths:
            files, more = files_of_list(path)
            found += files
            hidden |= set(more)
        every.append(found)
    for paths, found in zip(frames, every):
        if len(found) != len(every[0]):
            raise UserError(f"{paths[0]}: {len(found)} files; the first frame has {len(every[0])}")
    trajectory = of_parts(every, source, kind, times_s)
    if hidden:
        note = f"blocks that show the same bodies once more are not judged: {', '.join(sorted(hidden))}"
        trajectory = replace(trajectory, notes=(*trajectory.notes, note))
    return trajectory


def _entries(path: Path) -> list[Entry]:
    """In the order of the file. Without any timestep, entries are numbered. Errors: UserError."""
    try:
        sets = root_of(path).findall("Collection/DataSet")
    except (ElementTree.ParseError, LookupError, ValueError) as error:
        raise UserError(f"{path}: not a collection of ParaView: {error}") from None
    if not sets:
        raise UserError(f"{path}: names no file; <Collection> with <DataSet timestep= file=> is needed")
    timeless = not any("timestep" in one.attrib for one in sets)
    return [
        _entry(path, k, {"timestep": str(k)} | one.attrib if timeless else one.attrib)
        for k, one in enumerate(sets)
    ]


def _entry(path: Path, k: int, attributes: dict[str, str]) -> Entry:
    place = f"{path}: DataSet {k}"
    missing = next((key for key in ("timestep", "file") if key not in attributes), None)
    if missing:
        raise UserError(f"{place}: has no {missing}; every one needs timestep= and file=")
    try:
        time_s = float(attributes["timestep"])
    except ValueError:
        raise UserError(
            f"{place}: found the timestep {attributes['timestep']!r}; a number is needed"
        ) from None
    try:
        part = int(attributes.get("part") or 0)
    except ValueError:
        raise UserError(f"{place}: found the part {attributes['part']!r}; an integer is needed") from None
    return Entry(k, time_s, (part, attributes.get("group", "")), attributes["file"])


def _check_same_times(path: Path, one: list[Entry], other: list[Entry]) -> None:
    """Errors: UserError with the first time that only one of two parts has."""
    for a, b in ((one, other), (other, one)):
        there = {entry.time_s for entry in b}
        lone = next((entry for entry in a if entry.time_s not in there), None)
        if lone:
            raise UserError(
                f"{path}: part {b[0].part[0]} has no file at {lone.time_s!r}, part {lone.part[0]} has"
                "; the same parts at every time are needed"
            )


def of_pvd(path: Path) -> Trajectory:
    """A frame a time: its parts one after the other, in the order of their numbers. Errors: UserError for
    times of a part that do not increase in the file, and for a part that is not there at every time.
    """
    parts: dict[PartName, list[Entry]] = {}
    every = _entries(path)
    kept = [entry for entry in every if not of_obstacles(Path(entry.file))] or every
    for entry in kept:
        parts.setdefault(entry.part, []).append(entry)
    ordered = [parts[name] for name in sorted(parts)]
    for entries in ordered:
        increasing([e.time_s for e in entries], lambda k, entries=entries: _place(path, entries[k]))
        _check_same_times(path, ordered[0], entries)
    frames = [[beside(path, entry.file) for entry in frame] for frame in zip(*ordered)]
    found = of_lists(frames, str(path), "pvd", [entry.time_s for entry in ordered[0]])
    notes = no_frames([Path(entry.file).name for entry in every if entry not in kept])
    return replace(found, notes=(*found.notes, *notes))


def _place(path: Path, entry: Entry) -> str:
    return f"{path}: DataSet {entry.number} (part {entry.part[0]}, file {entry.file!r})"
