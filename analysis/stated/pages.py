"""The statements of the pages of results/ and docs/, read back from their text: what, under which conditions,
which number, and what its study decides of it. A number that stands on two pages is compared as it stands
there, whatever made it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from .. import input_file
from ..errors import UserError

PART = re.compile(
    r"^- (?P<says>.+?): \*\*(?P<verdict>.+)\*\*.*?\. (?P<measures>[^.]*?(?:\d\.\d[^.]*?)?)"
    r"(?: \(depends on the machine\))?: (?P<number>[\d.e+-]+ \[[^\]]+\]), asked: [^;]*; (?P<counted>.*)\.$"
)
SLICE = re.compile(r"^  Slice: (.+?)\.(?: Samples:.*)?$")
OF_SCENE = re.compile(r"[:;] ([\w-]+) [\d.e+-]+ \(")
NUMBER = re.compile(r"(?P<number>[\d.e+-]+ \[[\d.e+inf-]+, [\d.e+inf-]+\])")
LAW = re.compile(
    r"(Raw|Block Jacobi): (the law, [^:]+): (\d+) of (\d+) pairs, (ln\(measured/predicted\) \S+ in the mean"
    r" with standard deviation \S+ \(a factor \S+\)); (the law with [^:]+): (\d+) of (\d+) pairs,"
    r" (ln\(measured/predicted\) \S+ in the mean with standard deviation \S+ \(a factor [^)]+\))"
)


@dataclass(frozen=True)
class Statement:
    """page: file and place in it. verdict: None where the page states a number and decides nothing."""

    page: str
    quantity: str
    conditions: str
    number: str
    verdict: str | None = None


def _slice(below: list[str]) -> str:
    """Theta, limit and the scenes, of the lines below a part."""
    theta = next((found[1] for line in below if (found := SLICE.match(line))), "")
    scenes = next((line for line in below if line.startswith("  By scene ")), "")
    return "; ".join(filter(None, [theta, ", ".join(OF_SCENE.findall(scenes))]))


def _claims(text: str, page: str) -> Iterator[Statement]:
    """Parts of results/CLAIMS.md, each with the line of its slice below it."""
    claim, evidence, lines = "", "exploratory", text.splitlines()
    for k, line in enumerate(lines):
        if line.startswith("## "):
            claim, evidence = line[3:].partition(":")[0], "exploratory"
        elif line.startswith("Confirmed: "):
            evidence = "confirmed"
        elif found := PART.match(line):
            yield Statement(
                f"{page}, {claim}, {evidence}",
                found["measures"],
                f"{_slice(lines[k + 1 : k + 3])}; {found['counted']}",
                found["number"],
                found["verdict"].partition(":")[0].partition(" (")[0],
            )


def _law(text: str, page: str) -> Iterator[Statement]:
    """The scatter of the area law, on the page and in captions."""
    for found in LAW.finditer(" ".join(text.split())):
        for form, n, of, scatter in (found.group(2, 3, 4, 5), found.group(6, 7, 8, 9)):
            yield Statement(page, f"scatter of {form} ({found[1]})", "", f"{n} of {of}: {scatter}")


def _cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def _tables(text: str) -> Iterator[tuple[str, list[str], list[str]]]:
    """Title above, heads and cells of every row of every table."""
    title, heads = "", None
    for line in text.splitlines():
        if line.startswith("#"):
            title, heads = line.lstrip("# "), None
        elif line.startswith("|"):
            if heads is None:
                heads = _cells(line)
            elif not line.startswith("|---"):
                yield title, heads, _cells(line)
        elif line.strip():
            heads = None


def _map(text: str, page: str) -> Iterator[Statement]:
    """Ratios of the gap map, over the log's."""
    for title, heads, cells in _tables(text):
        for head, cell in zip(heads, cells):
            if head.endswith(" over the log's") and NUMBER.fullmatch(cell):
                conditions = f"{title}, {heads[0]} {cells[0]}; {cells[-1]}"
                yield Statement(page, f"{head.split(' over')[0]}: {cells[1]} / `log`", conditions, cell)


def _pair(text: str, page: str) -> Iterator[Statement]:
    """The log over the cubic alone: by target and limit, and by size."""
    for title, heads, cells in _tables(text):
        for head, cell in zip(heads, cells):
            if ", log over " in head and NUMBER.fullmatch(cell):
                conditions = "; ".join(c for h, c in zip(heads, cells) if ", log over " not in h)
                yield Statement(page, f"{title}: {head}", conditions, cell)


def _pareto(text: str, page: str) -> Iterator[Statement]:
    """Ratios over all scenes at equal reached gap."""
    for title, heads, cells in _tables(text):
        for head, cell in zip(heads, cells):
            if heads[0] == "number" and (found := NUMBER.match(cell)):
                yield Statement(page, f"{title}: {cells[0]} of {cells[1]}", head, found["number"])


def _ablation(text: str, page: str) -> Iterator[Statement]:
    """Main effects, with what is decided of them."""
    for title, heads, cells in _tables(text):
        if heads[0] == "factor" and len(cells) == 6:
            yield Statement(page, f"{title}: {cells[1]}", "ablation", cells[2], cells[5].strip("*"))


def _verdicts(text: str, page: str) -> Iterator[Statement]:
    """The number of a claim in a table of verdicts: that of the part of which results/CLAIMS.md has more."""
    for _, heads, cells in _tables(text):
        if heads[0] == "claim" and (found := NUMBER.search(cells[-1])):
            confirmed = "confirmed" if cells[-1].endswith("confirmed scenes") else "exploratory"
            measures = cells[-1][: found.start()].rstrip(": ")
            yield Statement(page, f"{cells[0]}, {confirmed}: {measures}", "first part", found["number"])


def _firsts(text: str, page: str) -> Iterator[Statement]:
    """The same of the sections of the claims."""
    seen: set[str] = set()
    for one in _claims(text, page):
        _, claim, evidence = one.page.split(", ")
        if f"{claim} {evidence}" not in seen:
            seen.add(f"{claim} {evidence}")
            yield Statement(one.page, f"{claim}, {evidence}: {one.quantity}", "first part", one.number)


# Page -> its readers. Each has to find something: a page that is written otherwise would be read as silent.
READERS: dict[str, tuple[Callable[[str, str], Iterator[Statement]], ...]] = {
    "results/CLAIMS.md": (_claims, _firsts, _verdicts),
    "results/GAP_MAP.md": (_map, _pair, _law),
    "results/PARETO.md": (_pareto,),
    "results/ABLATION.md": (_ablation,),
    "docs/results.md": (_verdicts,),
    "docs/gap_law.txt": (_law,),
    "docs/gap_law_more.txt": (_law,),
}


def statements(root: Path) -> list[Statement]:
    """Errors: UserError for a page in which a reader finds nothing."""
    found = []
    for page, readers in READERS.items():
        text = input_file.read_text(root / page)
        for reader in readers:
            mine = list(reader(text, page))
            if not mine:
                raise UserError(f"{page}: no statement is found of the kind {reader.__name__.strip('_')}")
            found += mine
    return found
