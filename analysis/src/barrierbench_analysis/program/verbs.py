"""The table of verbs, and which row a command line is for. A verb or sub-command in Python is one file with
`main(argv) -> exit code` and one line of verb_table.py; one of the program is one file and one line of
experiments/cli/verbs.inc, which is read here too.
"""

import difflib
import re
from pathlib import Path
from typing import NamedTuple

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.places import ROOT

from .verb_table import (
    ENVIRONMENT,
    HEADINGS,
    PAGE,
    PLAN,
    PROGRAM,
    RENAMED,
    RUN,
    STUDIES_BEFORE,
    TABLE,
    WITHOUT,
    Heading,
    Verb,
)

PROGRAM_VERBS = ROOT / "experiments/cli/verbs.inc"
SPECS = ROOT / "configs/studies"
GROUPS = {
    "run": "records of scenes",
    "look": "at configs, formulas and what there is",
    "study": "what costs how much, and why",
    "judge": "whether something holds",
    "make": "figures, pages and files from records and scenes",
    "develop": "build, test and change the code",
}
KIT = "studies.kit.study.verb"  # of every study of configs/studies
MODES = ("run", "plan", "page")  # words behind the name of a study

_TEXT = r'"((?:[^"\\]|\\.)*)"'
_ROW = re.compile(rf"^BB_VERB\((\w+), (\w+), {_TEXT}, {_TEXT}, {_TEXT}\)$")


class Call(NamedTuple):
    """What a command line is for."""

    row: Verb | Heading
    rest: list[str]  # the words behind the name
    note: str = ""  # of an old name: what it is now


def of_program(file: Path = PROGRAM_VERBS) -> tuple[Verb, ...]:
    """The verbs of the program. Errors: ValueError for a line that is neither a verb nor a comment."""
    verbs = []
    for number, line in enumerate(input_file.read_text(file).splitlines(), 1):
        if row := _ROW.match(line):
            word, group = row[1].replace("_", "-"), row[2]
            name, text, example = (re.sub(r"\\(.)", r"\1", words) for words in row.groups()[2:])
            was = next((old for old, now in RENAMED.items() if now == name), word if word != name else "")
            verbs.append(Verb(name, group, PROGRAM, "", "", text, example, was, word=word))
        elif line and not line.startswith("//"):
            raise ValueError(
                f"{file}:{number}: found {line!r}; allowed: "
                'BB_VERB(word, group, "name", "what it is for", "an example")'
            )
    return tuple(verbs)


def of_spec(file: Path) -> Verb:
    """The study of a spec: no line of the table is needed. A spec that cannot be read says so when it
    runs."""
    word = file.stem.replace("_", "-")
    command = f"./bench study {word if file.parent == SPECS else file} run"
    try:
        text = str(read_object(file).get("question", file))
    except UserError:
        text = str(file)
    return Verb(
        f"study {word}",
        "study",
        PROGRAM,
        KIT,
        "",
        text,
        command,
        was=word if word in STUDIES_BEFORE and file.parent == SPECS else "",
        modes=(RUN, PLAN, PAGE),
        without=("--plan",),
        subject=str(file),
    )


def every(table: tuple[Verb, ...] = TABLE, file: Path = PROGRAM_VERBS) -> tuple[Verb, ...]:
    """Of the program, of the table and of configs/studies; a row of the table stands for a verb of the
    program with its name."""
    own = {verb.name for verb in table}
    specs = map(of_spec, sorted(SPECS.glob("*.json")))
    return (*(verb for verb in of_program(file) if verb.name not in own), *table, *specs)


def top() -> tuple[Verb | Heading, ...]:
    """What can stand directly behind ./bench, in the order of the help."""
    rows = [*(verb for verb in every() if " " not in verb.name), *HEADINGS]
    return tuple(sorted(rows, key=lambda row: list(GROUPS).index(row.group)))


def below(heading: Heading) -> tuple[Verb, ...]:
    """Its sub-commands."""
    return tuple(verb for verb in every() if verb.name.startswith(f"{heading.name} "))


