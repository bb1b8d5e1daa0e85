"""What the kept data of results/ say of the numbers that pages state: how many runs each study has, the cells
of the gap map, and its tables by size.
"""

from collections.abc import Iterator
from pathlib import Path

from barrierbench_analysis.studies.rules.gap_map import size_tables
from barrierbench_analysis.studies.rules.gap_map.table import CANNOT, NO_CONTACT, NOT_RUN, kept_map
from barrierbench_analysis.tables.outcomes import OK

from . import cost
from .counted import CELLS, OF_CELLS, STUDIES
from .pages import pair
from .statement import Statement

MAP = "studies/gap_map.jsonl"


def kept(results: Path) -> Iterator[Statement]:
    """Of the files that are there. Errors: UserError for one that cannot be read."""
    for row in cost.gather(results):
        yield Statement(f"kept data of {row['study']}", STUDIES[row["study"]], "", str(row["runs"]))
    if (results / MAP).is_file():
        found = kept_map(results / MAP)
        n = found.counts()
        ends = (n[OK], n[CANNOT], n[NO_CONTACT], n["failed"], n[NOT_RUN])
        for quantity, number in zip((CELLS, *OF_CELLS), (n["cells"], *ends)):
            yield Statement(MAP, quantity, "", str(number))
        pairs = [f"## {size_tables.PAIR_TITLE}", "", *size_tables.pair_table(found), ""]
        sizes = [*size_tables.size_table(found), "", *size_tables.slope_table(found)]
        yield from pair("\n".join([*pairs, f"## {size_tables.SIZE_TITLE}", "", *sizes]), MAP)
