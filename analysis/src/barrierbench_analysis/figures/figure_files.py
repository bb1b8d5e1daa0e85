"""Figures beside the pages that show them."""

from collections.abc import Iterable
from pathlib import Path

from barrierbench_analysis.io.whole_file import copy_whole

ON_PAGE = (".png", ".txt")  # the picture and its caption; the others stay beside the records


def copy_to_page(paths: Iterable[Path], docs: Path) -> None:
    """Copies picture and caption of the files of a figure (style.save) into docs, which is made."""
    for path in paths:
        if path.suffix in ON_PAGE:
            copy_whole(path, docs / path.name)
