"""Measures what `bench gate accept` may keep: each case of a set as it is, and 20 copies whose start is
perturbed by 1e-12 of its size.

Nothing of results/baselines/ is changed: the proposals stand in results/runs/calibration/ until
`bench gate accept --reason "..."`.
"""

import datetime
import sys
from collections.abc import Iterator
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.program.arguments import parser_of

from . import baseline, invariants, shares
from .baseline import Baseline, Kept, keep
from .cases import Case, case_argument, is_chosen, jittered, read_set, run_case, set_argument
from .configs import scene_size
from .envelope import Envelope, calibrate, scatter_above
from .finding import failures
from .instructions import instructions_of
from .measure import measure
from .metrics import Metric
from .records import Run

OUT = ROOT / "results" / "runs" / "calibration"
COPIES = 20


def copies_of(case: Case, out: Path, n: int, size_m: float, first_seed: int = 1) -> Iterator[Run]:
    """Perturbed copies, with 1 and 2 threads in turn."""
    if not size_m > 0:
        raise UserError(f"{case.name}: the scene has no size to perturb")
    for k in range(n):
        yield jittered(case, out / f"copy-{k:02d}", first_seed + k, size_m, 1 + k % 2)


MAY_BE_ABSENT = ("1", shares.UNIT)  # units of numbers that a record leaves out where they are 0


def samples(runs: list[Run]) -> tuple[dict[Metric, list[float]], list[str]]:
    """The values of every metric, one a run, and the names of those that only some runs have though they are
    no 0.
    """
    measured, values, unsteady = [measure(run) for run in runs], {}, []
    for metric in dict.fromkeys(metric for numbers in measured for metric in numbers):
        if metric.gate_class == "V":
            continue
        if metric.unit not in MAY_BE_ABSENT and any(metric not in numbers for numbers in measured):
            unsteady.append(metric.name)
        else:
            values[metric] = [numbers.get(metric, 0.0) for numbers in measured]
    return values, sorted(unsteady)


def envelopes(values: dict[Metric, list[float]]) -> dict[str, Kept]:
    """`value` of a cost is that of the first run, which has no perturbation."""
    kept = {}
    for metric, sample in values.items():
        e = calibrate(metric, sample)
        if metric.gate_class == "IV":
            e = Envelope(sample[0], min(e.lower, sample[0]), max(e.upper, sample[0]), e.n)
        kept[metric.name] = keep(metric, e)
        if metric.gate_class == "IV":
            kept[metric.name].scatter = scatter_above(sample)
    return kept


def propose(case_name: str, runs: list[Run], reason: str = "") -> Baseline:
    """What a baseline of these runs would be. Raises UserError when one of them breaks an invariant: that is
    never accepted.
    """
    lines = [f for run in runs for f in invariants.judge(f"{case_name}: {run.path}", run, foreign=True)]
    if red := failures(lines):
        head = "a run that breaks an invariant (class I) makes no baseline:"
        raise UserError("\n  ".join([head, *(f"{f.case}: {f.metric}: {f.note}" for f in red)]))
    versions = sorted({run.version for run in runs})
    if len(versions) > 1:
        raise UserError(
            f"{case_name}: records of versions {', '.join(versions)}: a baseline is of records of one version"
        )
    values, unsteady = samples(runs)
    first, kept = runs[0], envelopes(values)
    if not kept:
        raise UserError(f"{case_name}: no number that all {len(runs)} records have")
    provenance, seeds = first.section("provenance"), runs[-1].section("config").get("seeds") or {}
    at = {"commit": provenance.get("git_commit", ""), "dirty": provenance.get("git_dirty"), "runs": len(runs)}
    at |= {"jitter_m": seeds.get("jitter_m", 0), "date": datetime.date.today().isoformat()}
    at["record_version"] = first.version
    config = {key: value for key, value in first.section("config").items() if key not in ("threads", "seeds")}
    return Baseline(case_name, "run", reason, at, kept, config, scene_size(first), first.made_by, unsteady)


def calibrate_case(case: Case, out: Path, copies: int) -> Baseline:
    first = run_case(case, out / "as-it-is", 1)
    size_m = first.section("scene").get("extent_m") or 0.0
    proposal = propose(case.name, [first, *copies_of(case, out, copies, size_m)])
    if count := instructions_of(case):
        proposal.metrics["instructions"] = count
    return proposal


@reported("gate calibrate")
def main(argv: list[str]) -> int:
    parser = parser_of("gate calibrate", __doc__)
    set_argument(parser)
    case_argument(parser)
    parser.add_argument("--copies", type=int, default=COPIES, help=f"perturbed copies (default: {COPIES})")
    to = "default: results/runs/calibration"
    parser.add_argument("--out", type=Path, default=OUT, metavar="DIR", help=to)
    args = parser.parse_args(argv)
    if args.copies < 1:
        raise UserError(f"--copies {args.copies}: at least 1")
    for case in (case for case in read_set(args.set) if is_chosen(case.name, args.case)):
        proposal = calibrate_case(case, args.out / case.name, args.copies)
        path = args.out / f"{case.name}.json"
        baseline.write(proposal, path)
        chaotic = sorted(name for name, kept in proposal.metrics.items() if kept.envelope.sample)
        words = [f"{path}: {len(proposal.metrics)} metrics of {args.copies + 1} runs"]
        if chaotic:
            words.append(f"chaotic: {', '.join(chaotic)}")
        if proposal.unsteady:
            words.append(f"not in all runs, so not judged: {', '.join(proposal.unsteady)}")
        print("; ".join(words))
    said = './bench gate accept --reason "..." makes these the baselines'
    print(f"bench gate calibrate: {said}", file=sys.stderr)
    return 0
