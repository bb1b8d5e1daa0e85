"""The statements of the pages of results/ and docs/, read back from their text: what, under which conditions,
which number, and what its study decides of it. A number that stands on two pages is compared as it stands
there, whatever made it.
"""

import csv
import re
from collections.abc import Callable, Iterator
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.pages.reference import MARK
from barrierbench_analysis.tables.numbers import interval, ratio

from . import counted
from .statement import Statement, tables
from .whole_page import everything

NUMBER = re.compile(r"(?P<number>[\d.e+-]+ \[[\d.e+inf-]+, [\d.e+inf-]+\])")
LAW = re.compile(
    r"(Raw|Block Jacobi): (the law, [^:]+): (\d+) of (\d+) pairs, (ln\(measured/predicted\) \S+ in the mean"
    r" with standard deviation \S+ \(a factor \S+\)); (the law with [^:]+): (\d+) of (\d+) pairs,"
    r" (ln\(measured/predicted\) \S+ in the mean with standard deviation \S+ \(a factor [^)]+\))"
)


def _claims(text: str, page: str) -> Iterator[Statement]:
    """Parts of results/CLAIMS.csv that have a number with a 95% interval."""
    for row in csv.DictReader(text.splitlines()):
        if row["interval"] == "95% over scenes":
            scenes = ", ".join(one.split()[0] for one in row["by_scene"].split("; ") if one)
            conditions = (row["conditions"], scenes, row["counted_and_left_out"], f"`{row['sweep']}`")
            yield Statement(
                f"{page}, {row['claim']}, {row['evidence']}",
                row["measures"],
                "; ".join(filter(None, conditions)),
                interval(*(float(row[name]) for name in ("number", "lower", "upper")), ratio),
                row["verdict"],
            )


def _law(text: str, page: str) -> Iterator[Statement]:
    """The scatter of the area law, on the page and in captions."""
    for found in LAW.finditer(" ".join(text.split())):
        for form, n, of, scatter in (found.group(2, 3, 4, 5), found.group(6, 7, 8, 9)):
            yield Statement(page, f"scatter of {form} ({found[1]})", "", f"{n} of {of}: {scatter}")


def _map(text: str, page: str) -> Iterator[Statement]:
    """Ratios of the gap map, over the log's."""
    for title, heads, cells in tables(text):
        for head, cell in zip(heads, cells):
            if head.endswith(" over the log's") and NUMBER.fullmatch(cell):
                conditions = f"{title}, {heads[0]} {cells[0]}; {cells[-1]}"
                yield Statement(page, f"{head.split(' over')[0]}: {cells[1]} / `log`", conditions, cell)


def pair(text: str, page: str) -> Iterator[Statement]:
    """The log over the cubic alone: by target and limit, by size, and the slopes against size."""
    for title, heads, cells in tables(text):
        for head, cell in zip(heads, cells):
            if "log over " in head and NUMBER.fullmatch(cell):
                conditions = "; ".join(c for h, c in zip(heads, cells) if "log over " not in h)
                yield Statement(page, f"{title}: {head}", conditions, cell)


def _pareto(text: str, page: str) -> Iterator[Statement]:
    """Ratios over all scenes at equal reached gap."""
    for title, heads, cells in tables(text):
        for head, cell in zip(heads, cells):
            if heads[0] == "number" and (found := NUMBER.match(cell)):
                yield Statement(page, f"{title}: {cells[0]} of {cells[1]}", head, found["number"])


def _ablation(text: str, page: str) -> Iterator[Statement]:
    """Main effects, with what is decided of them."""
    for title, heads, cells in tables(text):
        if heads[0] == "factor" and len(cells) == 6:
            yield Statement(page, f"{title}: {cells[1]}", "ablation", cells[2], cells[5].strip("*"))


def _verdicts(text: str, page: str) -> Iterator[Statement]:
    """The number of a claim in a table of verdicts: that of its first part in results/CLAIMS.csv."""
    for _, heads, cells in tables(text):
        if heads[0] == "claim" and (found := NUMBER.search(cells[-1])):
            confirmed = "confirmed" if cells[-1].endswith("confirmed scenes") else "exploratory"
            measures = cells[-1][: found.start()].rstrip(": ")
            claim = cells[0].lstrip("[").partition("]")[0]
            yield Statement(page, f"{claim}, {confirmed}: {measures}", "first part", found["number"])


def _firsts(text: str, page: str) -> Iterator[Statement]:
    """The same of the rows of the claims."""
    seen: set[str] = set()
    for one in _claims(text, page):
        _, claim, evidence = one.page.split(", ")
        if f"{claim} {evidence}" not in seen:
            seen.add(f"{claim} {evidence}")
            yield Statement(one.page, f"{claim}, {evidence}: {one.quantity}", "first part", one.number)


# Page -> its readers. Each has to find something: a page that is written otherwise would be read as silent.
Reader = Callable[[str, str], Iterator[Statement]]
READERS: dict[str, tuple[Reader, ...]] = {
    "results/CLAIMS.csv": (_claims, _firsts),
    "results/CLAIMS.md": (_verdicts,),
    "results/GAP_MAP.md": (_map, pair, _law, counted.gap_map),
    "results/PARETO.md": (_pareto,),
    "results/ABLATION.md": (_ablation,),
    **{f"results/{of.__name__.upper()}.md": (of,) for of in (counted.stress, counted.catalogue)},
    "results/WORK_PRECISION.md": (counted.work_precision,),
    **dict.fromkeys(
        ("results/ENGINES.md", "results/ENGINES_SIZE.md", "results/ENGINES_RODS.md"), (counted.engines,)
    ),
    "docs/results/which-barrier.md": (counted.gap_map,),
    "docs/results/engines.md": (counted.engines_in_words,),
    "docs/guides/verbs.md": (counted.mentions,),
    "docs/guides/cluster.md": (counted.cluster,),
    **dict.fromkeys(("docs/gap_law.txt", "docs/gap_law_more.txt"), (_law, counted.gap_map)),
    **dict.fromkeys(("docs/gap_map.txt", "docs/gap_map_more.txt"), (counted.gap_map,)),
}
CAPTIONS = {"docs/work_precision_*.txt": counted.work_precision_caption}
# pages that state none, so that nothing can be read in them
NO_NUMBERS = [f"docs/{of}/index.md" for of in ("guides", "reference", "results/method", "theory")]
EVERY = ("README.md", "docs/**/*.md", "docs/*.txt", "results/*.md")


def pages_of(root: Path) -> list[str]:
    """All pages, from the root, whether a reader is made for them or not; but for those of docs/reference
    that are made from what the program prints, which state nothing that was measured.
    """
    every = (path for pattern in EVERY for path in sorted(root.glob(pattern)))
    return [path.relative_to(root).as_posix() for path in every if MARK not in input_file.read_text(path)]


def _readers(page: str) -> list[Reader]:
    return [*READERS.get(page, ()), *(reader for of, reader in CAPTIONS.items() if Path(page).match(of))]


def by_page(root: Path) -> dict[str, list[Statement]]:
    """Of every page, what is read by its own readers and by the one of all pages. Errors: UserError for a
    page in which a reader that is made for it finds nothing, and for one that is not there.
    """
    found: dict[str, list[Statement]] = {}
    for page in dict.fromkeys([*READERS, *pages_of(root)]):
        text = input_file.read_text(root / page)
        found[page] = list(everything(text, page))
        for reader in _readers(page):
            mine = list(reader(text, page))
            if not mine:
                raise UserError(f"{page}: no statement is found of the kind {reader.__name__.strip('_')}")
            found[page] += mine
    return found
