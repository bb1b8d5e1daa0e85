"""The scenes of the catalogue, with their sizes as the program builds them. --write makes the ordinary
config of one, at the size mini or, with --full, at that of its source, for ./bench run.

Exit codes: 0, 1 a size is not the one that the scene states of its source, 2 bad input.
"""

import argparse
import contextlib
import os
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.text_table import fitted
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import parser_of

from . import sizes
from .counts import counts_of, each_built, is_large, unlike
from .entry import FULL, MINI, Entry, config_text, entries, write_config


def _arguments(argv: list[str]) -> argparse.Namespace:
    parser = parser_of("scenes", __doc__, "./bench scenes twist --write twist.json --full")
    parser.add_argument("names", nargs="*", metavar="NAME", help="configs/catalogue/NAME.json (default: all)")
    parser.add_argument("--write", type=Path, metavar="FILE", help="write the config of the scene NAME")
    parser.add_argument("--full", action="store_true", help="at the size of the source")
    parser.add_argument("--list", action="store_true", help="names and titles alone, nothing is built")
    words = "build all full scenes and write results/CATALOGUE_SIZES.md: their counts beside their sources'"
    parser.add_argument("--sizes", action="store_true", help=words)
    return parser.parse_args(argv)


def _sizes() -> int:
    """1: a count is off without a reason, or has a reason and is not off."""
    chosen = entries([])
    kept = sizes.built(chosen)
    sizes.write(kept)
    write_whole(sizes.PAGE, sizes.page())
    complaints = [words for entry in chosen if (words := sizes.complaint(entry, kept[entry.name]))]
    print("\n".join([*complaints, str(sizes.PAGE)]))
    return 1 if complaints else 0


def _print_table(chosen: list[Entry], build_large: bool) -> int:
    def cell(of: tuple[Entry, str]) -> tuple[str, str]:
        """vertices/faces, and what is wrong with them."""
        entry, size = of
        stated = entry.data[size]
        if not build_large and is_large(entry, size):
            return f"({stated['vertices']}/{stated['faces']})", ""
        try:
            counts = counts_of(entry, size)
        except UserError as error:
            return "-", str(error)
        wrong = unlike(counts, stated)
        return f"{counts['vertices']}/{counts['faces']}", f"{entry.path}#/{size}: {wrong}" if wrong else ""

    cells = list(each_built(cell, [(entry, size) for entry in chosen for size in (MINI, FULL)], "scenes"))
    rows = [
        [entry.name, mini, full, entry.data["stresses"]]
        for entry, (mini, _), (full, _) in zip(chosen, cells[::2], cells[1::2], strict=True)
    ]
    complaints = [wrong for _, wrong in cells if wrong]
    print("\n".join(fitted(["scene", "mini", "full", "what it stresses"], rows, {1, 2})))
    print("mini, full: vertices/faces of the whole scene; in brackets: stated, and built where it is named")
    print("\n".join(complaints), end="\n" if complaints else "")
    return 1 if complaints else 0


def _print_one(entry: Entry) -> None:
    print(f"{entry.name}: {entry.data['title']}\nfrom      {entry.data['source']}")
    for word in entry.data["deviations"]:
        print(f"deviates  {word}")
    for expected in entry.data["expect"]:
        own = ", ".join(f"{k} {v}" for k, v in expected.items() if k not in ("check", "because"))
        print(f"expects   {expected['check']}{f' ({own})' if own else ''}: {expected['because']}")


def _is_written(entry: Entry, file: Path, size: str) -> bool:
    """The file is this very config already. Errors: UserError: it is another one, or cannot be read."""
    if not os.path.lexists(file):
        return False
    with contextlib.suppress(UserError, UnicodeDecodeError):
        if input_file.read_text(file) == config_text(entry, size):
            return True
    raise UserError(f"--write: {file} is there, with other contents; allowed: a name that is free")


@reported("scenes")
def main(argv: list[str]) -> int:
    args = _arguments(argv)
    chosen = entries(args.names)
    if args.write:
        if len(args.names) != 1:
            raise UserError("--write: one NAME is needed")
        size = FULL if args.full else MINI
        if not _is_written(chosen[0], args.write, size):
            write_config(chosen[0], args.write, size)
        print(args.write)
        return 0
    if args.sizes:
        if args.names:
            raise UserError("--sizes: all scenes, without a NAME")
        return _sizes()
    if args.full:
        raise UserError("--full: --write FILE is needed with it")
    if args.list:
        rows = [[one.name, one.data["title"]] for one in chosen]
        print("\n".join(fitted(["scene", "title"], rows)))
        return 0
    if len(args.names) == 1:
        _print_one(chosen[0])
    return _print_table(chosen, build_large=bool(args.names))
