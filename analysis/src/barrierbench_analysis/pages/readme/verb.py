"""Makes the numbers of README.md and docs/results from the records of ./bench demo and the kept numbers of
./bench study claims, and checks them and every snippet of these pages and of the other pages of docs. It also
writes the pages of docs/reference.

Exit codes: 0 written, or all is well, 1 something is not as the page says, 2 there is nothing to make it
from.
"""

import argparse
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.pages.reference import make as reference
from barrierbench_analysis.pages.stated import several
from barrierbench_analysis.pages.stated.check import faults as disagreements
from barrierbench_analysis.pages.stated.cost import gather as gather_cost
from barrierbench_analysis.program.arguments import options, parser_of
from barrierbench_analysis.program.start import built_program
from barrierbench_analysis.studies.claims import table as claims_table
from barrierbench_analysis.studies.kit.study import page as study_page
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.rules.gap_map.table import kept_map

from . import figures
from .numbers import FILE, RUNS, gather, read, write
from .slices import gather as gather_slices
from .snippets import faults
from .templates import PARTS, filled, gather_map, lacking

PAGES = tuple(PARTS)
# Pages whose snippets are checked and which have no generated numbers.
MORE = ("CONTRIBUTING.md", "docs/**/*.md", "examples/cluster/README.md")


def kept() -> dict:
    """The answer, the study at size, the numbers of the demo, those of the claims' slices, the sentences of
    the gap map, what several studies say of one quantity, and what studies take. Errors: UserError where
    one is missing.
    """
    claims, found = claims_table.read(claims_table.FILE), kept_map()
    studies = {
        "answer": study_page.numbers_of(read_study("answer"))["table"],
        "at_size": study_page.numbers_of(read_study("at_size")),
        "slices": gather_slices(claims, found),
        "gap_map": gather_map(found),
        "several": several.gather(claims, found, read_study("ablation")),
    }
    return read() | studies | {"cost": gather_cost()}


def pages_with_snippets(root: Path) -> list[str]:
    """From the root, the generated ones first."""
    found = sorted(str(path.relative_to(root)) for pattern in MORE for path in root.glob(pattern))
    return [*PAGES, *(page for page in found if page not in PAGES)]


def stale(root: Path, numbers: dict) -> list[str]:
    """Pages whose generated parts are not there, or not what the templates make of the kept numbers."""
    texts = {page: input_file.read_text(root / page) for page in PAGES}
    absent = [line for page, text in texts.items() for line in lacking(text, page)]
    return absent + [
        f"{page}: its numbers are not those of results/demo.json and of the other results; ./bench"
        " readme --fill writes them"
        for page, text in texts.items()
        if filled(text, numbers, page) != text
    ]


def write_pages(root: Path, numbers: dict) -> list[str]:
    """Errors: UserError for a page without the marks of its parts."""
    changed = []
    for page in PAGES:
        text = input_file.read_text(root / page)
        if absent := lacking(text, page):
            raise UserError("\n".join(absent))
        if (made := filled(text, numbers, page)) != text:
            write_whole(root / page, made)
            changed.append(page)
    return changed


def arguments(argv: list[str]) -> argparse.Namespace:
    parser = parser_of(
        "dev readme",
        __doc__,
        "./bench demo && ./bench dev readme --write",
        "./bench study claims && ./bench dev readme --fill",
    )
    what = parser.add_mutually_exclusive_group(required=True)
    text = """
--write: keep the numbers of the records in results/demo.json, fill the pages with them, and copy the figures
    that they show
--fill: fill the pages with the numbers that are kept in results/: after ./bench study claims, without records
    of the demo
--check: run or parse every snippet, compare the pages with the kept numbers, and look for two statements on
    one thing that disagree
--reference: write the pages of docs/reference that are made from what the program prints of itself"""
    options(what, text)
    text = "--runs DIR: folder of the demo's records (default: results/runs/demo)"
    options(parser, text, runs={"type": Path, "default": RUNS})
    return parser.parse_args(argv)


def keep_demo(runs: Path) -> None:
    """Keeps the numbers of the demo's records, copies the figures that the pages show, and says which."""
    write(gather(runs))
    copied = figures.copy(
        [input_file.read_text(ROOT / page) for page in pages_with_snippets(ROOT)],
        runs / "figures",
        ROOT / "docs",
    )
    print(f"docs: {', '.join(copied) or 'no figure'}")


@reported("dev readme")
def main(argv: list[str]) -> int:
    args = arguments(argv)
    if args.write:
        keep_demo(args.runs)
    if args.write or args.fill:
        print(f"{FILE}; changed: {', '.join(write_pages(ROOT, kept())) or 'no page'}")
        return 0
    built_program()
    if args.reference:
        print(f"docs/reference; changed: {', '.join(reference.write(ROOT)) or 'no page'}")
        return 0
    numbers = kept()
    found = (
        [
            fault
            for page in pages_with_snippets(ROOT)
            for fault in faults(input_file.read_text(ROOT / page), page)
        ]
        + stale(ROOT, numbers)
        + disagreements(ROOT, numbers["several"])
        + figures.absent(ROOT / "docs")
        + reference.stale(ROOT)
    )
    print(
        "\n".join(found)
        or "every snippet works, and the numbers are those of results/demo.json and"
        " results/studies/claims.jsonl"
    )
    return 1 if found else 0
