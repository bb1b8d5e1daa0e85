"""The answer of a folder (tables/answer.py) as a table of the page, and as lines for a terminal."""

import textwrap

from barrierbench_analysis.figures.style import look
from barrierbench_analysis.io.text_table import aligned
from barrierbench_analysis.tables.answer import HEAD, Answer, answer, when_to_use

from .gather import Folder
from .tables import Cell, Column, Table

WIDTH = 100  # of a terminal
NAME_WIDTH = 26  # of the first column there
NUMBERS = range(2, len(HEAD) - 1)  # columns of numbers


def of(folder: Folder) -> Answer:
    return answer(folder.rows.values())


def table(found: Answer) -> Table:
    rows = []
    for line in found.lines:
        first, *others = line.cells()
        rows.append([Cell(first, colour=look(line.formulation).color), *map(Cell, others)])
    columns = [Column(heading, is_number=k in NUMBERS) for k, heading in enumerate(HEAD)]
    beside = f", beside {found.reference}" if found.reference else ""
    return Table("answers", f"What each formulation takes{beside}", columns, rows, is_cards=True)


def _broken(cells: list[str]) -> list[list[str]]:
    """The lines of a row whose first cell is broken at NAME_WIDTH."""
    first, *others = textwrap.wrap(cells[0], NAME_WIDTH)
    return [[first, *cells[1:]], *([more, *[""] * (len(cells) - 1)] for more in others)]


def lines(found: Answer) -> list[str]:
    """The same for a terminal of WIDTH columns: when to use what stands below the table."""
    rows = [row for line in found.lines for row in _broken(line.cells()[:-1])]
    shown = aligned(HEAD[:-1], rows, right=set(NUMBERS))
    shown.append("")
    for note in found.notes():
        shown += textwrap.wrap(note, WIDTH)
    shown.append("")
    for line in found.lines:
        if sentence := when_to_use(line.name):
            shown += textwrap.wrap(f"{line.name}: {sentence}", WIDTH, subsequent_indent="  ")
    return shown
