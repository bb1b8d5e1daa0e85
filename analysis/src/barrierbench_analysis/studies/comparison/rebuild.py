"""Draws figures of the comparison, each from its spec configs/figures/NAME.json: PNG, PDF, SVG, the plotted
numbers as CSV and for pgfplots (.dat), and the caption. `all` stands for every one. The same records give the
same bytes.

--quick draws from small runs, and makes those that are missing, minutes for all. Without it a figure is drawn
from kept numbers (results/) or from the records of its sweep; where these are missing, it is said which
command makes them.

Exit codes: 0 drawn, 2 an unknown name, records missing, nothing to draw, or a file that cannot be written.
"""

import argparse
import os
import sys
import time
from pathlib import Path

from barrierbench_analysis.figures.plots.drawing import Drawing, Place
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.text_table import fitted
from barrierbench_analysis.io.whole_file import check_folder
from barrierbench_analysis.program.arguments import parser_of
from barrierbench_analysis.program.building import job_count

from . import sources
from .spec import FOLDER, Spec, chosen, known, read_spec

RUNS = ROOT / "results" / "runs" / "figures"


def arguments(argv: list[str]) -> argparse.Namespace:
    parser = parser_of(
        "draw figure", __doc__, "./bench draw figure all --quick", "./bench draw figure --list"
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="figures of --list, or all")
    parser.add_argument("--list", action="store_true", help="what there is, and what it is drawn of")
    parser.add_argument("--quick", action="store_true", help="from small runs, made where they are missing")
    parser.add_argument("--no-run", action="store_true", help="make no runs, with --quick either")
    parser.add_argument(
        "--jobs", type=int, default=job_count(), metavar="N", help="runs at a time (default: one a core)"
    )
    parser.add_argument(
        "--runs", type=Path, default=RUNS, metavar="DIR", help="records (default: results/runs/figures)"
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help="figures (default: results/runs/figures/full, or quick with --quick)",
    )
    args = parser.parse_args(argv)
    if not args.names and not args.list:
        raise UserError(f"no figure is named: one of {', '.join(known())}, or all")
    if args.jobs < 1:
        raise UserError(f"--jobs: found {args.jobs}; a number from 1 on is needed")
    return args


def listed(folder: Path = FOLDER) -> str:
    """Name, width, and what a figure is drawn of with and without --quick."""

    def of(wanted) -> str:
        if isinstance(wanted.what, tuple):
            return f"{len(wanted.what)} {wanted.source}"
        return os.path.relpath(wanted.what, ROOT)

    specs = [read_spec(folder / f"{name}.json") for name in known(folder)]
    rows = [[spec.name, f"{spec.width_in:g}", of(spec.records), of(spec.quick), spec.title] for spec in specs]
    return "\n".join(fitted(["figure", "inches", "drawn of", "with --quick", "shows"], rows, {1}))


def draw(spec: Spec, quick: bool, place: Place, out: Path) -> list[Path]:
    """The files of one figure. Errors: UserError."""
    subject = sources.subject(spec.quick if quick else spec.records, place)
    drawing = Drawing(spec.name, spec.title, out / spec.name, spec.width_in, spec.options)
    return spec.kind.draw(subject, drawing)


@reported("draw figure")
def main(argv: list[str]) -> int:
    args = arguments(argv)
    if args.list:
        print(listed())
        return 0
    specs = chosen(args.names)
    out = args.out or RUNS / ("quick" if args.quick else "full")
    check_folder(out)
    place = Place(args.runs, args.quick and not args.no_run, args.jobs)
    refused = []
    for spec in specs:
        start = time.monotonic()
        try:
            paths = draw(spec, args.quick, place, out)
        except UserError as error:
            if len(specs) == 1:
                raise
            refused.append(spec.name)
            print(f"bench draw figure: {spec.name}: {error}", file=sys.stderr)
            continue
        print(f"figure {spec.name}: {time.monotonic() - start:.1f} s", file=sys.stderr)
        print("\n".join(str(path) for path in paths if path.suffix == ".png"), flush=True)
    if refused:
        raise UserError(f"{len(refused)} of {len(specs)} figures are not drawn: {', '.join(refused)}")
    return 0
