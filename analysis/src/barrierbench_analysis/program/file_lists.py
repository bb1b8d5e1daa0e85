"""What stands for several mesh files of one time: .vtm, .pvtu and .pvtp of VTK."""

import xml.etree.ElementTree as ElementTree
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.input_file import SMALL, read_bytes

LISTS = (".vtm", ".pvtu", ".pvtp")
MOST_LEVELS = 8  # of lists in lists
# Blocks that show the same body once more, as PolyFEM writes them.
SAME_BODY = (("surface", "surf", "faces"), ("volume", "tets"))
DRAWN = ("contact", "wireframe", "wire", "points", "edges", "verts", "obstacle points")


def root_of(path: Path) -> ElementTree.Element:
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


def _chosen(blocks: list[tuple[str, str]], solid: bool) -> tuple[list[str], list[str]]:
    """Files that are read, and names of blocks that show the same body."""
    names = {name.lower() for name, _ in blocks}
    order = SAME_BODY[::-1] if solid else SAME_BODY
    bodies = [group for group in order if names & set(group)]
    if not bodies:
        return [file for _, file in blocks], []
    hidden = {name for group in bodies[1:] for name in group} | set(DRAWN)
    kept = [file for name, file in blocks if name.lower() not in hidden]
    return kept, [name for name, _ in blocks if name.lower() in hidden]


def files_of_list(path: Path, solid: bool = False, levels: int = 0) -> tuple[list[Path], list[str]]:
    """The mesh files of a .vtm, .pvtu or .pvtp, and names of blocks that are left out. solid: of a body that
    is there as surface and as volume the volume is read, else the surface. Errors: UserError.
    """
    if path.suffix.lower() not in LISTS:
        return [path], []
    if levels > MOST_LEVELS:
        raise UserError(f"{path}: lists in lists; at most {MOST_LEVELS} levels are allowed")
    try:
        root = root_of(path)
    except (ElementTree.ParseError, LookupError, ValueError) as error:
        raise UserError(f"{path}: not a list of files of VTK: {error}") from None
    if path.suffix.lower() == ".vtm":
        files, hidden = _chosen(_blocks(root), solid)
    else:
        files, hidden = [one.get("Source", "") for one in root.iter("Piece") if one.get("Source")], []
    if not files:
        raise UserError(f"{path}: names no file of a mesh; DataSet file= or Piece Source= is needed")
    found: list[Path] = []
    for file in files:
        inner, more = files_of_list(beside(path, file), solid, levels + 1)
        found += inner
        hidden += more
    return found, hidden


def beside(path: Path, file: str) -> Path:
    """A file that a list names, with the separators of either system."""
    return path.parent / file.replace("\\", "/")
