"""What a page states, and the tables and sentences that it states it in."""

import re
from collections.abc import Iterator
from dataclasses import dataclass


@dataclass(frozen=True)
class Statement:
    """page: file and place in it. verdict: None where the page states a number and decides nothing."""

    page: str
    quantity: str
    conditions: str
    number: str
    verdict: str | None = None


def cells_of(line: str) -> list[str]:
    """Of a row of a table; an escaped bar is a part of its cell."""
    found = re.split(r"(?<!\\)\|", line.strip().removeprefix("|").removesuffix("|"))
    return [cell.strip().replace(r"\|", "|") for cell in found]


def tables(text: str) -> Iterator[tuple[str, list[str], list[str]]]:
    """Title above, heads and cells of every row of every table."""
    title, heads = "", None
    for line in text.splitlines():
        if line.startswith("#"):
            title, heads = line.lstrip("# "), None
        elif line.startswith("|"):
            if heads is None:
                heads = cells_of(line)
            elif not line.startswith("|---"):
                yield title, heads, cells_of(line)
        else:
            heads = None


def section(text: str, title: str) -> str:
    """What stands below a heading of the second order."""
    _, _, rest = text.partition(f"\n## {title}\n")
    return re.split(r"\n## ", rest)[0]
