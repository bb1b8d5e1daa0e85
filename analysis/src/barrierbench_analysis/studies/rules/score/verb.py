"""`bench study score`: one page for a new barrier."""

import argparse
import json
import shlex
import sys
import time
from dataclasses import replace
from pathlib import Path

from barrierbench_analysis.io.errors import reported
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import count_from_1, parser_of
from barrierbench_analysis.studies.kit.study.page import rows_of
from barrierbench_analysis.studies.kit.study.spec import Study, read_study
from barrierbench_analysis.studies.kit.study.verb import make_rows

from .candidate import Candidate, candidate
from .page import page

SPEC = ROOT / "configs" / "score" / "score.json"
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
    parser.add_argument(
        "--jobs", type=count_from_1, default=2, metavar="N", help="runs at a time (default 2)"
    )
    return parser.parse_args(argv)


def study_of(of: Candidate, out: Path) -> Study:
    """The study of configs/score/score.json with this candidate, whose runs and rows lie in a folder."""
    study = read_study(str(SPEC), out)
    about = study.about | {"candidate": vars(of)}
    plugins = [str(Path(file).resolve()) for file in of.plugins]
    return replace(study, data={**study.data, "about": about, "plugins": plugins})


@reported("study score")
def main(argv: list[str]) -> int:
    """0: scored; 2: nothing that can be scored."""
    args = _arguments(argv)
    begun = time.monotonic()
    of = candidate(args.what)
    out = args.out or ROOT / "results" / "runs" / "score" / of.label
    study = study_of(of, out)
    made = make_rows(study, jobs=args.jobs)
    print(f"score: {made} runs, {time.monotonic() - begun:.0f} s", file=sys.stderr)
    rows = rows_of(study)
    score = {
        "schema": SCHEMA,
        "candidate": {"label": of.label, "formulation": of.formulation, "about": of.about},
        "command": shlex.join(["./bench", "study", "score", *of.place]),
        "machine": next((row.origin["machine"] for row in rows if row.run), ""),
        "seconds": round(time.monotonic() - begun, 1),
        **study.module.rule(study, rows),
    }
    write_whole(out / "score.json", json.dumps(score, indent=1, allow_nan=False) + "\n")
    write_whole(out / "score.html", page(score))
    print("\n".join(score["decides"]))
    print(out / "score.html")
    return 0
