"""Makes what `bench gate calibrate` measured the baseline, and says why in the file. It prints old and new of
all that changes.

With --record or --matrix the baseline is made of what another program has written. Class I and II are exact:
there is nothing to accept, and a run that breaks an invariant makes no baseline. The first baseline of a
number is kept beside the last, and what has drifted from it stays red until --drift (drift.py).
"""

import argparse
import datetime
from dataclasses import replace
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.record_file import other_meanings
from barrierbench_analysis.program.arguments import parser_of

from . import baseline, calibrate, judge, matrices
from .baseline import Baseline, Kept
from .cases import case_argument, is_chosen
from .drift import First, digest
from .finding import moved
from .meanings import FAMILIES, shared
from .metrics import NEVER_RECORDED
from .records import read_run
from .report import number


def _envelope(kept) -> str:
    e = kept.envelope if kept else None
    return f"{number(e.value)} [{number(e.lower)}, {number(e.upper)}]" if e else "-"


def changes(old: Baseline | None, new: Baseline) -> dict[str, str]:
    """A line for every metric whose envelope changes: old, new, direction."""
    lines, before = {}, old.metrics if old else {}
    for name in sorted(before.keys() | new.metrics.keys()):
        a, b = before.get(name), new.metrics.get(name)
        if a and b and a.envelope == b.envelope:
            continue
        direction = moved(b.envelope.value, a.envelope.value, b.unit) if a and b else "new" if b else "gone"
        lines[name] = f"  {name}: {_envelope(a)} -> {_envelope(b)}  {direction}"
    return lines


def better(old: Baseline, new: Baseline) -> list[str]:
    """Metrics whose new value is beyond the old envelope on the good side; a cost by what the gate calls
    better.
    """

    def beyond(b: Kept, a: Kept) -> bool:
        e = a.envelope
        lower = min(e.lower, e.value / judge.COST_EACH) if b.gate_class == "IV" else e.lower
        return judge.outside(b.direction, b.envelope.value, lower, e.upper) == "better"

    both = sorted(new.metrics.keys() & old.metrics.keys())
    return [name for name in both if beyond(new.metrics[name], old.metrics[name])]


def _only(old: Baseline | None, new: Baseline, metrics: list[str], path: Path) -> Baseline:
    """The old baseline with these metrics of the new one."""
    if refused := [name for name in metrics if name in NEVER_RECORDED]:
        raise UserError(
            f"{', '.join(refused)}: class I and II are exact and are never accepted; mend the code"
        )
    if old is None:
        raise UserError(f"{path}: --metric and --better change a baseline, and there is none yet")
    if fields := [name for name in other_meanings(old.version, new.version) if name in FAMILIES]:
        raise UserError(
            f"{path}: of record version {old.record_version}, in which {', '.join(fields)} mean something"
            " else: --metric and --better would mix two versions; accept all of it"
        )
    if unknown := [name for name in metrics if name not in new.metrics]:
        raise UserError(f"{', '.join(unknown)}: not measured; one of {', '.join(sorted(new.metrics))}")
    return replace(old, metrics=old.metrics | {name: new.metrics[name] for name in metrics})


def _remember(old: Baseline, new: Baseline) -> None:
    """What waits for an issue goes on waiting, and every number keeps what its first baseline said; one that
    meant something else then starts anew.
    """
    new.drifts = list(old.drifts)
    at = old.calibrated_at
    comparable, _, _ = shared(new.case, old.metrics, {}, old.version, new.version)
    for name, was in old.metrics.items():
        if (now := new.metrics.get(name)) and now is not was:
            now.xfail = was.xfail or now.xfail
            if name not in comparable:
                continue
            words = at.get("date", ""), at.get("commit", ""), old.reason, digest(old.made_by)
            first = was.first or First(was.envelope.value, *words)
            now.first = replace(first, here=bool(new.made_by) and first.made_by == digest(new.made_by))


