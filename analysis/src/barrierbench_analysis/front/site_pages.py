"""The pages of the web site as files: copied below one folder where links between them stay as they are, and
their navigation by folders.
"""

import os
import re
import shutil
from collections.abc import Iterable
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.whole_file import write_whole

HOME = "README.md"
# Title -> folders of its pages, each with the folders below it.
SECTIONS = {
    "Theory": ("docs/theory",),
    "Guides": ("docs/guides",),
    "Reference": ("docs/reference",),
    "Results": ("docs/results", "results"),
}
OTHERS = "Project"  # title of what stands in none of them
PATTERNS = (HOME, "CHANGELOG.md", "CONTRIBUTING.md", "docs/**/*.md", "results/*.md")
LINK = re.compile(r"\]\(([^)\s#]+)(?:#[^)\s]*)?\)")
FENCE = re.compile(r"^\s*```")
ITEM = re.compile(r"^\s*(?:[-*]|\d+\.) ")


def targets(page: str, text: str) -> list[str]:
    """Files of the repository that a page links to, from its root."""
    links = [link for link in LINK.findall(text) if not re.match(r"[a-z]+:", link)]
    return [os.path.normpath(os.path.join(os.path.dirname(page), link)) for link in links]


def staged(root: Path) -> list[str]:
    """Pages of PATTERNS and every file that they, or pages they lead to, link to, from the root. Errors:
    UserError for a link to nothing, or to a folder.
    """
    todo = [path.relative_to(root).as_posix() for of in PATTERNS for path in sorted(root.glob(of))]
    found: dict[str, None] = {}
    while todo:
        name = todo.pop(0)
        if name in found:
            continue
        found[name] = None
        if name.endswith(".md"):
            linked = targets(name, input_file.read_text(root / name))
            if lost := [of for of in linked if not (root / of).is_file()]:
                raise UserError(f"{name}: found a link to {lost[0]}; allowed: a file of this repository")
            todo += linked
    return list(found)


def blank_before_lists(text: str) -> str:
    """The same page with an empty line before each list that follows a paragraph: GitHub needs none, and
    Python-Markdown does."""
    lines, fenced, in_item = [""], False, False
    for line in text.splitlines():
        if ITEM.match(line) and not fenced:
            if lines[-1].strip() and not in_item:
                lines.append("")
            in_item = True
        in_item &= bool(line.strip())
        fenced ^= bool(FENCE.match(line))
        lines.append(line)
    return "\n".join(lines[1:]) + "\n"


def stage(root: Path, folder: Path) -> list[str]:
    """Copies what the site needs to `folder`, which it empties. Returns the names. Errors: as `staged`."""
    names = staged(root)
    shutil.rmtree(folder, ignore_errors=True)
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        if name.endswith(".md"):
            write_whole(folder / name, blank_before_lists(input_file.read_text(root / name)))
        else:
            shutil.copyfile(root / name, folder / name)
    return names


def _tree(folder: str, pages: Iterable[str]) -> list:
    """Navigation of a folder: its index, its pages, and a section for each folder in it."""
    below = [page for page in pages if page.startswith(f"{folder}/")]
    here = sorted(page for page in below if page.count("/") == folder.count("/") + 1)
    index = [page for page in here if page.endswith("/index.md")]
    deeper = sorted({page.split("/")[folder.count("/") + 1] for page in below} - {Path(p).name for p in here})
    sections = [{name.capitalize(): _tree(f"{folder}/{name}", below)} for name in deeper]
    return [*index, *(page for page in here if page not in index), *sections]


def navigation(names: Iterable[str]) -> list:
    """Every page once, by SECTIONS; a section without pages is left out."""
    pages = [name for name in names if name.endswith(".md") and name != HOME]
    sections: dict[str, list] = {}
    for title, (first, *more) in SECTIONS.items():
        entries = [*_tree(first, pages), *({"Studies": _tree(of, pages)} for of in more)]
        sections |= {title: entries} if entries else {}
    folders = tuple(f"{folder}/" for of in SECTIONS.values() for folder in of)
    others = [page for page in pages if not page.startswith(folders)]
    sections |= {OTHERS: others} if others else {}
    return [{"Home": HOME}, *({title: entries} for title, entries in sections.items())]
