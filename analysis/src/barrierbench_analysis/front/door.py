"""What ./bench starts: finds the verb, sees to what it needs, and runs it or becomes the program."""

import importlib
import os
import sys
import textwrap
from typing import NoReturn

from barrierbench_analysis.io.errors import TRY_AGAIN, UserError, reported
from barrierbench_analysis.program import verbs
from barrierbench_analysis.program.arguments import summary, text_width
from barrierbench_analysis.program.start import RELEASE, become, built_program, require_program
from barrierbench_analysis.program.verb_table import HELP, Heading

HELP_WORDS = ("help", *HELP)
OF_PROGRAM = (["sweep"], ["help"])  # behind a word of HELP_WORDS: the program explains the files, or itself


COLUMN = 16  # of what a verb is for, in the list of all


def _listed(name: str, words: str) -> list[str]:
    """A name and what it is for, beside each other."""
    indent = COLUMN * " "
    how = {"initial_indent": indent, "subsequent_indent": indent, "break_on_hyphens": False}
    lines = textwrap.wrap(words, text_width(), **how)
    return [f"  {name}".ljust(COLUMN) + lines[0][COLUMN:], *lines[1:]]


def usage() -> str:
    """Every verb in its group; of a heading its sub-commands by name."""
    lines = ["usage: ./bench VERB [OPTIONS]", ""]
    for group, meaning in verbs.GROUPS.items():
        lines.append(f"{group}: {meaning}")
        for row in verbs.top():
            if row.group == group:
                names = (
                    [verb.name.split()[1] for verb in verbs.below(row)] if isinstance(row, Heading) else []
                )
                lines += _listed(row.name, f"{row.help}: {', '.join(names)}" if names else row.help)
        lines.append("")
    more = (
        "./bench VERB --help, or ./bench help VERB, says more and has an example; what runs the program is"
        " run"
        " after an incremental build, or by the program that BARRIERBENCH_PROGRAM names."
    )
    return "\n".join([*lines, *textwrap.wrap(more, text_width())])


def help_of(row: verbs.Verb | Heading) -> str:
    """What the rows say: of a heading its sub-commands too."""
    lines = [f"usage: {verbs.usage_line(row)}", "", summary(row)]
    if isinstance(row, Heading):
        rows = verbs.below(row)
        column = max(len(verb.name) for verb in rows) - len(row.name) + 3
        lines += ["", f"./bench {row.name} NAME --help says more:"]
        for verb in rows:
            words = textwrap.wrap(verb.help, max(text_width() - column, 20))
            lines += [
                f"  {verb.name.split()[1]}".ljust(column) + words[0],
                *(column * " " + one for one in words[1:]),
            ]
    return "\n".join(lines)


def become_program(arguments: list[str]) -> NoReturn:
    """Replaces this process by the program, so that standard streams and signals are its own; by that of
    BARRIERBENCH_PROGRAM, where it is set, as the verbs in Python do, and nothing is built then. Errors:
    UserError where it cannot be built or started.
    """
    from barrierbench_analysis.program import building

    if "BARRIERBENCH_PROGRAM" in os.environ:
        require_program()
        built = built_program()
    else:
        built = building.ensure_program()
    os.environ["BENCH_VERBS"] = " ".join(row.name for row in verbs.top())  # for its own suggestion
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
    return reported(verb.name)(lambda words: importlib.import_module(module).main(words))(
        [verb.subject, *arguments] if verb.subject else arguments
    )


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
    if arguments[0] in HELP_WORDS and arguments[1:] not in OF_PROGRAM:
        call = verbs.call_of(arguments[1:])
        if call and not call.rest:
            arguments = [*arguments[1:], "--help"]
        elif call is None and arguments[0] in HELP and not arguments[1].startswith("-"):
            arguments = arguments[1:]  # the help of a word that is no verb
    call = verbs.call_of(arguments)
    if call is None:
        if not arguments[0].startswith("-"):
            raise UserError(
                f"found {arguments[0]!r}; allowed: one of the verbs of ./bench"
                f" help{verbs.nearest(arguments[0])}"
            )
        return become_program(arguments)
    row, rest, note = call
    if note:
        print(f"bench: note: {note}", file=sys.stderr, flush=True)
    if isinstance(row, Heading):
        if wrong := [word for word in rest if word not in HELP]:
            allowed = f"allowed: a sub-command (./bench {row.name} --help lists them)"
            raise UserError(f"{row.name}: found {wrong[0]!r}; {allowed}")
        print(help_of(row))
        return 0
    if not row.own_help and any(word in HELP for word in rest):
        print(help_of(row))
        return 0
    return become_program([row.word, *rest]) if row.word else run(row, rest)


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
        call = verbs.call_of(arguments) if arguments else None
        print(
            f"bench {call.row.name if call else arguments[0]}: interrupted; it may be called again",
            file=sys.stderr,
        )
        return TRY_AGAIN
