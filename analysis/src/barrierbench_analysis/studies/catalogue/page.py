"""Runs every mini scene of the catalogue under the formulations (records that are there are skipped), holds
each record against what its scene expects, and writes results/catalogue.json, results/CATALOGUE.md and
docs/catalogue.png, a still of the end of every scene. With names it runs these alone and keeps the rest.

Exit codes: 0 everything as expected, 1 something is not, 2 bad input.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, tells
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.text_table import aligned
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import parser_of

from . import robust, sheet, table
from .entry import Entry, entries, names
from .formulations import FORMULATIONS
from .report import markdown_page
from .runs import RUNS, Done, run_scene

PAGE, PICTURE = ROOT / "results" / "CATALOGUE.md", ROOT / "docs" / "catalogue.png"
STILLS = "log"  # the formulation of the picture


def _arguments(argv: list[str]) -> argparse.Namespace:
    parser = parser_of("study catalogue", __doc__, "./bench study catalogue twist drape --formulations log")
    parser.add_argument("names", nargs="*", metavar="NAME", help="configs/catalogue/NAME.json (default: all)")
    parser.add_argument(
        "--formulations",
        nargs="+",
        default=list(FORMULATIONS),
        metavar="NAME",
        help=f"default: {' '.join(FORMULATIONS)}",
    )
    parser.add_argument(
        "--no-run", action="store_true", help="run nothing: write the page of results/catalogue.json"
    )
    parser.add_argument(
        "--sheet", action="store_true", help="draw docs/catalogue.png anew, of the records of log"
    )
    parser.add_argument(
        "--runs",
        type=Path,
        default=RUNS,
        metavar="DIR",
        help="folder of the records (default: results/runs/catalogue)",
    )
    return parser.parse_args(argv)


def page_of(scenes: dict[str, dict]) -> str:
    """Of everything that is kept."""
    robust_rows = {name: rows for name, rows in robust.read().items() if name in names()}
    return markdown_page(entries([]), scenes, robust_rows, PICTURE.is_file())


def write_page(scenes: dict[str, dict], page: Path) -> None:
    write_whole(page, page_of(scenes))


def _line(name: str, row: dict) -> list[str]:
    said = "; ".join(row["red"]) or "as expected"
    return [name, row["formulation"], row["outcome"], f"{row['seconds']:g} s", f"{row['newton']}", said[:150]]


def _table(rows: list[list[str]]) -> str:
    return "\n".join(aligned([""] * 6, rows)[1:])


def _say(entry: Entry, runs: list[Done], kept: dict) -> None:
    labels = {done.formulation for done in runs}
    rows = [_line(entry.name, row) for row in kept["rows"] if row["formulation"] in labels]
    print(_table(rows), flush=True)


def _say_kept(kept: dict[str, dict]) -> None:
    """The rows that are red, and how many are not."""
    red = [_line(name, row) for name, one in kept.items() for row in one["rows"] if row["red"]]
    if red:
        print(_table(red))
    count = sum(len(one["rows"]) for one in kept.values())
    scenes = f"{len(kept)} scene{'s' * (len(kept) != 1)}"
    print(f"{count - len(red)} of {count} runs of {scenes} end as expected")


def _draw(runs: Path, scenes: dict[str, dict]) -> None:
    """Of the scenes that start and have a result with this formulation, in the order of their names."""
    found = {}
    for entry in entries([]):
        has = any(row["formulation"] == STILLS for row in scenes.get(entry.name, {"rows": []})["rows"])
        if has and not entry.is_rejected:
            (done,) = run_scene(entry, [STILLS], runs)
            found[entry.name] = done.folder, sheet.look_of(entry.data)
    print(sheet.contact_sheet(found, PICTURE))


@tells("study catalogue")
def main(argv: list[str]) -> int:
    args = _arguments(argv)
    asked, scenes = entries(args.names), table.read()
    for entry in [] if args.no_run else asked:
        print(f"catalogue: {entry.name}", file=sys.stderr)
        runs = run_scene(entry, args.formulations, args.runs)
        scenes[entry.name] = table.kept_of(entry, runs, scenes.get(entry.name))
        _say(entry, runs, scenes[entry.name])
        table.write(scenes)
        write_page(scenes, PAGE)
    kept = {entry.name: scenes[entry.name] for entry in asked if entry.name in scenes}
    missing = [entry.name for entry in asked if entry.name not in kept]
    if missing and (args.names or not kept):
        raise UserError(f"{table.FILE}: nothing kept of {missing[0]}: ./bench study catalogue {missing[0]}")
    if args.sheet:
        _draw(args.runs, scenes)
    if args.no_run:
        _say_kept(kept)
        write_page(scenes, PAGE)
    print(PAGE)
    return 1 if any(row["red"] for one in kept.values() for row in one["rows"]) else 0
