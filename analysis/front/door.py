"""What ./bench starts: finds the verb, sees to what it needs, and runs it or becomes the program."""

from __future__ import annotations

import importlib
import os
import sys
import textwrap
from typing import NoReturn

from ..errors import TRY_AGAIN, UserError
from ..program import RELEASE, become, built_program
from . import verbs
from .table import HELP

WIDTH = 116


def usage_of(verb: verbs.Verb) -> list[str]:
    """What its row says."""
    return [
        f"  {verb.name} {verb.arguments}".rstrip(),
        *textwrap.wrap(verb.help, WIDTH, initial_indent=6 * " ", subsequent_indent=6 * " "),
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
    lines.append(
        "./bench VERB --help says more; what runs the program is run after an incremental build, or by the"
        " program that BARRIERBENCH_PROGRAM names."
    )
    return "\n".join(lines)


def become_program(arguments: list[str]) -> NoReturn:
    """Replaces this process by the program, so that standard streams and signals are its own; by that of
    BARRIERBENCH_PROGRAM, where it is set, as the verbs in Python do, and nothing is built then. Errors:
    UserError where it cannot be built or started.
    """
    from . import building

    word = arguments[0]
    everything = verbs.every()
    if not word.startswith("-") and word not in [verb.name for verb in everything]:
        near = verbs.nearest(word, everything)
        raise UserError(
            f"found {word!r}; allowed: one of the verbs of ./bench help"
            + (f"; did you mean {near}?" if near else "")
        )
    built = built_program() if "BARRIERBENCH_PROGRAM" in os.environ else building.ensure_program()
    os.environ["BENCH_VERBS"] = " ".join(verb.name for verb in verbs.TABLE)  # for its own suggestion
    become(built, arguments)


def run(verb: verbs.Verb, arguments: list[str]) -> int:
    """Runs a verb of the table in this process."""
    from . import building

    if verbs.needs_program(verb, arguments) and "BARRIERBENCH_PROGRAM" not in os.environ:
        if verb.needs == verbs.PROGRAM:
            building.ensure_program()
        else:
            building.ensure(verb.needs)
    os.environ.setdefault("BARRIERBENCH_PROGRAM", str(RELEASE))
    return importlib.import_module(f"analysis.{verb.module}").main(arguments)


def main(arguments: list[str]) -> int:
    """The exit code."""
    try:
        if not arguments or arguments in (["help"], ["-h"], ["--help"]):
            print(usage(), flush=True)
            return 0
        verb = verbs.find(arguments[0])
        if verb and not verb.own_help and any(word in HELP for word in arguments[1:]):
            print("\n".join(["usage: ./bench VERB [ARGUMENTS]", "", *usage_of(verb)]), flush=True)
            return 0
        return run(verb, arguments[1:]) if verb else become_program(arguments)
    except UserError as error:
        print(f"bench: {error}", file=sys.stderr)
        return error.code
    except BrokenPipeError:  # the reader, a pager, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt:
        print(f"bench {arguments[0]}: interrupted; it may be called again", file=sys.stderr)
        return TRY_AGAIN
