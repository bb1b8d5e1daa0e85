"""Runs the sweeps of the README, of each as many runs at a time as there are cores, then makes their figures,
their table and the page that says what they show, and ends with the answer: what each formulation took, which
failures were expected, and which files to open. Records that this program has made are not run again.

Exit codes: 0 all is there, 1 a run does not keep what the demonstration promises, else that of the sweep that
failed first.
"""

import importlib
import time
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.program.arguments import options, parser_of
from barrierbench_analysis.program.building import job_count, say
from barrierbench_analysis.program.start import run_sweep

OUT = ROOT / "results/runs/demo"
# configs/sweeps/NAME.json
SWEEPS = [f"demo_{name}" for name in ("equal_gap", "drape", "long", "strip", "pinned", "article")]


def run_all(out: Path, jobs: int) -> int:
    """Every sweep into its folder below `out`, `jobs` runs at a time; a run has its row when it ends. Returns
    the exit code of the first one that failed, or 0.
    """
    begun = time.monotonic()
    say(f"{', '.join(SWEEPS)}: {jobs} runs at a time, minutes")
    failed = 0
    for name in SWEEPS:
        file = ROOT / f"configs/sweeps/{name}.json"
        done = run_sweep(file, out / name, "--jobs", str(jobs), "--progress", "none", stdout=None)
        say(f"{name} ended, {time.monotonic() - begun:.0f} s since the start\n")
        failed = failed or done.returncode
    return failed


@reported("demo")
def main(argv: list[str]) -> int:
    parser = parser_of("demo", __doc__, "./bench demo --jobs 1 --out results/runs/demo_again")
    text = """
--out DIR: folder of the records (default: results/runs/demo)
--jobs N: runs at a time (default: one a core)"""
    options(parser, text, out={"type": Path, "default": OUT}, jobs={"type": int, "default": job_count()})
    args = parser.parse_args(argv)
    if args.jobs < 1:
        raise UserError(f"--jobs: found {args.jobs}; a number from 1 on is needed")
    begun = time.monotonic()
    if code := run_all(args.out, args.jobs):
        return code
    code = importlib.import_module("barrierbench_analysis.figures.plots.demo").make(args.out, None)
    report = importlib.import_module("barrierbench_analysis.pages.report.verb")
    page = args.out / "report.html"
    print("\n" + report.report(args.out, page, args.out / "figures") + "\n")
    closing = importlib.import_module("barrierbench_analysis.pages.report.closing")
    print("\n".join(closing.lines(args.out, page, args.out / "figures")))
    say(f"runs and figures took {(time.monotonic() - begun) / 60:.1f} minutes, {args.jobs} runs at a time")
    return code
