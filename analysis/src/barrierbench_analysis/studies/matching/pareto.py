"""Runs every formulation over decades of stiffness and compares them at equal reached gap, never at equal
kappa.

Writes results/pareto.json (the numbers used), results/PARETO.md (made of it) and docs/pareto_SCENE.png.
Records that are there are not run again.

Exit codes: 0 written, 2 bad input, or a record is missing.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from pathlib import Path

from barrierbench_analysis.figures.figure_files import copy_to_page
from barrierbench_analysis.io.digests import of_text
from barrierbench_analysis.io.errors import UserError, tells
from barrierbench_analysis.io.json_file import rows_of
from barrierbench_analysis.io.origin import origin, seconds_of_run
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.store import a_line_each, check_digest, in_columns, read_store
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import parser_of, plugin_argument
from barrierbench_analysis.studies.kit.runs import collect, inputs_sha256, run

from . import pareto_figure, pareto_report
from .fronts import METRICS, PLACE, STATE, Runs, gather
from .spec import Spec, make_sweep, read_spec

SCHEMA = "barrierbench.pareto_result/1"
DEFAULT = ROOT / "configs" / "pareto" / "default.json"
COLUMNS = (*PLACE, *STATE, *METRICS)
REMEDY = "; ./bench study pareto makes it"


def _about(spec: Spec, command: str, records: list[dict], plugins: list[str]) -> dict:
    sizes = [r["scene"]["free_dofs"] for r in records]
    about = {
        "command": command,
        "spec_sha256": spec.sha256,
        "inputs_sha256": inputs_sha256(make_sweep(spec), plugins=plugins),
        "doc": spec.doc,
        "vary": spec.vary,
        "gap": {"min": "smallest", "median": "median of the smallest"}[spec.gap],
        "gaps": list(spec.gaps),
        "starts": spec.starts,
        "decades": round(math.log10(spec.scales[-1] / spec.scales[0]), 3),
        "unknowns": f"{min(sizes)} to {max(sizes)}",
        "seconds": round(sum(map(seconds_of_run, records)), 1),
    }
    rules = {f"{r['matching']['rule']}, theta {r['matching']['theta']:g}" for r in records}
    return about | {"rule": ", ".join(sorted(rules))} | origin(records)


def to_json(runs: Runs) -> str:
    return (
        f'{{"schema": "{SCHEMA}", "about": {json.dumps(runs.about)},\n "columns": {json.dumps(COLUMNS)},'
        f' "rows": {a_line_each(in_columns(runs.rows, COLUMNS), 2)}}}\n'
    )


def from_json(path: Path) -> Runs:
    """Errors: UserError."""
    return read_store(
        path, SCHEMA, lambda data: Runs(data["about"], rows_of(data, COLUMNS, path, REMEDY)), REMEDY
    )


def read_for(path: Path, spec: Spec, inputs: str) -> Runs:
    """The kept runs. inputs: inputs_sha256 of the sweep, which earlier files do not have. Errors: UserError
    where they are of another spec, or of other inputs.
    """
    runs, again = from_json(path), f"./bench study pareto {spec.path}"
    check_digest(path, "about/spec_sha256", runs.about["spec_sha256"], spec.sha256, "spec", again)
    kept = runs.about.get("inputs_sha256", inputs)
    check_digest(path, "about/inputs_sha256", kept, inputs, "base config, mesh or preset", again)
    return runs


def make(spec: Spec, command: str, folder: Path, run_missing: bool, plugins: list[str]) -> Runs:
    made = make_sweep(spec)
    if run_missing:
        print(f"pareto: {len(made.notes)} cases in {folder}", file=sys.stderr)
        run(made, folder, plugins=plugins)
    records = collect(made, folder)
    runs = Runs(_about(spec, command, list(records.values()), plugins), gather(spec, made.notes, records))
    for scene in runs.scenes:
        if not any(row["gap"] for row in runs.rows if row["scene"] == scene):
            raise UserError(
                f"{spec.path}#/scenes/{scene}: no run is in contact at the end of any step: there is no gap"
                " to compare at"
            )
    return runs


def write_page(runs: Runs, results: Path, docs: Path, figures: Path) -> None:
    for scene in runs.scenes:
        copy_to_page(pareto_figure.draw(runs, scene, figures / f"pareto_{scene}"), docs)
    write_whole(results / "PARETO.md", pareto_report.markdown(runs))


def arguments(argv: list[str]) -> argparse.Namespace:
    parser = parser_of(
        "study pareto",
        __doc__,
        "./bench study pareto configs/pareto/default.json --results results/runs/mine",
    )
    parser.add_argument(
        "spec",
        nargs="?",
        type=Path,
        default=DEFAULT,
        help="a sweep over stiffness (default: configs/pareto/default.json)",
    )
    parser.add_argument(
        "--no-run",
        action="store_true",
        help="run nothing: judge the records that are there, or the numbers in pareto.json",
    )
    parser.add_argument(
        "--runs",
        type=Path,
        metavar="DIR",
        help="folder of the records (default: results/runs/pareto/NAME-HASH)",
    )
    parser.add_argument(
        "--results",
        type=Path,
        metavar="DIR",
        help="folder of PARETO.md, pareto.json and figures (default: results/ and docs/)",
    )
    plugin_argument(parser)
    return parser.parse_args(argv)


@tells("study pareto")
def main(argv: list[str]) -> int:
    args = arguments(argv)
    results = args.results or ROOT / "results"
    spec = read_spec(args.spec)
    inputs = inputs_sha256(make_sweep(spec), plugins=args.plugin)
    digest = of_text(f"{spec.sha256} {inputs}")
    folder = args.runs or ROOT / "results" / "runs" / "pareto" / f"{spec.name}-{digest[:8]}"
    kept = results / "pareto.json"
    if args.no_run and not any(folder.glob("*/run.json")) and kept.is_file():
        runs = read_for(kept, spec, inputs)
        if "inputs_sha256" not in runs.about:
            print(
                f"bench study pareto: {kept} does not say of which base config and presets its numbers are",
                file=sys.stderr,
            )
    else:
        command = (
            "./bench study pareto"
            + ("" if args.spec.resolve() == DEFAULT else f" {args.spec}")
            + "".join(f" --plugin {file}" for file in args.plugin)
        )
        runs = make(spec, command, folder, not args.no_run, args.plugin)
    write_whole(kept, to_json(runs))
    write_page(runs, results, ROOT / "docs" if args.results is None else results, folder / "figures")
    print(
        f"{results / 'PARETO.md'}: {len(runs.rows)} runs,"
        f" {sum(row['outcome'] == 'ok' for row in runs.rows)} ok"
    )
    return 0
