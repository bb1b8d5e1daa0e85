"""The full sizes of the scenes beside the counts that their sources publish: results/catalogue_sizes.json and
results/CATALOGUE_SIZES.md.
"""

from __future__ import annotations

import json
import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from barrierbench_analysis.io.json_file import read_of_schema
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.progress import counted

from .counts import counts_of
from .entry import FULL, Entry, entries

FILE, PAGE = ROOT / "results" / "catalogue_sizes.json", ROOT / "results" / "CATALOGUE_SIZES.md"
NAME = "barrierbench.catalogue_sizes/1"
KINDS = ("vertices", "faces", "tetrahedra", "segments")
WITHIN = 0.1
LARGE = 500_000  # vertices, from which on a scene is built only where it is named


def built(asked: list[Entry]) -> dict[str, dict[str, int]]:
    """Scene -> the counts that the program builds; of one that is LARGE those that it states, which the
    test of its generator holds. Errors: UserError. Cost: seconds a scene.
    """

    def one(entry: Entry) -> dict[str, int]:
        stated = entry.data[FULL]
        if stated.get("vertices", 0) > LARGE:
            return {kind: stated[kind] for kind in KINDS if kind in stated}
        found = counts_of(entry, FULL)
        return {kind: value for kind in KINDS if (value := found.of(kind))}

    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        found = list(counted(pool.map(one, asked), len(asked), "sizes: built"))
    return {entry.name: counts for entry, counts in zip(asked, found, strict=True)}


def ratios(entry: Entry, own: dict[str, int]) -> dict[str, float]:
    """Own over published, of each count that the source publishes."""
    published = entry.data["source_counts"]
    return {kind: own.get(kind, 0) / published[kind] for kind in KINDS if kind in published}


def complaint(entry: Entry, own: dict[str, int]) -> str:
    """What is wrong with a scene: a count that is off without a reason, or a reason without such a count."""
    off = {kind: r for kind, r in ratios(entry, own).items() if abs(r - 1) > WITHIN}
    has_reason = "because" in entry.data["source_counts"]
    if off and not has_reason:
        kind, ratio = next(iter(off.items()))
        where = f"{entry.path}#/source_counts"
        return f"{where}: {kind} are {ratio:.3g} times those of the source, without `because`"
    if has_reason and not off and ratios(entry, own):
        return f"{entry.path}#/source_counts/because: every count is within 10 % of the source's"
    return ""


def _cell(entry: Entry, own: dict[str, int], kind: str) -> str:
    published, mine = entry.data["source_counts"].get(kind), own.get(kind)
    if published is None:
        return f"{mine:,}" if mine else ""
    ratio = (mine or 0) / published
    text = f"{mine or 0:,} of {published:,}: {ratio:.3g}"
    return text if abs(ratio - 1) <= WITHIN else f"**{text}**"


def markdown_page(asked: list[Entry], kept: dict[str, dict[str, int]]) -> str:
    rows = [
        [
            entry.name,
            *(_cell(entry, kept[entry.name], kind) for kind in KINDS),
            entry.data["source_counts"].get("because", ""),
        ]
        for entry in asked
        if entry.name in kept
    ]
    compared = [ratios(entry, kept[entry.name]) for entry in asked if entry.name in kept]
    counts = [ratio for one in compared for ratio in one.values()]
    near = sum(abs(ratio - 1) <= WITHIN for ratio in counts)
    whole = sum(bool(one) and all(abs(r - 1) <= WITHIN for r in one.values()) for one in compared)
    sources = sorted({entry.data["source_counts"]["of"] for entry in asked})
    return "\n".join(
        [
            "# Sizes of the catalogue",
            "",
            (
                "Written by `./bench scenes --sizes`. Counts of every scene at the size `full`, as the"
                " program builds it, of those that its source publishes, and their ratio; of scenes of more"
                f" than {LARGE:,} vertices the counts that the scene states. {near} of {len(counts)}"
                f" published counts are met within 10 %, all of them in {whole} of the"
                f" {sum(map(bool, compared))} scenes whose source publishes counts; a ratio farther off is"
                " bold, and the last column has the reason. A published count is rounded to 100, and may be"
                " of another version of the scene than the one that is rebuilt."
            ),
            "",
            "Sources: " + "; ".join(sources) + ".",
            "",
            *markdown(["scene", *KINDS, "why a count is another"], rows),
            "",
        ]
    )


def read(file: Path = FILE) -> dict[str, dict[str, int]]:
    return read_of_schema(file, NAME)["scenes"]


def write(kept: dict[str, dict[str, int]]) -> None:
    lines = ",\n".join(f"  {json.dumps(name)}: {json.dumps(counts)}" for name, counts in sorted(kept.items()))
    write_whole(FILE, f'{{\n "schema": "{NAME}",\n "scenes": {{\n{lines}\n }}\n}}\n')


def page() -> str:
    """Of what is kept."""
    return markdown_page(entries([]), read())