def _take_drifts(new: Baseline, names: list[str]) -> None:
    """These numbers start anew from their last values; the baseline says so."""
    if not names:
        return
    moves = {name: [new.metrics[name].first.value, new.metrics[name].envelope.value] for name in names}
    at = {"date": datetime.date.today().isoformat(), "commit": new.calibrated_at.get("commit", "")}
    new.drifts.append({**at, "reason": new.reason, "metrics": moves})
    for name in names:
        new.metrics[name].first = None


def keep(
    new: Baseline, path: Path, reason: str, metrics: list[str], only_better=False, take_drift=False
) -> None:
    old = baseline.read(path) if path.exists() else None
    lines = changes(old, new)
    if only_better:
        metrics = better(old, new) if old else []
    if metrics or only_better:
        lines = {name: line for name, line in lines.items() if name in metrics}
        new = _only(old, new, metrics, path)
    new.reason = reason
    if old:
        _remember(old, new)
    here = bool(new.made_by)
    drifts = sorted(n for n, kept in new.metrics.items() if judge.drifted(kept, kept.envelope.value, here))
    if take_drift:
        _take_drifts(new, drifts)
    baseline.write(new, path)
    print("\n".join([f"{path}: {len(lines)} of {len(new.metrics)} metrics changed", *lines.values()]))
    if drifts:
        end = (
            "accepted: they start anew"
            if take_drift
            else 'the gate stays red for them; --drift --reason "..." if it is meant'
        )
        print(f"  drifted from the first baseline: {', '.join(drifts)} ({end})")
    if old and not metrics and (offered := better(old, new)):
        print(f"  better than before: {', '.join(offered)} (--better accepts these alone)")


def _check(args: argparse.Namespace) -> None:
    """Errors: UserError for options that do not go together, and for a reason that is none."""
    baseline.check_other_program(args)
    if not args.reason.strip():
        raise UserError("--reason: say why in a sentence")
    if args.better and args.metric:
        raise UserError("--better chooses the metrics itself; leave --metric out")


def arguments(argv: list[str]) -> argparse.Namespace:
    parser = parser_of("gate accept", __doc__)
    parser.add_argument(
        "--reason", required=True, help="why the numbers may change; it stays in the baseline"
    )
    case_argument(parser)
    parser.add_argument(
        "--metric", action="append", default=[], metavar="NAME", help="only this metric (repeatable)"
    )
    parser.add_argument(
        "--better", action="store_true", help="only metrics that are better than their envelope"
    )
    drift = "numbers that have drifted from their first baseline start anew; the baseline keeps when and why"
    parser.add_argument("--drift", action="store_true", help=drift)
    made = "of bench gate calibrate (default: results/runs/calibration)"
    parser.add_argument("--proposals", type=Path, default=calibrate.OUT, metavar="DIR", help=made)
    baseline.folder_argument(parser)
    record = {"nargs": "+", "help": "make the baseline of these records of one config"}
    baseline.other_program_arguments(parser, record, "make the baseline of these matrices")
    args = parser.parse_args(argv)
    _check(args)
    return args


@reported("gate accept")
def main(argv: list[str]) -> int:
    args = arguments(argv)
    how = args.reason, args.metric, args.better, args.drift
    if args.record:
        runs = [read_run(path) for path in args.record]
        keep(calibrate.propose(args.baseline.stem, runs), args.baseline, *how)
        return 0
    if args.matrix:
        keep(matrices.propose(args.matrix, args.baseline.stem), args.baseline, *how)
        return 0
    proposals = [p for p in sorted(args.proposals.glob("*.json")) if is_chosen(p.stem, args.case)]
    if not proposals:
        raise UserError(f"{args.proposals}: no proposal; `bench gate calibrate` makes them")
    for path in proposals:
        keep(baseline.read(path, path.stem, "run"), args.baselines / path.name, *how)
    return 0
