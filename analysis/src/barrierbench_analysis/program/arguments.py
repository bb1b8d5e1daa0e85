"""Parsers of the verbs in Python, made of their rows in the table."""

import argparse
import math
import re
import shutil
import textwrap
from collections.abc import Callable, Iterable
from typing import NoReturn

from barrierbench_analysis.io.errors import UserError

from . import verbs
from .verb_table import Heading

WIDTH = 110  # of text where the terminal is wider, or there is none


def text_width() -> int:
    """Characters of a line of help."""
    return min(WIDTH, shutil.get_terminal_size((WIDTH, 24)).columns)


class Parser(argparse.ArgumentParser):
    """A wrong argument is an error of the user like any other: `reported` reports it."""

    takes_formula = False

    def parse_args(self, args: list[str] | None = None, namespace=None) -> argparse.Namespace:
        """A word that is empty would be the folder that this is called from, or not a number."""
        options = self._option_string_actions
        for number, (before, word) in enumerate(zip(["", *(args or [])], args or []), 1):
            if before == "--":
                options = {}  # behind it there are none
            takes_one = before in options and options[before].nargs != 0
            if word == "":
                self._found_nothing(before if takes_one else str(number))
            if options and re.fullmatch("--[a-z-]+=", word):
                self._found_nothing(word[:-1])
        return super().parse_args(args, namespace)

    def _found_nothing(self, argument: str) -> NoReturn:
        self.error(f"argument {argument}: found nothing; allowed: a value")

    def error(self, message: str) -> NoReturn:
        raise UserError(f"{message} (./{self.prog} --help says what there is)")

    def formula_argument(self, name: str, metavar: str) -> None:
        """A positional argument that may begin with a minus. All options of such a parser are -h or begin
        with two minus signs.
        """
        self.takes_formula = True
        self.add_argument(name, metavar=metavar, type=str.strip)

    def parse_known_args(self, args: list[str] | None = None, namespace: argparse.Namespace | None = None):
        """argparse takes a word for an option by its first letter: a formula gets a space before it, which
        its type takes off again.
        """
        if self.takes_formula and args is not None:
            args = [f" {word}" if re.match(r"-(?!-|h?$)", word) else word for word in args]
        return super().parse_known_args(args, namespace)


def options(parser: argparse.ArgumentParser, text: str, **kinds) -> None:
    """Arguments as lines `NAME METAVAR: help`, each with the lines below it that are indented. kinds: of each
    by its name a type, what it may be (a tuple, list or range), or what add_argument takes; an option without
    either, and without a metavar, is true where it is there. Errors: ValueError for the kind of no option.
    """
    unused = set(kinds)
    for line in re.split(r"\n(?=\S)", text.strip()):
        head, _, words = " ".join(line.split()).partition(": ")
        name, *metavar = head.split()
        key = name.lstrip("-").replace("-", "_")
        unused.discard(key)
        kind = kinds.get(key, {})
        if isinstance(kind, (tuple, list, range)):
            kind = {"choices": kind}
        how = kind if isinstance(kind, dict) else {"type": kind}
        if metavar:
            how = {"metavar": metavar[0] if len(metavar) == 1 else tuple(metavar)} | how
        elif not how and name.startswith("-"):
            how = {"action": "store_true"}
        parser.add_argument(name, help=words.replace("%", "%%") or None, **how)
    if unused:
        raise ValueError(
            f"options: found kinds of {', '.join(sorted(unused))}; allowed: of an option of the text"
        )


def _kept_lines(text: str) -> str:
    return "\n".join(textwrap.fill(line, max(text_width(), 20)) for line in text.strip().splitlines())


def summary(row: verbs.Verb | Heading) -> str:
    """What its row says: what it does, in at most three lines of WIDTH, and an example."""
    sentence = row.help[0].upper() + row.help[1:] + ("" if row.help.endswith(("?", ".")) else ".")
    about = textwrap.fill(sentence, max(text_width(), 20))
    return f"{about}\n\nexample:\n  {row.example}"


def parser_of(name: str, doc: str | None = None, *examples: str, row: verbs.Verb | None = None) -> Parser:
    """For the arguments of a verb: its help begins with what its row says; behind the options come `doc`,
    with its lines as they are, and more examples. row: of a verb without a line of the table.
    """
    row = row or verbs.find(name)
    more = ["more examples:", *(f"  {one}" for one in examples)] if examples else []
    return Parser(
        prog=f"bench {name}",
        usage=verbs.usage_line(row),
        description=summary(row),
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="\n".join([*([_kept_lines(doc), ""] if doc else []), *more]),
    )


def color_argument(parser: argparse.ArgumentParser, choices: Iterable[str], default: str, words: str) -> None:
    """--color; --colour is taken too."""
    choices = list(choices)
    parser.add_argument("--color", choices=choices, default=default, help=f"{words} (default: {default})")
    parser.add_argument(
        "--colour", dest="color", choices=choices, default=argparse.SUPPRESS, help=argparse.SUPPRESS
    )


def bicubic_argument(parser: argparse.ArgumentParser) -> None:
    """--bicubic, of pictures in motion or still. None where it is not given."""
    parser.add_argument(
        "--bicubic",
        type=int,
        nargs=2,
        metavar=("COLUMNS", "ROWS"),
        help="bodies that are grids (mesh generator grid) with so many points, on cubic splines through their"
        " vertices",
    )


def number_type(
    allowed: str, holds: Callable[[float], bool] = lambda value: True, kind: type = float
) -> Callable[[str], float]:
    """The type of an argument that is a number, neither nan nor inf, which float() takes; `allowed` says in
    words which ones `holds` lets pass.
    """

    def read(text: str) -> float:
        try:
            value = kind(text)
        except ValueError:
            value = math.nan
        if not (math.isfinite(value) and holds(value)):
            raise argparse.ArgumentTypeError(f"found {text!r}; allowed: {allowed}")
        return value

    return read


finite_number = number_type("a finite number")
positive_number = number_type("a number above 0", lambda value: value > 0)
count_from_0 = number_type("a whole number from 0", lambda value: value >= 0, int)
count_from_1 = number_type("a whole number from 1", lambda value: value >= 1, int)


def axes_arguments(parser: argparse.ArgumentParser, of: str) -> None:
    """--scale and --up, unit and upward axis of the coordinates of `of`. None where they are not given."""
    parser.add_argument(
        "--scale",
        type=positive_number,
        metavar="M",
        help=f"m of one unit of {of}; 0.001: its coordinates are in mm (default: what USD says, else 1)",
    )
    parser.add_argument(
        "--up",
        choices=("y", "z"),
        help=f"the axis of {of} that points up, which is turned to z (default: what USD says, y of Alembic,"
        " else z)",
    )


def set_argument(parser: argparse.ArgumentParser, words: str, example: str = "/scene/n=8") -> None:
    """--set, as the program takes it; may be repeated. The values are `overrides` of what is parsed."""
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="/POINTER=VALUE",
        dest="overrides",
        help=f"{words}, e.g. {example}; may be repeated",
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
