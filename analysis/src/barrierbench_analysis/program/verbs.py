"""The table of verbs. A verb in Python is one file with `main(argv) -> exit code` and one line here; a verb
of the program is one file and one line of experiments/cli/verbs.inc, which is read here too.
"""

from __future__ import annotations

import difflib
import re
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.places import ROOT

from .verb_table import ENVIRONMENT, PROGRAM, TABLE, WITHOUT, Verb

PROGRAM_VERBS = ROOT / "experiments/cli/verbs.inc"
GROUPS = {
    "run": "records of scenes",
    "look": "at configs, records and answers",
    "study": "what costs how much, and why",
    "judge": "whether something holds",
    "make": "pages, tables and models that are kept",
    "develop": "build, test and change the code",
}

_TEXT = r'"((?:[^"\\]|\\.)*)"'
_ROW = re.compile(rf"^BB_VERB\((\w+), (\w+), {_TEXT}, {_TEXT}\)$")


def of_program(file: Path = PROGRAM_VERBS) -> tuple[Verb, ...]:
    """The verbs of the program. Errors: ValueError for a line that is neither a verb nor a comment."""
    verbs = []
    for number, line in enumerate(input_file.read_text(file).splitlines(), 1):
        if row := _ROW.match(line):
            name, group, text, example = row.groups()
            verbs.append(
                Verb(
                    name,
                    group,
                    PROGRAM,
                    "",
                    "",
                    *(re.sub(r"\\(.)", r"\1", words) for words in (text, example)),
                )
            )
        elif line and not line.startswith("//"):
            raise ValueError(
                f"{file}:{number}: found {line!r}; allowed: "
                'BB_VERB(name, group, "what it is for", "an example")'
            )
    return tuple(verbs)


def every(table: tuple[Verb, ...] = TABLE, file: Path = PROGRAM_VERBS) -> tuple[Verb, ...]:
    """Of the table and of the program; a row of the table stands for a verb of the program with its name."""
    own = {verb.name for verb in table}
    return (*(verb for verb in of_program(file) if verb.name not in own), *table)


def find(name: str, table: tuple[Verb, ...] = TABLE) -> Verb | None:
    """The row of the table; None for every other word, which goes to the program."""
    return next((verb for verb in table if verb.name == name), None)


def nearest(word: str, verbs: tuple[Verb, ...]) -> str:
    """The verb that was meant; empty without a near one."""
    return next(iter(difflib.get_close_matches(word, [verb.name for verb in verbs], 1, 0.5)), "")


def needs_program(verb: Verb, arguments: list[str]) -> bool:
    """Whether something has to be built for these arguments; an option may have its value behind a `=`."""
    return verb.needs != ENVIRONMENT and not any(
        word.split("=")[0] in (*WITHOUT, *verb.without) for word in arguments
    )
