"""`bench study score`: one page for a new barrier."""

from __future__ import annotations

import argparse
import json
import shlex
import sys
import time
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, tells
from barrierbench_analysis.io.origin import machine_of
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import parser_of
from barrierbench_analysis.studies.gap_map.spec import read_spec

from . import judge, runs
from .candidate import Candidate, candidate
from .page import page

SPEC = ROOT / "configs" / "score" / "default.json"
SCHEMA = "barrierbench.score/1"
DOC = """
WHAT is a formula, FILE.so (FILE.so:SHAPE where a plugin has several), a formulation of configs/formulations
or a shape of ./bench list shapes. It is matched at theta 0.5, 0.1 and 0.01 in three small scenes beside log,
quadratic, cubic and a consistent stiffness, started from five jittered states, and put through twelve hard
cases of the stress suite. Writes score.json and score.html into the folder. Finished runs are kept.
"""


def _arguments(argv: list[str]) -> argparse.Namespace:
    parser = parser_of(
        "study score",
        DOC,
        "./bench study score cubic_dynamic_lagged",
        "./bench study score build/plugin/inverse_shape.so",
    )
    parser.formula_argument("what", "WHAT")
    parser.add_argument("--out", type=Path, metavar="DIR", help="folder (default: results/runs/score/LABEL)")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="runs at a time (default 2)")
    args = parser.parse_args(argv)
    if args.jobs < 1:
        raise UserError(f"--jobs: found {args.jobs}; a number from 1 on is needed")
    return args


def _score(
    of: Candidate, records: dict, rows: list[dict], starts: list[dict], cases: list[dict], begun: float
) -> dict:
    """The content of score.json. begun: by time.monotonic()."""
    some = next((one[0] for one in records.values() if one), None)
    return {
        "schema": SCHEMA,
        "candidate": {"label": of.label, "formulation": of.formulation, "about": of.about},
        "command": shlex.join(["./bench", "study", "score", *of.place]),
        "machine": machine_of(some) if some else "",
        "seconds": round(time.monotonic() - begun, 1),
        "decides": judge.decides(rows, starts, cases, of.label),
        "comparisons": [vars(one) | {"verdict": one.verdict} for one in judge.comparisons(rows, of.label)],
        "at_equal_gap": [
            vars(ratio) | {"metric": metric, "gap": gap}
            for metric, gap, ratio in judge.at_equal_gap(rows, of.label)
        ],
        "row_ns": {method: ns for method, (ns, _) in judge.row_times(rows).items()},
        "rows": rows,
        "starts": starts,
        "hard_cases": cases,
    }


@tells("study score")
def main(argv: list[str]) -> int:
    """0: scored; 2: nothing that can be scored."""
    args = _arguments(argv)
    begun = time.monotonic()
    of = candidate(args.what)
    out = args.out or ROOT / "results" / "runs" / "score" / of.label
    spec = read_spec(SPEC)

    def say(text: str) -> None:
        print(f"score: {text}, {time.monotonic() - begun:.0f} s", file=sys.stderr)

    records = runs.run(runs.matched(spec, of), of, out, args.jobs)
    say(f"{len(records)} matched runs")
    starts = runs.starts(of, runs.run(runs.jittered(spec, of), of, out, args.jobs))
    say("jittered starts")
    cases = runs.hard_cases(of, out, args.jobs)
    say(f"{len(cases)} hard runs")
    score = _score(of, records, runs.rows(spec, of, records), starts, cases, begun)
    write_whole(out / "score.json", json.dumps(score, indent=1, allow_nan=False) + "\n")
    write_whole(out / "score.html", page(score))
    print("\n".join(score["decides"]))
    print(out / "score.html")
    return 0
