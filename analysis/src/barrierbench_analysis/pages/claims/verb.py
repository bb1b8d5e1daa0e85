"""Runs the sweeps that decide the claims in claims/ (records that are there are skipped), computes every
verdict from the records by the rule of its claim, and writes results/CLAIMS.md, all parts as
results/CLAIMS.csv, the sweeps as results/CLAIMS_SWEEPS.csv, the numbers used (results/studies/claims.jsonl)
and docs/claims.png. With names of claims it runs the sweeps of these alone. Confirmation sweeps are run for
claims that are registered (--register ID, then commit claims/confirmation/registry.json). plan: counts the
runs, those that are kept, and what the rest is expected to take. page: judges the records that are there, or
the kept numbers. --export FILE: writes the verdicts as edges of the public graph of claims.

Exit codes: 0 verdicts written, 2 a claim cannot be judged (records missing, with the command that makes them;
a bad entry; no program), or calls itself confirmed and is not.
"""

import argparse
import subprocess
import sys
import time
from pathlib import Path

from barrierbench_analysis.figures.figure_files import copy_to_page
from barrierbench_analysis.io.errors import UserError, passed_on, reported
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import parser_of, plugin_argument
from barrierbench_analysis.program.start import built_program, run_sweep
from barrierbench_analysis.studies.claims import coverage, figure, frontiers, registry
from barrierbench_analysis.studies.claims.entry import ROOT, Claim, ids, read_claim, read_sweep
from barrierbench_analysis.studies.claims.judge import Answer, judge, missing
from barrierbench_analysis.studies.claims.plan import plan, sweeps_to_run
from barrierbench_analysis.studies.claims.proofs import Eval
from barrierbench_analysis.studies.claims.table import FILE, RUNS, Table, collect, read, used_metrics, write

from . import graph, parts_file, report

# Options with which no sweep is run -> what is done instead.
NOTHING_IS_RUN = {
    "--plan": "count the runs, and the seconds that the missing ones are expected to take",
    "--no-run": "judge the records that are there, or the kept numbers",
    "--register": f"write rule and confirmation sweeps of these claims to {registry.KEPT}; commit it before"
    " the first run",
    "--coverage": "simulate how often the intervals cover, and write results/COVERAGE.md",
}


def program(needed: bool = True) -> str | None:
    """None where it is not needed and not built."""
    try:
        return str(built_program("; --no-run judges the numbers that are kept"))
    except UserError:
        if needed:
            raise
        return None


def run_sweeps(claims: list[Claim], runs: Path, plugins: list[str]) -> None:
    entries = registry.read()
    for claim in claims:
        if claim.id in entries:
            registry.ready(claim, entries)
    for name in sweeps_to_run(claims, entries):
        sweep, start = read_sweep(name), time.monotonic()
        print(f"claims: {name}: {len(sweep.cases)} cases", file=sys.stderr)
        done = run_sweep(ROOT / sweep.file, runs / name, plugins=plugins, stdout=subprocess.DEVNULL)
        if done.returncode != 0:
            raise UserError(
                f"{sweep.file}: the program ended with {done.returncode}", passed_on(done.returncode)
            )
        print(f"claims: {name}: {time.monotonic() - start:.0f} s", file=sys.stderr)


def gather(claims: list[Claim], runs: Path, kept: Table) -> Table:
    """Records where a sweep has any, else the numbers that are kept. Metrics are those of all claims."""
    everything = [read_claim(name) for name in ids()]
    metrics, table = used_metrics(everything), Table(dict(kept.sweeps), dict(kept.answers))
    for name in dict.fromkeys(name for claim in claims for name in claim.sweeps + claim.confirmation_sweeps):
        if any((runs / name).glob("*/run.json")):
            table.sweeps[name] = collect(read_sweep(name), runs / name, metrics[name])
    return table


