"""Figures beside the pages: those of the demo that a page shows, with every figure that a caption sends its
readers to.
"""

import re
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.whole_file import copy_whole

LINK = re.compile(r"!\[[^\]]*\]\((?:docs/|\.\./)*(\w+)\.png\)")
COMPANY = re.compile(r"\b(\w+_more)\b")  # names of further figures in captions


def shown(pages: list[str]) -> set[str]:
    return {name for text in pages for name in LINK.findall(text)}


def copy(pages: list[str], made: Path, docs: Path) -> list[str]:
    """Copies picture and caption of every figure in `made` that a page shows or the caption of one names.
    Returns their names.
    """
    found, todo = [], sorted(shown(pages))
    while todo:
        name = todo.pop()
        if name in found or not (made / f"{name}.png").is_file():
            continue
        found.append(name)
        for suffix in (".png", ".txt"):
            copy_whole(made / f"{name}{suffix}", docs / f"{name}{suffix}")
        todo += COMPANY.findall(input_file.read_text(made / f"{name}.txt"))
    return sorted(found)


def absent(docs: Path) -> list[str]:
    """One line for every figure that a caption names and that is not there."""
    return [
        f"{path}: names {name}, and {docs}/{name}.png is not there; ./bench dev readme --write copies it"
        for path in sorted(docs.glob("*.txt"))
        for name in dict.fromkeys(COMPANY.findall(input_file.read_text(path)))
        if not (docs / f"{name}.png").is_file()
    ]
