"""Every number of a page with what it is of, whatever the page: a cell of a table by its heads and the names
of its row, a number in a sentence by its heading and the words around it. So a number
that stands on one page twice, with the same words under the same heading, is the same number, or is told.
What is said in other words, or elsewhere, needs a reader of its own (pages.py).
"""

import re
from collections.abc import Iterator

from .statement import Statement, cells_of

# Heads of columns of numbers that name a row and measure nothing.
NAMING = {
    *("theta", "dt, ms", "reached gap", "unknowns", "of", "day", "driver", "SM clock, MHz at most", "commit"),
    *("card", "shape", "study", "conditions", "scenes, unknowns", "relation", "case", "scene", "level"),
    *("effect", "against", "module and line", "what", "old", "new", "why"),
}
A_NUMBER = re.compile(r"[+-]?\d[\d.,]*(?:e[+-]?\d+)?")
SENTENCE_END = re.compile(r"(?<=[.!?])\s+(?=[A-Z`*\[(])")
# Pages whose sentences have readers of their own.
ELSEWHERE = (
    "results/CLAIMS.csv",
    "results/CLAIMS.md",
    "results/ENGINES.md",
    "results/ENGINES_SIZE.md",
    "results/ENGINES_RODS.md",
)
ABOUT = 40  # characters of an item that say what it is of
FEWEST_WORDS = 5  # of a sentence: `10 of 10` alone is of what stands before it


def _naming(heads: list[str], rows: list[list[str]]) -> list[bool]:
    """Of each column whether it names a row: the first one, those behind it up to the first that measures
    something, and those that are known to name."""
    names, leading = [], True
    for k, head in enumerate(heads):
        measured = any(A_NUMBER.search(row[k]) for row in rows if k < len(row))
        leading = k == 0 or (leading and (not measured or head in NAMING))
        names.append(leading or head in NAMING)
    return names


def _blocks(text: str) -> Iterator[tuple[str, list[str]]]:
    """Heading and the lines of each paragraph, list item, table or block of code below it."""
    title, lines = "", []
    for line in [*re.sub(r"(?ms)^```.*?^```$", "", text).splitlines(), ""]:
        begins = re.match(r"\s*(?:[-*] |\d+\. )", line)
        apart = bool(lines) and lines[-1].startswith("|") != line.startswith("|")
        if lines and (not line.strip() or line.startswith("#") or begins or apart):
            yield title, lines
            lines = []
        if line.startswith("#"):
            title = line.lstrip("# ")
        elif line.strip():
            lines.append(line)


def _of_table(place: str, lines: list[str]) -> Iterator[Statement]:
    heads, *rows = [cells_of(line) for line in lines if not line.startswith("|---")]
    heads = [
        f"{head} {heads[:n].count(head) + 1}" if head in heads[:n] else head for n, head in enumerate(heads)
    ]
    names, above = _naming(heads, rows), ""
    for row in rows:
        row[0] = above = row[0] or above  # an empty name is that of the row above
        row_name = ", ".join(cell for cell, is_name in zip(row, names) if is_name)
        for head, cell, is_name in zip(heads, row, names):
            if not is_name and A_NUMBER.search(cell):
                yield Statement(place, f"{place}: {head}", row_name, cell)


def _of_text(place: str, lines: list[str]) -> Iterator[Statement]:
    """What an item of a list is about stands at its beginning."""
    text = " ".join(" ".join(lines).split())
    if re.match(r"[-*] |\d+\. ", text):
        place = f"{place}, {A_NUMBER.sub('#', text)[:ABOUT]}"
    for sentence in SENTENCE_END.split(text):
        numbers, words = A_NUMBER.findall(sentence), A_NUMBER.sub("#", sentence)
        if numbers and len(re.findall(r"[A-Za-z_]{2,}", words)) >= FEWEST_WORDS:
            yield Statement(place, f"{place}: {words}", "", " ".join(numbers))


def everything(text: str, page: str) -> Iterator[Statement]:
    """Two tables of one section are two things, even with the same heads."""
    tables: dict[str, int] = {}
    for title, lines in _blocks(text):
        place = f"{page}, {title}" if title else page
        if lines[0].startswith("|"):
            tables[place] = tables.get(place, 0) + 1
            yield from _of_table(f"{place}, table {tables[place]}", lines)
        elif page not in ELSEWHERE:
            yield from _of_text(place, lines)
