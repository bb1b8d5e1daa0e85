"""Makes what `bench calibrate` measured the baseline, and says why in the file. It prints old and new of all that changes.

With --record or --matrix the baseline is made of what another program has written. Class I and II are exact: there is nothing to accept,
and a run that breaks an invariant makes no baseline.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ..record_file import RecordError
from . import baseline, calibrate, matrices
from .baseline import Baseline, BaselineError
from .cases import GateError
from .finding import moved
from .metrics import NEVER_RECORDED
from .records import read_run
from .report import number


def _envelope(kept) -> str:
    return f"{number(kept.envelope.value)} [{number(kept.envelope.lower)}, {number(kept.envelope.upper)}]" if kept else "-"


def changes(old: Baseline | None, new: Baseline) -> list[str]:
    """A line for every metric whose envelope changes: old, new, direction."""
    lines = []
    before = old.metrics if old else {}
    for name in sorted(before.keys() | new.metrics.keys()):
        a, b = before.get(name), new.metrics.get(name)
        if a and b and a.envelope == b.envelope:
            continue
        direction = moved(b.envelope.value, a.envelope.value, b.unit) if a and b else "new" if b else "gone"
        lines.append(f"  {name}: {_envelope(a)} -> {_envelope(b)}  {direction}")
    return lines


def _only(old: Baseline | None, new: Baseline, metrics: list[str], path: Path) -> Baseline:
    """The old baseline with these metrics of the new one."""
    if refused := [name for name in metrics if name in NEVER_RECORDED]:
        raise GateError(f"{', '.join(refused)}: class I and II are exact and are never accepted; mend the code")
    if old is None:
        raise GateError(f"{path}: --metric changes a baseline, and there is none yet")
    if unknown := [name for name in metrics if name not in new.metrics]:
        raise GateError(f"{', '.join(unknown)}: not measured; one of {', '.join(sorted(new.metrics))}")
    old.metrics |= {name: new.metrics[name] for name in metrics}
    return old


def keep(new: Baseline, path: Path, reason: str, metrics: list[str]) -> None:
    old = baseline.read(path) if path.exists() else None
    lines = changes(old, new)
    if metrics:
        lines = [line for line in lines if line.strip().split(":")[0] in metrics]
        new = _only(old, new, metrics, path)
    new.reason = reason
    for name, kept in (old.metrics if old else {}).items():  # what waits for an issue goes on waiting
        if kept.xfail and name in new.metrics:
            new.metrics[name].xfail = kept.xfail
    baseline.write(new, path)
    print("\n".join([f"{path}: {len(lines)} of {len(new.metrics)} metrics changed", *lines]))


def main(argv: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="bench accept", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--reason", required=True, help="why the numbers may change; it stays in the baseline")
    parser.add_argument("--case", action="append", default=[], metavar="TEXT", help="only cases whose name contains it (repeatable)")
    parser.add_argument("--metric", action="append", default=[], metavar="NAME", help="only this metric (repeatable)")
    parser.add_argument("--proposals", type=Path, default=calibrate.OUT, metavar="DIR", help="of bench calibrate (default: results/runs/calibration)")
    parser.add_argument("--baselines", type=Path, default=baseline.FOLDER, metavar="DIR", help="default: results/baselines")
    parser.add_argument("--record", type=Path, nargs="+", metavar="RUN.json", help="make the baseline of these records of one config")
    parser.add_argument("--matrix", type=Path, nargs="+", metavar="FILE.mtx", help="make the baseline of these matrices")
    parser.add_argument("--baseline", type=Path, metavar="FILE.json", help="of --record and --matrix")
    args = parser.parse_args(argv)
    if bool(args.record or args.matrix) != bool(args.baseline) or (args.record and args.matrix):
        parser.error("--record or --matrix goes with --baseline FILE.json")
    if not args.reason.strip():
        parser.error("--reason: say why in a sentence")
    try:
        if args.record:
            keep(calibrate.propose(args.baseline.stem, [read_run(path) for path in args.record]), args.baseline, args.reason, args.metric)
        elif args.matrix:
            keep(matrices.propose(args.matrix, args.baseline.stem), args.baseline, args.reason, args.metric)
        else:
            proposals = [p for p in sorted(args.proposals.glob("*.json")) if not args.case or any(word in p.stem for word in args.case)]
            if not proposals:
                raise GateError(f"{args.proposals}: no proposal; `bench calibrate` makes them")
            for path in proposals:
                keep(baseline.read(path, path.stem, "run"), args.baselines / path.name, args.reason, args.metric)
    except (GateError, BaselineError, RecordError, matrices.MatrixError) as error:
        print(f"bench accept: {error}", file=sys.stderr)
        return 2
    return 0
