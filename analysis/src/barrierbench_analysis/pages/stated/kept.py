"""What the kept data of results/ say of the numbers that pages state: how many runs each study has, the cells
of the gap map, and its tables by size.
"""

from collections.abc import Iterator
from pathlib import Path

from barrierbench_analysis.studies.gap_map import size_page
from barrierbench_analysis.studies.gap_map import table as map_table
from barrierbench_analysis.studies.gap_map.judge import counts
from barrierbench_analysis.studies.gap_map.rows import CANNOT, NO_CONTACT, NOT_RUN

from . import cost
from .counted import CELLS, OF_CELLS, STUDIES
from .pages import pair
from .statement import Statement

MAP = "gap_map.json"


def kept(results: Path) -> Iterator[Statement]:
    """Of the files that are there. Errors: UserError for one that cannot be read."""
    for row in cost.gather(results):
        yield Statement(f"kept data of {row['study']}", STUDIES[row["study"]], "", str(row["runs"]))
    if (results / MAP).is_file():
        found = map_table.read(results / MAP)
        n = counts(found.rows)
        ends = (n["ok"], n[CANNOT], n[NO_CONTACT], n["failed"], n[NOT_RUN])
        for quantity, number in zip((CELLS, *OF_CELLS), (n["cells"], *ends)):
            yield Statement(MAP, quantity, "", str(number))
        yield from pair("\n".join([*size_page.pair_section(found), *size_page.section(found)]), MAP)
