"""Where the runs of a sweep are: over with their outcomes, running, dead (their process is gone, or has given
no sign of life for a minute), stopped with a checkpoint, or waiting. `./bench sweep` goes on with all.

Exit codes: 0 every run is over, 1 not every run, 2 no list of cases in the folder.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path

from ..errors import UserError, tells
from ..front.arguments import parser_of
from ..json_file import read_object
from ..text_table import aligned
from .cases import OVER, RUNNING, STATES, Case, Sighting, read_cases, sighted

CLEAR = "\033[H\033[2J"


class Outcomes:
    """Outcomes of records; each file is read once as long as it stays as it is."""

    def __init__(self):
        self.known: dict[Path, tuple[tuple[int, int], str]] = {}

    def of(self, case: Case) -> str:
        try:
            found = case.record.stat()
            key = (found.st_mtime_ns, found.st_size)
            if self.known.get(case.record, (None,))[0] != key:
                status = read_object(case.record).get("status") or {}
                self.known[case.record] = key, str(status.get("outcome", "no outcome"))
            return self.known[case.record][1]
        except (OSError, UserError):
            return "unreadable"


def _counts(counter: Counter) -> str:
    return ", ".join(
        f"{n} {word}" for word, n in sorted(counter.items(), key=lambda item: (-item[1], item[0]))
    )


def eta(cases: list[Case], seen: list[Sighting]) -> str:
    """From how fast records have come so far; empty without two of them or without a run that goes on."""
    ends = sorted(case.record.stat().st_mtime for case, one in zip(cases, seen) if one.state == OVER)
    left = len(cases) - len(ends)
    if len(ends) < 2 or not left or not any(one.state == RUNNING for one in seen):
        return ""
    return f", eta {left * (time.time() - ends[0]) / len(ends):.0f} s"


def text(folder: Path, cases: list[Case], outcomes: Outcomes, every: bool) -> tuple[str, bool]:
    """A line of counts, a row for each run that is under way or came to a halt (or for every run), and
    whether all are over.
    """
    seen = [sighted(case) for case in cases]
    states = Counter(one.state for one in seen)
    ended = Counter(outcomes.of(case) for case, one in zip(cases, seen) if one.state == OVER)
    parts = [
        f"{states[state]} {state}" + (f" ({_counts(ended)})" if state == OVER and ended else "")
        for state in STATES
        if states[state] or state == OVER
    ]
    lines = [f"{folder}: {len(cases)} runs: {', '.join(parts)}{eta(cases, seen)}"]
    rows = [
        [
            str(case.index),
            one.state,
            case.label,
            one.detail or (outcomes.of(case) if one.state == OVER else ""),
        ]
        for case, one in zip(cases, seen)
        if every or one.state not in (OVER, "waiting")
    ]
    if rows:
        lines += aligned(["index", "state", "run", "detail"], rows, {0})
    return "\n".join(lines), states[OVER] == len(cases)


def arguments(argv: list[str]) -> argparse.Namespace:
    parser = parser_of("status", __doc__, "./bench status results/runs/my_sweep --watch")
    parser.add_argument("folder", type=Path, metavar="DIR", help="the folder of a sweep")
    parser.add_argument("--all", action="store_true", help="a row for every run")
    parser.add_argument(
        "--missing",
        action="store_true",
        help="only the indices of the runs without a record, one a line: for ./bench sweep --index",
    )
    parser.add_argument(
        "--watch",
        action="store_true",
        help="again and again until all are over: on a terminal in place, else a line when it has changed",
    )
    parser.add_argument(
        "--every", type=float, default=2, metavar="S", help="seconds between two looks (default: 2)"
    )
    args = parser.parse_args(argv)
    if not args.every > 0:
        raise UserError(f"--every: found {args.every}; a number of seconds above 0 is needed")
    return args


def watch(args: argparse.Namespace) -> int:
    outcomes, told = Outcomes(), ""
    while True:
        shown, is_over = text(args.folder, read_cases(args.folder), outcomes, args.all)
        if sys.stdout.isatty():
            print(CLEAR + shown, flush=True)
        elif (line := shown.split(", eta")[0].splitlines()[0]) != told:
            told = line
            print(shown.splitlines()[0], flush=True)
        if is_over:
            return 0
        time.sleep(args.every)


@tells("status")
def main(argv: list[str]) -> int:
    args = arguments(argv)
    if args.watch:
        return watch(args)
    cases = read_cases(args.folder)
    if args.missing:
        missing = [case for case in cases if not case.record.is_file()]
        print("".join(f"{case.index}\n" for case in missing), end="")
        return 1 if missing else 0
    shown, is_over = text(args.folder, cases, Outcomes(), args.all)
    print(shown)
    return 0 if is_over else 1
