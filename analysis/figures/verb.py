"""The verb figures: those of the records below a folder, or of the file of ./bench steps --out."""

from __future__ import annotations

from pathlib import Path

from ..errors import tells
from ..front.arguments import parser_of
from . import demo, newton_steps


@tells("figures")
def main(argv: list[str]) -> int:
    parser = parser_of("figures")
    parser.add_argument("runs", type=Path, metavar="RUNS", help="a folder with records, or that file")
    parser.add_argument(
        "out", type=Path, nargs="?", metavar="OUT", help="default: RUNS/figures, or the folder of the file"
    )
    given = parser.parse_args(argv)
    return (newton_steps if given.runs.is_file() else demo).make(given.runs, given.out)
