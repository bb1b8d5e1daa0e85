"""The fields of a record or of a line of a trace, read from what `bench help record` prints."""

from dataclasses import dataclass

from barrierbench_analysis.io.errors import UserError


@dataclass(frozen=True)
class Field:
    """One field by its dotted name; `[]` is an element of a list, `*` any name. The unit may be empty."""

    name: str
    unit: str
    meaning: str


def fields(text: str) -> list[Field]:
    """Fields in the order of the help. Errors: UserError for a line without a name and a meaning."""
    lines = [line for line in text.splitlines() if line.strip()]
    if short := [line for line in lines if len(line.split(None, 1)) < 2]:
        raise UserError(f"bench help: found {short[0]!r}; allowed: a name, its unit, its meaning")
    unit_at = max(len(line.split()[0]) for line in lines) + 1
    meaning_at = lines[0].index(lines[0].split(None, 1)[1])  # the first field has no unit
    return [
        Field(line.split()[0], line[unit_at:meaning_at].strip(), line[meaning_at:].strip()) for line in lines
    ]


def section_of(name: str) -> str:
    """The first key of a dotted name, without the mark of a list."""
    return name.partition(".")[0].removesuffix("[]")
