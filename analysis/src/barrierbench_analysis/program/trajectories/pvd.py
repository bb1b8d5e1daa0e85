"""Lists of files: collections of ParaView (.pvd) with their times, and what stands for several files of one
time (.vtm, .pvtu, .pvtp). Several parts of one time are one frame.
"""

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, replace
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.input_file import SMALL, read_bytes

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


LISTS = (".vtm", ".pvtu", ".pvtp")
MOST_LEVELS = 8  # of lists in lists
# Blocks that show the same body once more, as PolyFEM writes them; the first that is there is judged.
SAME_BODY = (("surface", "surf", "faces"), ("volume", "tets"))
DRAWN = ("contact", "wireframe", "wire", "points", "edges", "verts", "obstacle points")


def _root(path: Path) -> ElementTree.Element:
    return ElementTree.fromstring(read_bytes(path, SMALL))


def _blocks(root: ElementTree.Element) -> list[tuple[str, str]]:
    """Names of blocks and files, in the order of the file."""
    out: list[tuple[str, str]] = []

    def walk(element: ElementTree.Element, name: str) -> None:
        for child in element:
            of_child = child.get("name") or name
            if child.tag == "DataSet" and child.get("file"):
                out.append((name or of_child, child.get("file", "")))
            walk(child, of_child if child.tag in ("Block", "Piece") else name)

    walk(root, "")
    return out


def _chosen(blocks: list[tuple[str, str]]) -> tuple[list[str], list[str]]:
    """Files that are judged, and names of blocks that show the same body."""
    names = {name.lower() for name, _ in blocks}
    bodies = [group for group in SAME_BODY if names & set(group)]
    if not bodies:
        return [file for _, file in blocks], []
    hidden = {name for group in bodies[1:] for name in group} | set(DRAWN)
    kept = [file for name, file in blocks if name.lower() not in hidden]
    return kept, [name for name, _ in blocks if name.lower() in hidden]


def files_of_list(path: Path, levels: int = 0) -> tuple[list[Path], list[str]]:
    """The mesh files of a .vtm, .pvtu or .pvtp, and what was left out. Errors: UserError."""
    if path.suffix.lower() not in LISTS:
        return [path], []
    if levels > MOST_LEVELS:
        raise UserError(f"{path}: lists in lists; at most {MOST_LEVELS} levels are allowed")
    try:
        root = _root(path)
    except (ElementTree.ParseError, LookupError, ValueError) as error:
        raise UserError(f"{path}: not a list of files of VTK: {error}") from None
    if path.suffix.lower() == ".vtm":
        files, hidden = _chosen(_blocks(root))
    else:
        files, hidden = [one.get("Source", "") for one in root.iter("Piece") if one.get("Source")], []
    if not files:
        raise UserError(f"{path}: names no file of a mesh; DataSet file= or Piece Source= is needed")
    found: list[Path] = []
    for file in files:
        inner, more = files_of_list(beside(path, file), levels + 1)
        found += inner
        hidden += more
    return found, hidden


def beside(path: Path, file: str) -> Path:
    """A file that a list names, with the separators of either system."""
    return path.parent / file.replace("\\", "/")


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
        sets = _root(path).findall("Collection/DataSet")
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
