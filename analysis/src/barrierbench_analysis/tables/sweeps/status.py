"""Where the runs of a sweep are: over with their outcomes, running, dead (their process is gone, or has given
no sign of life for a minute), stopped with a checkpoint, unreadable (their record is cut or no record), or
waiting. `./bench sweep` goes on with all that are not over.

Exit codes: 0 every run is over, 1 not every run, 2 no list of cases in the folder.
"""

import argparse
import sys
import time
from collections import Counter
from pathlib import Path

from barrierbench_analysis.io.cases import (
    OVER,
    RUNNING,
    STATES,
    UNREADABLE,
    WAITING,
    Case,
    Sighting,
    read_cases,
    sighted,
)
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.record_file import RecordError, read_record
from barrierbench_analysis.io.text_table import fitted
from barrierbench_analysis.program.arguments import finite_number, parser_of
from barrierbench_analysis.program.streams import command

CLEAR = "\033[H\033[2J"


class Outcomes:
    """What records say; each file is read once as long as it stays as it is."""

    def __init__(self):
        self.known: dict[Path, tuple[tuple[int, int], Sighting]] = {}

    def _read(self, case: Case) -> Sighting:
        try:
            return Sighting(OVER, read_record(case.record)["status"]["outcome"])
        except RecordError as error:
            return Sighting(UNREADABLE, str(error).replace(f"{case.folder}/", ""))

    def of(self, case: Case) -> Sighting:
        """Over with its outcome, or waiting without a record. One that cannot be read is as good as none:
        ./bench sweep makes the run again.
        """
        try:
            found = case.record.stat()
        except OSError:
            return Sighting(WAITING)
        key = (found.st_mtime_ns, found.st_size)
        if self.known.get(case.record, (None,))[0] != key:
            self.known[case.record] = key, self._read(case)
        return self.known[case.record][1]

    def sighted(self, case: Case) -> Sighting:
        """What a case is doing, with its outcome where it is over."""
        seen = sighted(case)
        return self.of(case) if seen.state == OVER else seen


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
    seen = [outcomes.sighted(case) for case in cases]
    states = Counter(one.state for one in seen)
    ended = Counter(one.detail for one in seen if one.state == OVER)
    parts = [
        f"{states[state]} {state}" + (f" ({_counts(ended)})" if state == OVER and ended else "")
        for state in STATES
        if states[state] or state == OVER
    ]
    lines = [f"{folder}: {len(cases)} runs: {', '.join(parts)}{eta(cases, seen)}"]
    rows = [
        [str(case.index), one.state, case.label, one.detail]
        for case, one in zip(cases, seen)
        if every or one.state not in (OVER, WAITING)
    ]
    if rows:
        lines += fitted(["index", "state", "run", "detail"], rows, {0})
    return "\n".join(lines), states[OVER] == len(cases)


def arguments(argv: list[str]) -> argparse.Namespace:
    parser = parser_of("status", __doc__, "./bench status results/runs/my_sweep --watch")
    parser.add_argument("folder", type=Path, metavar="DIR", help="the folder of a sweep")
    parser.add_argument("--all", action="store_true", help="a row for every run")
    parser.add_argument(
        "--missing",
        action="store_true",
        help="only the indices of the runs without a record that can be read, one a line: for ./bench sweep"
        " --index",
    )
    parser.add_argument(
        "--watch",
        action="store_true",
        help="again and again until all are over: on a terminal in place, else a line when it has changed",
    )
    parser.add_argument(
        "--every", type=finite_number, default=2, metavar="S", help="seconds between two looks (default: 2)"
    )
    args = parser.parse_args(argv)
    if not args.every > 0:
        raise UserError(f"--every: found {args.every}; a number of seconds above 0 is needed")
    return args


def watch(args: argparse.Namespace) -> int:
    outcomes, last = Outcomes(), ""
    while True:
        shown, is_over = text(args.folder, read_cases(args.folder), outcomes, args.all)
        if sys.stdout.isatty():
            command(CLEAR)
            print(shown, flush=True)
        elif (line := shown.split(", eta")[0].splitlines()[0]) != last:
            last = line
            print(shown.splitlines()[0], flush=True)
        if is_over:
            return 0
        time.sleep(args.every)


@reported("status")
def main(argv: list[str]) -> int:
    args = arguments(argv)
    if args.watch:
        return watch(args)
    cases = read_cases(args.folder)
    if args.missing:
        outcomes = Outcomes()
        missing = [case for case in cases if outcomes.of(case).state != OVER]
        print("".join(f"{case.index}\n" for case in missing), end="")
        return 1 if missing else 0
    shown, is_over = text(args.folder, cases, Outcomes(), args.all)
    print(shown)
    return 0 if is_over else 1
