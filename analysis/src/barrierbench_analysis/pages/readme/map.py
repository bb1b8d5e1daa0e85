"""The sentences of the gap map that README shows, from results/gap_map.json."""

import textwrap
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.studies.gap_map.judge import counts
from barrierbench_analysis.studies.gap_map.report import sentences
from barrierbench_analysis.studies.gap_map.rows import NOT_RUN
from barrierbench_analysis.studies.gap_map.table import read

FILE = ROOT / "results" / "gap_map.json"


def gather(file: Path = FILE) -> list[str]:
    """Errors: UserError where the kept map cannot be read."""
    try:
        found = read(file)
    except (UserError, OSError) as error:
        raise UserError(f"{file}: {error}; ./bench study gap-map --quick makes one") from error
    n, (low, high) = counts(found.rows), found.about["unknowns"]
    of = (
        f"Of {n['cells']} cells {n['cells'] - n[NOT_RUN]} are decided, with {found.about['runs']} runs of"
        f" {low} to {high} unknowns"
    )
    return [
        *sentences(found),
        of + (f"; {n[NOT_RUN]} are not run yet, most of them of the larger scenes." if n[NOT_RUN] else "."),
    ]


def lines(found: list[str], width: int) -> list[str]:
    return [line for text in found for line in textwrap.wrap(f"- {text}", width, subsequent_indent="  ")]