def arguments(argv: list[str]) -> argparse.Namespace:
    parser = parser_of(
        "study claims",
        __doc__,
        "./bench study claims run K3",
        "./bench study claims page",
        "./bench study claims --register K3",
        "./bench study claims --export out/claims.yaml",
    )
    parser.add_argument("ids", nargs="*", metavar="ID", help="claims/ID.json (default: all)")
    for option, text in NOTHING_IS_RUN.items():
        parser.add_argument(option, action="store_true", help=f"run nothing: {text}")
    of_sweeps = "folder of the sweeps (default: results/runs/claims)"
    parser.add_argument("--runs", type=Path, default=RUNS, metavar="DIR", help=of_sweeps)
    graph_of = (
        "run nothing: write the kept verdicts as edges of the public graph of claims (JSON, so YAML too)"
    )
    parser.add_argument("--export", type=Path, metavar="FILE", help=graph_of)
    before = "with --register, where the scenes were run before: when, and by which rule; the page says so"
    parser.add_argument("--run-before", default="", metavar="TEXT", help=before)
    plugin_argument(parser)
    return parser.parse_args(argv)


@reported("study claims")
def main(argv: list[str]) -> int:
    args = arguments(argv)
    if args.coverage:
        return write_coverage()
    claims = [read_claim(name) for name in args.ids or ids()]
    if args.register:
        return register(claims if args.ids else [], args.runs, args.run_before)
    if args.plan:
        print("\n".join(plan(claims, gather(claims, args.runs, read(FILE)), registry.read())))
        return 0
    if args.export:
        return export(claims, args)
    return judge_all(claims, args)


def judged_kept(claims: list[Claim], table: Table, asker: Eval) -> list[Answer]:
    """Errors: UserError for records that are missing."""
    if absent := [line for claim in claims for line in missing(claim, table)]:
        raise UserError("\n".join(absent))
    return [judge(claim, table, asker) for claim in claims]


def export(claims: list[Claim], args: argparse.Namespace) -> int:
    table = gather(claims, args.runs, read(FILE))
    answers = judged_kept(claims, table, Eval(None, table.answers))
    write_whole(args.export, graph.text(answers, table))
    print(f"claims: {len(answers)} verdicts: {args.export}")
    return 0


def judge_all(claims: list[Claim], args: argparse.Namespace) -> int:
    if not args.no_run:
        run_sweeps(claims, args.runs, args.plugin)
    table = gather(claims, args.runs, read(FILE))
    asker = Eval(program(not args.no_run), table.answers, fresh=not args.no_run, plugins=tuple(args.plugin))
    answers = judged_kept(claims, table, asker)
    print(report.text(answers))
    write_all(table, asker)
    if refused := [
        f"{a.claim.id} calls itself confirmed and is not: {a.state.why}" for a in answers if a.state.refused
    ]:
        raise UserError("\n".join(refused))
    return 0


def write_coverage() -> int:
    text = coverage.markdown()
    write_whole(ROOT / "results" / "COVERAGE.md", text)
    print(text)
    return 0


def register(claims: list[Claim], runs: Path, run_before: str) -> int:
    if not claims:
        raise UserError("--register needs the claims to register, e.g. --register K3")
    table = gather(claims, runs, read(FILE))
    for claim in claims:
        entry = registry.register(claim, table, run_before=run_before)
        print(
            f"{claim.id}: registered on {entry['date']}, rule {entry['rule_sha256'][:12]}, sweeps"
            f" {', '.join(entry['sweeps'])}. Commit {registry.KEPT} before {claim.command}"
        )
    return 0


def write_all(table: Table, asker: Eval) -> None:
    """The table, the page and the figure, of all claims."""
    answers = [judge(read_claim(name), table, asker) for name in ids()]
    if not set(ids()) - {a.claim.id for a in answers if a.parts or a.claim.waits_for}:
        table.answers = {text: table.answers[text] for text in asker.asked}
    write(table, FILE)
    pages = {
        "CLAIMS.md": report.markdown(answers, table),
        "CLAIMS.csv": parts_file.parts_text(answers, table),
        "CLAIMS_SWEEPS.csv": parts_file.sweeps_text(table),
    }
    for name, text in pages.items():
        write_whole(ROOT / "results" / name, text)
    drawn, folder = figure.draw(answers, RUNS / "figure" / "claims"), RUNS / "figure"
    for claim in (a.claim for a in answers if frontiers.has_runs(a.claim, table)):
        runs = table.sweeps[claim.frontier["sweep"]]
        drawn += frontiers.draw(claim, runs, folder / f"policies_{claim.id}")
    copy_to_page(drawn, ROOT / "docs")
