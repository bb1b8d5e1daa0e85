"""Runs a small set of cases, each with 1 and with 2 threads, and judges them: invariants (class I), equal
bits (II), numbers inside the envelopes of results/baselines/ (III) and costs (IV). Times are in no gate.

With --record or --matrix it judges what another program has written, against one baseline file. Exit codes: 0
green, 1 red, 2 nothing can be judged (no or bad baseline, unreadable file, no program).
"""

import argparse
import sys
import time
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.program.arguments import parser_of

from . import baseline, configs, invariants, judge, matrices, meanings, report, trend
from .baseline import Baseline
from .build_checks import judge_build
from .calibrate import copies_of
from .cases import Case, case_argument, is_chosen, jittered, read_set, run_case, set_argument
from .determinism import of_one_config
from .finding import Finding, failures, without_subject
from .instructions import judge_instructions
from .measure import measure
from .records import Run, read_run
from .resume import judge_resume

OUT = ROOT / "results" / "runs" / "gate"
# Of the copy that has to confirm a number outside its envelope; no copy of a calibration has it.
REPEAT_SEED = 1001
CHAOS_SEED, CHAOS_COPIES = 2001, 8


def same_subject(kept: Baseline, run: Run, path: Path) -> None:
    """Raises UserError when the baseline is of another scene or of other settings."""
    size = configs.scene_size(run)
    settings = configs.contradictions(kept.config, run.section("config"))
    scene = [
        f"{place}: {value!r} and {size.get(place)!r}"
        for place, value in sorted(kept.scene.items())
        if value != size.get(place)
    ]
    for lines, what in ((settings, "other settings"), (scene, "another scene")):
        if lines:
            raise UserError("\n  ".join([f"{path}: a baseline of {what} than {run.path}:", *lines]))


def numbers(
    case: str,
    kept: Baseline,
    run: Run,
    same_build_kind: bool,
    new: tuple[str, str] = judge.not_in_the_baseline(),
) -> list[Finding]:
    """The lines of classes III to V of a run. What only some copies had at the calibration, or means
    something else in the baseline's version, is shown and not judged. new: of what the baseline lacks.
    """
    metrics, values, not_compared = meanings.shared(
        case, kept.metrics, measure(run), kept.version, run.version
    )
    lines = not_compared + judge.numbers(case, metrics, values, same_build_kind, new=new)
    for f in lines:
        if f.metric in kept.unsteady and f.metric not in kept.metrics:
            f.verdict, f.judged, f.note = "not_judged", 0, "only some copies of the calibration had it"
    return lines


def _confirmed(
    findings: list[Finding], case: Case, kept: Baseline, out: Path, size_m: float, same_build_kind: bool
) -> list[Finding]:
    """A number outside its envelope, or a cost that is too dear, is red when a copy with another seed is
    outside as well.
    """
    outside = {f.metric for f in failures(findings)}
    if not outside or not size_m > 0:
        return findings
    again = jittered(case, out, REPEAT_SEED, size_m)
    second = {f.metric for f in failures(numbers(case.name, kept, again, same_build_kind))}
    for f in findings:
        if f.metric in outside & second:
            f.note += "; confirmed by a copy"
        elif f.metric in outside:
            f.verdict, f.note = "pass", f"{f.note}; a copy with another seed is inside"
    return findings


def judge_case(case: Case, kept: Baseline, path: Path, out: Path) -> tuple[list[Finding], list]:
    """The lines of one case, and the samples of its chaotic metrics (judged with those of all cases)."""
    runs = [run_case(case, out / case.name / f"threads-{threads}", threads) for threads in (1, 2)]
    first = runs[0]
    findings = invariants.judge(case.name, first)
    findings += invariants.judge(f"{case.name}, {runs[1].threads} threads", runs[1])
    findings += of_one_config(case.name, runs)
    if case.resumed:
        findings.append(judge_resume(case, out / case.name / "resumed", first))
    same_subject(kept, first, path)
    same_kind = bool(kept.made_by) and kept.made_by == first.made_by
    size_m = first.section("scene").get("extent_m") or 0.0
    lines = numbers(case.name, kept, first, same_kind)
    findings += meanings.without_version(case.name, kept.record_version)
    findings += _confirmed(lines, case, kept, out / case.name / "repeat", size_m, same_kind)
    metrics, _, _ = meanings.shared(case.name, kept.metrics, {}, kept.version, first.version)
    chaotic = judge.chaotic(metrics)
    folder = out / case.name / "copies"
    copies = copies_of(case, folder, CHAOS_COPIES, size_m, CHAOS_SEED) if chaotic else ()
    values = [(metric.name, value) for run in copies for metric, value in measure(run).items()]
    return findings, [
        (case.name, name, k, [value for other, value in values if other == name])
        for name, k in chaotic.items()
    ]


