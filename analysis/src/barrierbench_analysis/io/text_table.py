"""The one printer of tables, as plain text and as Markdown."""

import shutil
import sys
import textwrap
from collections.abc import Sequence, Set

LEAST_ROOM = 20  # characters of the last column, below which it is not broken


def _check_rows(head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Errors: ValueError for a row with more or fewer cells than the head."""
    for row in rows:
        if len(row) != len(head):
            raise ValueError(f"{len(row)} cells below {len(head)} columns: {row}")


def aligned(head: Sequence[str], rows: Sequence[Sequence[str]], right: Set[int] = frozenset()) -> list[str]:
    """Lines of a table with columns two spaces apart; those in `right` end at their right edge. Errors:
    ValueError for a row that does not fit the head.
    """
    _check_rows(head, rows)
    cells = [head, *rows]
    width = [max(len(row[i]) for row in cells) for i in range(len(head))]
    return [
        "  ".join(
            cell.rjust(w) if i in right else cell.ljust(w) for i, (cell, w) in enumerate(zip(row, width))
        ).rstrip()
        for row in cells
    ]


def fitted(head: Sequence[str], rows: Sequence[Sequence[str]], right: Set[int] = frozenset()) -> list[str]:
    """`aligned` for the standard output: where that is a terminal and too narrow, the last column, of texts,
    is broken. Errors: as aligned.
    """
    lines = aligned(head, rows, right)
    columns = shutil.get_terminal_size().columns if sys.stdout.isatty() else max(map(len, lines))
    last = max(len(row[-1]) for row in (head, *rows))
    before = max(map(len, lines)) - last
    if before + last <= columns or columns - before < LEAST_ROOM:
        return lines
    broken = []
    for line in lines:
        first, *others = textwrap.wrap(line[before:], columns - before) or [""]
        broken += [(line[:before] + first).rstrip(), *(" " * before + other for other in others)]
    return broken


def markdown(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Lines of a table in Markdown. A bar in a cell would end it: it is escaped. Errors: ValueError for a
    row that does not fit the head.
    """
    _check_rows(head, rows)

    def line(cells: Sequence[str]) -> str:
        escaped = [cell.replace("|", r"\|") for cell in cells]
        return "|" + "".join(f" {cell} |" if cell else " |" for cell in escaped)

    return [line(head), "|" + "---|" * len(head), *map(line, rows)]
