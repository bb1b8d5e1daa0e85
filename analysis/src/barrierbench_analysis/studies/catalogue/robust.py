"""Runs mini scenes of the catalogue from jittered starts: every start coordinate of a free vertex is moved
by a uniform number within the jitter that the scene names, by the seeds 1, 2 and so on, which the records
keep. A scene passes when every seed ends `ok` without a crossing; one that must be rejected, when every
seed is. Prints a table and keeps it in results/robust.json; where --set gives the runs settings of their
own, such as another device, the table is printed alone.

Exit codes: 0 all passed, 1 some did not, 2 bad input.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, tells
from barrierbench_analysis.io.origin import stamp
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.store import a_line_each, merged, read_store
from barrierbench_analysis.io.text_table import fitted
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import parser_of, set_argument
from barrierbench_analysis.tables.outcomes import OK, outcome_of

from .checks import judge, no_crossing
from .entry import Entry, entries
from .formulations import PAIR
from .runs import RUNS, Done, run_scene

FILE = ROOT / "results" / "robust.json"
NAME = "barrierbench.robust/1"


def _arguments(argv: list[str]) -> argparse.Namespace:
    parser = parser_of("study robust", __doc__, "./bench study robust --all")
    parser.add_argument("names", nargs="*", metavar="SCENE", help="configs/catalogue/SCENE.json")
    parser.add_argument("--all", action="store_true", help="all scenes of the catalogue")
    parser.add_argument("--seeds", type=int, default=10, metavar="N", help="starts (default: 10)")
    parser.add_argument(
        "--formulations", nargs="+", default=list(PAIR), metavar="NAME", help=f"default: {' '.join(PAIR)}"
    )
    set_argument(parser, "override in every run", "/device='\"cuda\"'")
    parser.add_argument(
        "--runs",
        type=Path,
        default=RUNS / "robust",
        metavar="DIR",
        help="folder of the records (default: results/runs/catalogue/robust)",
    )
    args = parser.parse_args(argv)
    if bool(args.names) == args.all:
        raise UserError("scenes, or --all, are needed, and not both")
    if args.seeds < 1:
        raise UserError(f"--seeds {args.seeds}: at least 1 is needed")
    args.given = dict(_setting(text) for text in args.overrides)
    return args


def _setting(text: str) -> tuple[str, object]:
    pointer, equals, value = text.partition("=")
    if not equals or not pointer.startswith("/"):
        raise UserError(f"--set {text}: a pointer, = and a value as JSON are needed, such as /threads=1")
    try:
        return pointer, json.loads(value)
    except ValueError:
        raise UserError(f"--set {text}: {value} is no JSON; a word stands in double quotes") from None


def failure(entry: Entry, done: Done) -> str:
    """Why a start did not pass; empty where it did."""
    if entry.is_rejected:
        red = [finding.saw for _, finding in judge(done.record, entry.data["expect"]) if finding.red]
        return red[0] if red else ""
    if (outcome := outcome_of(done.record)) != OK:
        return outcome
    crossing = no_crossing(done.record)
    return crossing.saw if crossing.red else ""


def rows_of(entry: Entry, runs: list[Done]) -> list[dict]:
    """One row a formulation."""
    rows = []
    for label in dict.fromkeys(done.formulation for done in runs):
        mine = [done for done in runs if done.formulation == label]
        failed = [f"seed {done.seed}: {why}" for done in mine if (why := failure(entry, done))]
        rows.append(
            {
                "formulation": label,
                "seeds": len(mine),
                "passed": len(mine) - len(failed),
                "jitter_m": entry.data["jitter_m"],
                "failed": "; ".join(failed),
            }
            | stamp(mine[0].record, "date")
        )
    return rows


def read(file: Path = FILE) -> dict[str, list[dict]]:
    """Scene -> rows; empty where nothing is kept."""
    return read_store(file, NAME, lambda data: data["scenes"], "; ./bench study robust makes it", {})


def write(scenes: dict[str, list[dict]], file: Path = FILE) -> None:
    lines = [
        f"{json.dumps(name)}: {a_line_each(map(json.dumps, rows), 3)}"
        for name, rows in sorted(scenes.items())
    ]
    scenes = a_line_each(lines, 2, ("{", "\n }"))
    write_whole(file, f'{{\n "schema": "{NAME}",\n "scenes": {scenes}\n}}\n')


@tells("study robust")
def main(argv: list[str]) -> int:
    args = _arguments(argv)
    seeds, kept, lines = list(range(1, args.seeds + 1)), read(), []
    for entry in entries(args.names):
        print(f"robust: {entry.name}", file=sys.stderr)
        rows = rows_of(entry, run_scene(entry, args.formulations, args.runs, seeds, args.given))
        kept[entry.name] = merged(kept.get(entry.name, []), rows, ("formulation",), replace=True)
        if not args.given:
            write(kept)  # an interrupt leaves what is over
        lines += [
            [entry.name, row["formulation"], f"{row['passed']}/{row['seeds']}", row["failed"]] for row in rows
        ]
    print("\n".join(fitted(["scene", "formulation", "passed", "what failed"], lines)))
    return 0 if all(not line[3] for line in lines) else 1