def run_set(name: str, baselines: Path, out: Path, only: list[str]) -> list[Finding]:
    """Raises UserError, RecordError. Every baseline is read before the first run."""
    cases = [case for case in read_set(name) if is_chosen(case.name, only)]
    if not cases:
        raise UserError(f"set {name}: no case whose name contains {' or '.join(only)}")
    kept = {case.name: baseline.read(baselines / f"{case.name}.json", case.name, "run") for case in cases}
    findings, samples = judge_build(), []
    for case in cases:
        start = time.monotonic()
        lines, chaotic = judge_case(case, kept[case.name], baselines / f"{case.name}.json", out)
        red = len(failures(lines))
        print(
            f"gate: {case.name}: {f'{red} failed' if red else 'green'} ({time.monotonic() - start:.1f} s)",
            file=sys.stderr,
        )
        findings += lines
        samples += chaotic
    return findings + (judge.distributions(samples) if samples else [])


def judge_record(record: Path, path: Path) -> list[Finding]:
    """A record that is there, against one baseline."""
    kept, run = baseline.read(path, kind="run"), read_run(record)
    same_subject(kept, run, path)
    case = kept.case or str(record)
    lines = invariants.judge_stored(case, run)
    lines += meanings.of_other_version(case, [run], kept.version, run.version)
    lines += meanings.without_version(case, kept.record_version)
    same_kind = bool(kept.made_by) and kept.made_by == run.made_by
    new = judge.not_in_the_baseline("bench gate accept --record")
    return lines + numbers(case, kept, run, same_kind, new)


def findings_case(findings: list[Finding]) -> str:
    """A case that was run: its record says which commit the numbers are of."""
    return next(f.case for f in findings if f.gate_class == "III")


def _to_hold(args: argparse.Namespace) -> str:
    """The commands that make better numbers the baseline."""
    if args.baseline:
        option = "--matrix" if args.matrix else "--record"
        return baseline.how_to_accept(option, args.baseline, "--better")
    return 'bench gate calibrate, then bench gate accept --better --reason "..."'


def arguments(argv: list[str]) -> argparse.Namespace:
    parser = parser_of("gate run", __doc__, "./bench gate")
    set_argument(parser)
    case_argument(parser)
    baseline.folder_argument(parser)
    record = {"help": "judge this record instead of running anything"}
    baseline.other_program_arguments(parser, record, "judge these Matrix Market files instead")
    parser.add_argument(
        "--out", type=Path, default=OUT, metavar="DIR", help="runs and gate.json (default: results/runs/gate)"
    )
    parser.add_argument(
        "--instructions",
        action="store_true",
        help="count instructions with valgrind as well, where the baseline has them",
    )
    parser.add_argument(
        "--history", type=Path, metavar="FILE", help="append the numbers to this file, for ./bench gate trend"
    )
    report.verbose_argument(parser)
    args = parser.parse_args(argv)
    baseline.check_other_program(args)
    return args


@reported("gate run")
def main(argv: list[str]) -> int:
    args = arguments(argv)
    if args.record:
        findings, required = judge_record(args.record, args.baseline), ("I", "III")
    elif args.matrix:
        findings, required = matrices.judge_matrices(args.matrix, args.baseline), ("I", "III")
    else:
        findings, required = run_set(args.set, args.baselines, args.out, args.case), ("I", "II", "III", "IV")
        if args.instructions:
            findings += judge_instructions(args.set, args.baselines, args.case)
    findings += without_subject(findings, required)
    report.say(findings, args.verbose)
    if any(f.verdict == "better" for f in findings):
        print(f"bench gate run: to hold the better numbers from now on: {_to_hold(args)}", file=sys.stderr)
    if args.history and not args.baseline:
        made = read_run(args.out / findings_case(findings) / "threads-1", allow_not_finite=True)
        commit = made.section("provenance").get("git_commit", "")
        line = trend.line_of(findings, commit, made.section("status").get("started_utc", ""))
        trend.append(args.history, line)
    report.write_json(
        args.out / "gate.json", "barrierbench.gate", findings, set=None if args.baseline else args.set
    )
    return 1 if failures(findings) else 0
