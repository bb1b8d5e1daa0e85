"""Parsers of the verbs in Python, made of their rows in the table."""

from __future__ import annotations

import argparse
import textwrap
from typing import NoReturn

from ..errors import UserError
from . import verbs

WIDTH = 110


class Parser(argparse.ArgumentParser):
    """A wrong argument is an error of the user like any other: `tells` says it."""

    def error(self, message: str) -> NoReturn:
        raise UserError(f"{message} (./{self.prog} --help says what there is)")


def parser_of(name: str, doc: str | None = None, *examples: str) -> Parser:
    """For the arguments of a verb: its help begins with that of its row, goes on with `doc`, which is printed
    as it is, and ends with the example of the row and more of them.
    """
    row = verbs.find(name)
    about = textwrap.fill(f"{row.help[0].upper()}{row.help[1:]}.", WIDTH)
    shown = (row.example, *examples)
    return Parser(
        prog=f"bench {name}",
        description=f"{about}\n\n{doc.strip()}" if doc else about,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="\n".join([f"example{'s' * (len(shown) > 1)}:", *(f"  {one}" for one in shown)]),
    )


def plugin_argument(parser: argparse.ArgumentParser) -> None:
    """--plugin, as the program takes it; may be repeated."""
    parser.add_argument(
        "--plugin",
        action="append",
        default=[],
        metavar="FILE.so",
        help=(
            "a shared library with shapes, stiffness policies or integrators, loaded by every run; may be"
            " repeated (examples/plugins/README.md)"
        ),
    )
