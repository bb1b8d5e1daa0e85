"""The sentences of the gap map that README shows, from results/studies/gap_map.jsonl."""

from __future__ import annotations

import textwrap

from barrierbench_analysis.studies.rules.gap_map.page import sentences
from barrierbench_analysis.studies.rules.gap_map.table import NOT_RUN, Map


def gather(found: Map) -> list[str]:
    n, (low, high) = found.counts(), found.unknowns
    of = (
        f"Of {n['cells']} cells {n['cells'] - n[NOT_RUN]} are decided, with {len(found.made)} runs of"
        f" {low} to {high} unknowns"
    )
    return [
        *sentences(found),
        of + (f"; {n[NOT_RUN]} are not run yet, most of them of the larger scenes." if n[NOT_RUN] else "."),
    ]


def lines(found: list[str], width: int) -> list[str]:
    return [line for text in found for line in textwrap.wrap(f"- {text}", width, subsequent_indent="  ")]
