"""Draws a balanced fraction of a factorial sweep, runs what is missing of it shard by shard, keeps a row a
run in results/ablation.json, and writes results/ABLATION.md and docs/ablation.png of these rows. Stop it and
call it again: it goes on. --plan says what the whole factorial would take and keeps that (minutes).

Exit codes: 0 written, 2 bad input, or what is kept is of other files.
"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, tells
from barrierbench_analysis.io.origin import origin
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.store import check_digest
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import parser_of
from barrierbench_analysis.program.start import started

from . import figure
from .effects import study
from .factors import Factorial, read_factorial
from .report import page
from .runs import records_of, run_all
from .table import FILE, Table, read, row_of, write

DEFAULT = ROOT / "configs/ablation/default.json"
RUNS = ROOT / "results/runs/ablation"
PAGE, PICTURE = ROOT / "results/ABLATION.md", ROOT / "docs/ablation.png"


def _arguments(argv: list[str]) -> argparse.Namespace:
    parser = parser_of(
        "study ablation", __doc__, "./bench study ablation --no-run", "./bench study ablation --shards 1"
    )
    parser.add_argument("spec", nargs="?", type=Path, default=DEFAULT, help=f"default: {DEFAULT.name}")
    parser.add_argument("--no-run", action="store_true", help="judge the rows that are kept")
    parser.add_argument("--gather", action="store_true", help="run nothing, but take rows from the records")
    parser.add_argument("--shards", type=int, metavar="N", help="the first N shards of every scene alone")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="shards at a time (default 1)")
    parser.add_argument("--plan", action="store_true", help="ask ./bench plan for the cost of the whole")
    parser.add_argument("--runs", type=Path, default=RUNS, metavar="DIR", help="folder of the records")
    args = parser.parse_args(argv)
    if args.jobs < 1:
        raise UserError(f"--jobs: found {args.jobs}; a number from 1 on is needed")
    return args


def _cost(factorial: Factorial, runs: Path) -> str:
    """The last lines of ./bench plan for the whole factorial. Errors: UserError with what it says."""
    done = started("plan", str(factorial.sweep_path), "--records", str(runs), "--progress", "none")
    found = re.search(r"^expected: .*$", done.stdout, re.M)
    if done.returncode != 0 or not found:
        raise UserError(f"plan: {(done.stderr.strip() or 'it said nothing').splitlines()[0]}")
    return found[0]


def gathered(factorial: Factorial, runs: Path, plan: str) -> Table:
    """Rows of all records of the fraction. Errors: UserError without any."""
    rows, records = [], []
    for scene in factorial.scenes.labels:
        if (runs / scene).is_dir():
            found = records_of(runs / scene)
            records += found.values()
            rows += [row_of(scene, case, record) for case, record in sorted(found.items())]
    if not rows:
        raise UserError(f"{runs}: no record of this fraction; ./bench study ablation makes them")
    return Table(factorial.digest, origin(records) | {"plan": plan}, rows)


@tells("study ablation")
def main(argv: list[str]) -> int:
    args = _arguments(argv)
    factorial = read_factorial(args.spec.absolute())
    kept = read() if FILE.is_file() else None
    if kept and args.no_run:
        check_digest(FILE, "digest", kept.digest, factorial.digest, "spec or sweep", "./bench study ablation")
    plan = kept.about.get("plan", "") if kept and kept.digest == factorial.digest else ""
    if not args.no_run:
        shards = 0 if args.gather else args.shards or factorial.spec["shards"]
        run_all(factorial, shards, args.jobs, args.runs)
        plan = _cost(factorial, args.runs) if args.plan else plan
        kept = gathered(factorial, args.runs, plan)
        write(kept)
    if kept is None:
        raise UserError(f"{FILE}: not there; ./bench study ablation makes it")
    found = study(factorial, kept)
    write_whole(PAGE, page(factorial, kept, found))
    figure.draw(factorial, kept, found, PICTURE)
    print(f"{PAGE.relative_to(ROOT)}, {PICTURE.relative_to(ROOT)}: {len(kept.rows)} runs", file=sys.stderr)
    return 0
