"""The settings of a config or a sweep, read from what `bench help config` prints."""

import re
from dataclasses import dataclass, field

from barrierbench_analysis.io.errors import UserError

NAME_WIDTH, DEFAULT_WIDTH = 26, 24  # columns of experiments/cli/help.cpp
INDENT = 2
TEXT = INDENT + NAME_WIDTH + 1  # column of the meaning
# How the text of what is allowed begins (core/base/parameters).
ALLOWED = re.compile(r'(?:one of |an? (?:number|integer|string|array)\b|true or false|0, or |")')
# Parts of a section that are long enough to be one.
OWN = ("scene-bodies", "scene-bodies-material", "scene-bodies-motion", "scene-bodies-pins", "scene-obstacles")
UNIT = re.compile(r" \(([^()\s]+(?: [^()\s]+)*)\)$")


@dataclass(frozen=True)
class Setting:
    """One key: texts as the program gives them; default and unit may be empty."""

    name: str
    default: str
    allowed: str
    unit: str
    meaning: str


@dataclass
class Place:
    """An object of the format at a JSON pointer, N for an element of a list."""

    pointer: str
    meaning: str
    settings: list[Setting] = field(default_factory=list)


def _default_and_allowed(rest: str) -> tuple[str, str]:
    """Both columns apart; a default that is longer than its column pushes the other one to the right."""
    default, allowed = rest[:DEFAULT_WIDTH], rest[DEFAULT_WIDTH + 1 :]
    if rest[DEFAULT_WIDTH : DEFAULT_WIDTH + 1] in ("", " ") and ALLOWED.match(allowed):
        return default.strip(), allowed
    for space in re.finditer(" ", rest[DEFAULT_WIDTH:]):
        at = DEFAULT_WIDTH + space.end()
        if ALLOWED.match(rest[at:]):
            return rest[:at].strip(), rest[at:]
    raise UserError(f"bench help: found {rest!r}; allowed: a default and what is allowed, in two columns")


def _setting(line: str, meaning: str) -> Setting:
    name = line.split()[0]
    rest = line[INDENT + max(NAME_WIDTH, len(name)) + 1 :]
    default, allowed = _default_and_allowed(rest)
    unit = UNIT.search(allowed)
    words = allowed[: unit.start()] if unit else allowed
    return Setting(name, default, words, unit[1] if unit else "", meaning)


def places(text: str) -> list[Place]:
    """Objects in the order of the help. Errors: UserError for a line that is none of them."""
    found: list[Place] = []
    lines = text.splitlines()[1:]  # the first one says what follows
    for number, line in enumerate(lines):
        if line.startswith("/"):
            pointer, _, meaning = line.partition(": ")
            found.append(Place(pointer, meaning))
        elif line.startswith(" " * INDENT) and line[INDENT] != " " and found:
            below = lines[number + 1] if number + 1 < len(lines) else ""
            meaning = below[TEXT:] if below.startswith(" " * TEXT) else ""
            found[-1].settings.append(_setting(line, meaning))
        elif line.strip() and not line.startswith(" " * TEXT):
            raise UserError(f"bench help: found {line!r}; allowed: /POINTER: TEXT, or a setting")
    return found


def section_of(pointer: str) -> str:
    """Name of the section of a pointer: its first key, or as many as a page of its own is made of."""
    keys = [key for key in pointer.split("/") if key and key != "N"]
    own = ["-".join(keys[:n]) for n in range(len(keys), 1, -1)]
    return next((name for name in own if name in OWN), keys[0] if keys else "")
