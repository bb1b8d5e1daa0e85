"""Runs the stress tests of configs/stress over all formulations (records that are there are skipped), holds
every outcome against what was expected before the first run, and every relation between runs; writes
results/stress.json and results/STRESS.md. With names it runs these alone and keeps the rest.

Exit codes: 0 everything as expected, 1 something is not, or was not judged, 2 a test cannot be run (unknown
id or key, no expectation, no program).
"""

from __future__ import annotations

import argparse
import sys
import time
from datetime import datetime, timezone
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, tells
from barrierbench_analysis.io.origin import stamp
from barrierbench_analysis.io.record_file import read_record
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import parser_of

from . import report
from .entry import ROOT, Test, ids, read_test
from .geometry import run_geometry
from .relations import relations
from .run import config_schema, run_test
from .table import FILE, Result, read, write

RUNS = ROOT / "results" / "runs" / "stress"
QUICK = ["log", "cubic", "cubic_dynamic_consistent"]  # formulations of --quick


def run_one(test: Test, runs: Path, quick: bool = False, limit_s: float = 60.0) -> Result:
    """All runs or counts of one test, judged."""
    start = time.monotonic()

    def say(text):
        return print(f"stress: {text}", file=sys.stderr)

    if "geometry" in test.data:
        result = Result(counts=run_geometry(test, quick))
    else:
        cases = test.data["quick"] if quick else None
        rows = run_test(test, runs, config_schema(), QUICK if quick else None, cases, say, limit_s)
        result = Result(rows, relations=relations(test, rows, cases))
    result.about = {
        "date": datetime.now(timezone.utc).strftime("%Y-%m-%d"),
        "seconds": round(time.monotonic() - start, 1),
        **about(runs / test.id),
    }
    return result


def about(folder: Path) -> dict:
    """Machine and commit of one of the records below."""
    for path in sorted(folder.glob("*/*/runs/*/run.json")):
        return stamp(read_record(path), "machine", "commit")
    return {}


def arguments(argv: list[str]) -> argparse.Namespace:
    parser = parser_of(
        "study stress",
        __doc__,
        "./bench study stress",
        "./bench study stress --quick",
        "./bench study stress S18 --full",
    )
    parser.add_argument("ids", nargs="*", metavar="ID", help="configs/stress/ID.json (default: all)")
    parser.add_argument("--list", action="store_true", help="print the tests and run nothing")
    parser.add_argument(
        "--full",
        action="store_true",
        help=(
            "the sizes and seeds of `full`, 600 s of processor time a run; results go to the folder of the"
            " runs"
        ),
    )
    parser.add_argument(
        "--quick",
        action="store_true",
        help=f"the cases marked quick with {', '.join(QUICK)}, under a minute; nothing is written",
    )
    parser.add_argument(
        "--no-run", action="store_true", help="run nothing: write results/STRESS.md from results/stress.json"
    )
    parser.add_argument(
        "--runs",
        type=Path,
        default=RUNS,
        metavar="DIR",
        help="folder of the records (default: results/runs/stress)",
    )
    args = parser.parse_args(argv)
    if args.full and args.quick:
        raise UserError("--full and --quick contradict each other")
    return args


@tells("study stress")
def main(argv: list[str]) -> int:
    args = arguments(argv)
    names = args.ids or ids()
    tests = {name: read_test(name, full=args.full) for name in names}
    if args.quick:
        tests = {name: test for name, test in tests.items() if "quick" in test.data}
        if not tests:
            raise UserError(f"{', '.join(names)}: no quick case")
    if args.list:
        print(
            "\n".join(
                f"{name}  {test.data['title']}; varied: {test.data['varies']}" for name, test in tests.items()
            )
        )
        return 0
    return judge_all(tests, args)


def write_all(results: dict[str, Result], runs: Path, full: bool) -> None:
    """The table and the page, of all tests that there are results of."""
    everything = {name: read_test(name, full=full) for name in ids()}
    results = {name: result for name, result in results.items() if name in everything}
    write(results, runs / "stress.json" if full else FILE)
    page = runs / "STRESS.md" if full else ROOT / "results" / "STRESS.md"
    write_whole(
        page,
        report.markdown(
            results, everything, "./bench study stress --full" if full else "./bench study stress"
        ),
    )


def judge_all(tests: dict[str, Test], args: argparse.Namespace) -> int:
    """Runs, prints, writes."""
    runs = args.runs / "full" if args.full else args.runs
    file = runs / "stress.json" if args.full else FILE
    kept = {} if args.quick else read(file)
    if args.no_run:
        if missing := [name for name in tests if name not in kept]:
            raise UserError(
                f"{file}: nothing kept of {missing[0]}: ./bench study stress"
                f" {missing[0]}{' --full' if args.full else ''}"
            )
        results = {name: kept[name] for name in tests}
    else:
        results = {}
        for name, test in tests.items():
            results[name] = run_one(test, runs, args.quick, 600.0 if args.full else 60.0)
            print(report.text(results, {name: test}), flush=True)
            if not args.quick:
                write_all({**kept, **results}, runs, args.full)  # an interrupt leaves what is over
    if args.no_run:
        print(report.text(results, tests))
        write_all(kept, runs, args.full)
    return 0 if all(result.as_expected for result in results.values()) else 1
