"""What ./bench starts: finds the verb, sees to what it needs, and runs it or becomes the program."""

from __future__ import annotations

import importlib
import os
import sys
import textwrap
from typing import NoReturn

from barrierbench_analysis.io.errors import TRY_AGAIN, UserError, tells
from barrierbench_analysis.program import verbs
from barrierbench_analysis.program.arguments import text_width
from barrierbench_analysis.program.start import RELEASE, become, built_program, require_program
from barrierbench_analysis.program.verb_table import HELP

HELP_WORDS = ("help", *HELP)


def usage_of(verb: verbs.Verb) -> list[str]:
    """What its row says."""
    return [
        f"  {verb.name} {verb.arguments}".rstrip(),
        *textwrap.wrap(verb.help, text_width(), initial_indent=6 * " ", subsequent_indent=6 * " "),
        f"        {verb.example}",
    ]


def usage() -> str:
    """Every verb in its group, with an example."""
    lines = ["usage: ./bench VERB [ARGUMENTS]", ""]
    for group, meaning in verbs.GROUPS.items():
        lines.append(f"{group}: {meaning}")
        for verb in verbs.every():
            if verb.group == group:
                lines += usage_of(verb)
        lines.append("")
    more = (
        "./bench VERB --help, or ./bench help VERB, says more; what runs the program is run after an"
        " incremental build, or by the program that BARRIERBENCH_PROGRAM names."
    )
    return "\n".join([*lines, *textwrap.wrap(more, text_width())])


def become_program(arguments: list[str]) -> NoReturn:
    """Replaces this process by the program, so that standard streams and signals are its own; by that of
    BARRIERBENCH_PROGRAM, where it is set, as the verbs in Python do, and nothing is built then. Errors:
    UserError where it cannot be built or started.
    """
    from barrierbench_analysis.program import building

    word = arguments[0]
    everything = verbs.every()
    if not word.startswith("-") and word not in [verb.name for verb in everything]:
        near = verbs.nearest(word, everything)
        raise UserError(
            f"found {word!r}; allowed: one of the verbs of ./bench help"
            + (f"; did you mean {near}?" if near else "")
        )
    if "BARRIERBENCH_PROGRAM" in os.environ:
        require_program()
        built = built_program()
    else:
        built = building.ensure_program()
    os.environ["BENCH_VERBS"] = " ".join(verb.name for verb in verbs.TABLE)  # for its own suggestion
    become(built, arguments)


def run(verb: verbs.Verb, arguments: list[str]) -> int:
    """Runs a verb of the table in this process."""
    from barrierbench_analysis.program import building

    if "BARRIERBENCH_PROGRAM" in os.environ:
        if verbs.needs_program(verb, arguments) and verb.needs == verbs.PROGRAM:
            require_program()
    elif verbs.needs_program(verb, arguments):
        if verb.needs == verbs.PROGRAM:
            building.ensure_program()
        else:
            building.ensure(verb.needs)
    if not verb.module:  # setup, which the script answers itself
        return building.of_script(verb.name, *arguments)
    os.environ.setdefault("BARRIERBENCH_PROGRAM", str(RELEASE))
    module = f"barrierbench_analysis.{verb.module}"  # even to load it may take a temporary file
    return tells(verb.name)(lambda words: importlib.import_module(module).main(words))(arguments)


def open_streams() -> None:
    """A stream that the shell has closed goes nowhere: else the next file that is opened would have its
    number, and what is printed. A letter that the locale has not is written as its number.
    """
    for number, (name, mode) in enumerate((("stdin", "r"), ("stdout", "w"), ("stderr", "w"))):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # the lowest free number, which is this one
            os.set_inheritable(number, True)
        if getattr(sys, name) is None:
            setattr(sys, name, open(number, mode, closefd=False))
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # of a test it has none
            stream.reconfigure(errors="backslashreplace")


def _answer(arguments: list[str]) -> int:
    if not arguments or (len(arguments) == 1 and arguments[0] in HELP_WORDS):
        print(usage())
        return 0
    if arguments == ["--version"]:
        from .version import version

        print(version())
        return 0
    if len(arguments) == 2 and arguments[0] in HELP_WORDS and verbs.find(arguments[1]):
        arguments = [arguments[1], "--help"]
    verb = verbs.find(arguments[0])
    if verb and not verb.own_help and any(word in HELP for word in arguments[1:]):
        print("\n".join(["usage: ./bench VERB [ARGUMENTS]", "", *usage_of(verb)]))
        return 0
    return run(verb, arguments[1:]) if verb else become_program(arguments)


def _forget_output() -> None:
    """What is left in the buffer goes nowhere."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def main(arguments: list[str]) -> int:
    """The exit code."""
    open_streams()
    try:
        code = _answer(arguments)
        sys.stdout.flush()
        return code
    except UserError as error:
        print(f"bench: {error}", file=sys.stderr)
        return error.code
    except BrokenPipeError:  # the reader, a pager, has seen enough
        _forget_output()
        return 0
    except OSError as error:  # of what a verb writes elsewhere it tells itself (errors.tells)
        _forget_output()
        print(f"bench: the standard output cannot be written: {error.strerror}", file=sys.stderr)
        return TRY_AGAIN
    except KeyboardInterrupt:
        print(f"bench {arguments[0]}: interrupted; it may be called again", file=sys.stderr)
        return TRY_AGAIN
