"""Tables, as plain text and as Markdown."""

from __future__ import annotations


def aligned(head: list[str], rows: list[list[str]], right: set[int] = frozenset()) -> list[str]:
    """Lines of a table with columns two spaces apart; those in `right` end at their right edge."""
    cells = [head, *rows]
    width = [max(len(row[i]) for row in cells) for i in range(len(head))]
    return [
        "  ".join(
            cell.rjust(w) if i in right else cell.ljust(w) for i, (cell, w) in enumerate(zip(row, width))
        ).rstrip()
        for row in cells
    ]


def markdown(head: list[str], rows: list[list[str]]) -> list[str]:
    """Lines of a table in Markdown."""
    return [f"| {' | '.join(head)} |", "|" + "---|" * len(head), *(f"| {' | '.join(row)} |" for row in rows)]
