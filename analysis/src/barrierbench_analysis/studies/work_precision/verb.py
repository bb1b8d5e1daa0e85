"""Runs what is missing of a work-precision spec, measures every run against its reference, and writes
results/work_precision.json, results/WORK_PRECISION.md and docs/work_precision_*.png: error against seconds,
Newton iterations, factorisations and products.

Exit codes: 0 written, 2 it cannot be judged (a bad spec, records missing, --no-run with numbers of another
spec, a reference run that failed, an error that is no number; no program).
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from barrierbench_analysis.figures.figure_files import copy_to_page
from barrierbench_analysis.io.errors import tells
from barrierbench_analysis.io.json_file import read_of_schema
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.store import a_line_each, check_digest
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import parser_of
from barrierbench_analysis.tables.numbers import rounded

from . import figure, report
from .runs import RUNS, collect, run_scene
from .spec import Spec, read_spec

DEFAULT = ROOT / "configs" / "work_precision" / "default.json"
TABLE = "barrierbench.work_precision_table/1"


def arguments(argv: list[str]) -> argparse.Namespace:
    parser = parser_of(
        "study work-precision", __doc__, "./bench study work-precision my_spec.json --out results/runs/mine"
    )
    parser.add_argument(
        "spec",
        nargs="?",
        type=Path,
        default=DEFAULT,
        help="configs/work_precision/NAME.json (default: default.json)",
    )
    parser.add_argument(
        "--no-run",
        action="store_true",
        help="run nothing: make page and figures of the numbers in work_precision.json",
    )
    parser.add_argument(
        "--runs",
        type=Path,
        default=RUNS,
        metavar="DIR",
        help="folder of the sweeps (default: results/runs/work_precision)",
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help=(
            "folder of table, page and figures (default: results/ and docs/ for default.json, else"
            " results/runs/work_precision/NAME)"
        ),
    )
    return parser.parse_args(argv)


def made(spec: Spec, runs: Path) -> dict:
    """The table of all scenes."""
    for scene in spec.scenes:
        run_scene(spec, scene, runs)
    return {
        "schema": TABLE,
        "name": spec.name,
        "doc": spec.doc,
        "spec_sha256": spec.sha256,
        "scenes": [collect(spec, scene, runs) for scene in spec.scenes],
    }


def table_text(table: dict) -> str:
    """One line a run."""
    scenes = []
    for scene in table["scenes"]:
        head = json.dumps({k: v for k, v in scene.items() if k != "rows"})[:-1]
        rows = a_line_each((json.dumps(row, separators=(",", ":")) for row in scene["rows"]), 3)
        scenes.append(f'{head}, "rows": {rows}}}')
    head = json.dumps({k: v for k, v in table.items() if k != "scenes"})[:-1]
    return f'{head}, "scenes": {a_line_each(scenes, 2)}}}\n'


def read_table(file: Path) -> dict:
    """Errors: UserError."""
    return read_of_schema(file, TABLE, "; ./bench study work-precision makes it")


def read_for(file: Path, spec: Spec) -> dict:
    """The kept table. Errors: UserError where it is of another spec."""
    table, again = read_table(file), f"./bench study work-precision {spec.file}"
    check_digest(file, "spec_sha256", table.get("spec_sha256"), spec.sha256, "spec", again)
    return table


def write_all(table: dict, results: Path, docs: Path, scratch: Path) -> None:
    """Page and figures; the pictures with their captions go to docs."""
    write_whole(results / "WORK_PRECISION.md", report.markdown(table))
    ranks = figure.by_rank(table["scenes"])
    drawn = [
        figure.draw(scene, scratch / f"work_precision_{scene['name']}", ranks) for scene in table["scenes"]
    ]
    drawn.append(figure.draw_profile(table["scenes"], scratch / "work_precision_profile"))
    copy_to_page((path for paths in drawn for path in paths), docs)


@tells("study work-precision")
def main(argv: list[str]) -> int:
    args = arguments(argv)
    spec = read_spec(args.spec)
    if args.spec.resolve() == DEFAULT and args.out is None:
        results, docs = ROOT / "results", ROOT / "docs"
    else:
        results = args.out or RUNS / spec.name
        docs = results / "docs" if args.out is None else results
    file = results / "work_precision.json"
    if not args.no_run:
        write_whole(file, table_text(rounded(made(spec, args.runs))))
    table = read_for(file, spec)
    print(report.text(table))
    write_all(table, results, docs, args.runs / "figure")
    return 0