def find(name: str, table: tuple[Verb, ...] = TABLE) -> Verb | None:
    """The row of the table; None for every other name: that of a verb of the program, or of none."""
    return next((verb for verb in table if verb.name == name), None)


def call_of(words: list[str]) -> Call | None:
    """The row that the words begin with, by its name now or the one before; a heading where only its name or
    an option stands. None where they begin with none. Errors: UserError for a sub-command that is none.
    """
    rows, first, second = every(), words[0], words[1] if len(words) > 1 else ""
    if heading := next((one for one in HEADINGS if one.name == first), None):
        if verb := next((verb for verb in rows if verb.name == f"{first} {second}"), None):
            return Call(verb, _without_mode(verb, words[2:]))
        if first == "study" and second.endswith(".json"):
            verb = of_spec(Path(second))
            return Call(verb, _without_mode(verb, words[2:]))
        if len(words) > 1 and not second.startswith("-"):
            _refuse(heading, second)
        if heading.default and second not in ("-h", "--help"):
            return call_of([first, heading.default, *words[1:]])
        return Call(heading, words[1:])
    if verb := next((verb for verb in rows if verb.name == first), None):
        return Call(verb, words[1:])
    if verb := next((verb for verb in rows if verb.was == first), None):
        return Call(verb, words[1:], f'"{first}" is now "./bench {verb.name}"')
    return None


def _refuse(heading: Heading, word: str) -> None:
    names = [verb.name.split()[1] for verb in below(heading)]
    before = {verb.was: verb.name.split()[1] for verb in below(heading)}
    near = _near(word, before | {name: name for name in names})
    raise UserError(f"{heading.name}: found {word!r}; allowed: {', '.join(names)}{near}")


def _without_mode(verb: Verb, rest: list[str]) -> list[str]:
    """The first word of what follows a study as the option that it stands for; a file of its name stays one
    where the study has no such mode. Errors: UserError.
    """
    modes = dict(verb.modes)
    if not rest or verb.group != "study" or rest[0] not in MODES:
        return rest
    if rest[0] in modes:
        return [option for option in (modes[rest[0]],) if option] + rest[1:]
    if Path(rest[0]).exists():
        return rest
    raise UserError(
        f"{verb.name}: found {rest[0]!r}; allowed: {' or '.join(modes) or verb.arguments or 'options'}"
    )


def _near(word: str, names: dict[str, str]) -> str:
    """`; did you mean NAME?` for the near one of `names` (what may be written -> the name); empty without
    a near one.
    """
    found = difflib.get_close_matches(word, [name for name in names if name], 1, 0.5)
    return f"; did you mean {names[found[0]]}?" if found else ""


def nearest(word: str) -> str:
    """What was meant by a word that is no verb, as `_near`."""
    rows = every()
    names = {name: verb.name for verb in rows for name in (verb.was, verb.name.split()[-1])}
    return _near(word, names | {row.name: row.name for row in (*rows, *HEADINGS)})


def renewed(text: str) -> str:
    """A text that is kept, of a record or a claim, with the names now of the verbs that it names."""
    now = {verb.was: verb.name for verb in every() if verb.was}
    old = "|".join(sorted(map(re.escape, now), key=len, reverse=True))
    return re.sub(rf"(\./bench )({old})(?![\w-])", lambda match: match[1] + now[match[2]], text)


def usage_line(row: Verb | Heading) -> str:
    """`bench NAME ...`, without the options by name."""
    if isinstance(row, Heading):
        one = f"[{'|'.join(verb.name.split()[1] for verb in below(row))}]" if row.default else "NAME"
        return f"bench {row.name} {one} [OPTIONS]"
    modes = f"[{'|'.join(name for name, _ in row.modes)}]" if row.modes else ""
    return " ".join(word for word in (f"bench {row.name}", modes, "[OPTIONS]", row.arguments) if word)


def needs_program(verb: Verb, arguments: list[str]) -> bool:
    """Whether something has to be built for these arguments; an option may have its value behind a `=`."""
    return verb.needs != ENVIRONMENT and not any(
        word.split("=")[0] in (*WITHOUT, *verb.without) for word in arguments
    )
