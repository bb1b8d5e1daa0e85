"""The full sizes of the scenes beside the counts that their sources publish: results/catalogue_sizes.json and
results/CATALOGUE_SIZES.md.
"""

import json
from pathlib import Path

from barrierbench_analysis.io.json_file import read_of_schema
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.store import a_line_each
from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.io.whole_file import write_whole

from .counts import KINDS, LARGE, counts_of, each_built, is_large
from .entry import FULL, Entry, entries

FILE, PAGE = ROOT / "results" / "catalogue_sizes.json", ROOT / "results" / "CATALOGUE_SIZES.md"
NAME = "barrierbench.catalogue_sizes/1"
WITHIN = 0.1


def _built(entry: Entry) -> dict[str, int]:
    counts = entry.data[FULL] if is_large(entry, FULL) else counts_of(entry, FULL)
    return {kind: counts[kind] for kind in KINDS if counts.get(kind)}


def built(chosen: list[Entry]) -> dict[str, dict[str, int]]:
    """Scene -> the counts that the program builds; of one that is LARGE those that it states, which the
    test of its generator holds. Errors: UserError. Cost: seconds a scene.
    """
    return dict(zip([entry.name for entry in chosen], each_built(_built, chosen, "sizes"), strict=True))


def ratios(entry: Entry, own: dict[str, int]) -> dict[str, float]:
    """Own over published, of each count that the source publishes."""
    published = entry.data["source_counts"]
    return {kind: own.get(kind, 0) / published[kind] for kind in KINDS if kind in published}


def _is_near(ratio: float) -> bool:
    return abs(ratio - 1) <= WITHIN


def complaint(entry: Entry, own: dict[str, int]) -> str:
    """What is wrong with a scene: a count that is off without a reason, or a reason without such a count."""
    found, where = ratios(entry, own), f"{entry.path}#/source_counts"
    off = {kind: ratio for kind, ratio in found.items() if not _is_near(ratio)}
    has_reason = "because" in entry.data["source_counts"]
    if off and not has_reason:
        kind, ratio = next(iter(off.items()))
        return f"{where}: {kind} are {ratio:.3g} times those of the source, without `because`"
    if has_reason and found and not off:
        return f"{where}/because: every count is within 10 % of the source's"
    return ""


def _cell(entry: Entry, own: dict[str, int], kind: str) -> str:
    published, mine = entry.data["source_counts"].get(kind), own.get(kind, 0)
    if published is None:
        return f"{mine:,}" if mine else ""
    text = f"{mine:,} of {published:,}: {mine / published:.3g}"
    return text if _is_near(mine / published) else f"**{text}**"


def markdown_page(chosen: list[Entry], kept: dict[str, dict[str, int]]) -> str:
    here = [(entry, kept[entry.name]) for entry in chosen if entry.name in kept]
    rows = []
    for entry, own in here:
        why = entry.data["source_counts"].get("because", "")
        rows.append([entry.name, *(_cell(entry, own, kind) for kind in KINDS), why])
    compared = [list(found.values()) for entry, own in here if (found := ratios(entry, own))]
    counts = [ratio for one in compared for ratio in one]
    sources = sorted({entry.data["source_counts"]["of"] for entry in chosen})
    head = (
        "Written by `./bench scenes --sizes`. Counts of every scene at the size `full`, as the program builds"
        " it, of those that its source publishes, and their ratio; of scenes of more than"
        f" {LARGE:,} vertices the counts that the scene states. {sum(map(_is_near, counts))} of {len(counts)}"
        " published counts are met within 10 %, all of them in"
        f" {sum(all(map(_is_near, one)) for one in compared)} of the {len(compared)} scenes whose source"
        " publishes counts; a ratio farther off is bold, and the last column has the reason. A published"
        " count is rounded to 100, and may be of another version of the scene than the one that is rebuilt."
    )
    table = markdown(["scene", *KINDS, "why a count is another"], rows)
    return "\n".join(
        ["# Sizes of the catalogue", "", head, "", f"Sources: {'; '.join(sources)}.", "", *table, ""]
    )


def read(file: Path = FILE) -> dict[str, dict[str, int]]:
    return read_of_schema(file, NAME)["scenes"]


def write(kept: dict[str, dict[str, int]]) -> None:
    lines = [f"{json.dumps(name)}: {json.dumps(counts)}" for name, counts in sorted(kept.items())]
    scenes = a_line_each(lines, 2, ("{", "\n }"))
    write_whole(FILE, f'{{\n "schema": "{NAME}",\n "scenes": {scenes}\n}}\n')


def page() -> str:
    """Of what is kept."""
    return markdown_page(entries([]), read())
