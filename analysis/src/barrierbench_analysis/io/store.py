"""Stores of results: how rows are laid out, and how rows are added to those that are there."""

from collections.abc import Iterable, Sequence

from .errors import UserError


def a_line_each(texts: Iterable[str], indent: int, ends: Sequence[str] = "[]") -> str:
    """A JSON list, or an object with the ends {}, of texts that are JSON already, each on its own line."""
    pad = "\n" + " " * indent
    return f"{ends[0]}{pad}{f',{pad}'.join(texts)}{ends[1]}"


def merged(kept: list[dict], new: list[dict], key: Sequence[str], replace: bool = False) -> list[dict]:
    """The kept rows and the new ones, one a key, the kept ones first and in their places. A new row that is
    equal to a kept one changes nothing; no row but that of its key is changed by another. replace: new rows
    take the places of kept ones that have other numbers. Errors: UserError for such a row without `replace`,
    with its key and what differs.
    """
    found = {tuple(row[name] for name in key): row for row in kept}
    for row in new:
        place = tuple(row[name] for name in key)
        before = found.get(place, row)
        if before != row and not replace:
            differ = [name for name in {**before, **row} if before.get(name) != row.get(name)]
            raise UserError(
                f"{', '.join(map(str, place))}: found a row with another {', '.join(differ)} than the kept"
                " one; allowed: an equal row, or a row that replaces it"
            )
        found[place] = row
    return list(found.values())
