"""Runs what is missing of a gap map: every shape in every scene, resolution and limit mode at targets from
0.5 to 0.001 d_hat, and what it took against the gap that it reached. Writes results/gap_map.json (the numbers
used), results/GAP_MAP.md (made of it), docs/gap_map.png and its company. The whole takes many hours of one
core: --minutes stops it between two sweeps, rows that gap_map.json keeps are not run again, and the page says
what is not run yet.

Exit codes: 0 written, 2 bad input, or nothing to write.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from barrierbench_analysis.figures.figure_files import copy_to_page
from barrierbench_analysis.io.errors import UserError, tells
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import finite_number, parser_of
from barrierbench_analysis.studies.kit.formulations import ROOT
from barrierbench_analysis.studies.kit.runs import records_in

from . import figure, plan, report
from .judge import counts
from .kept import Kept, about, digests, kept_rows, read_for, sort_out, source_of
from .rows import CANNOT, NOT_RUN, PLACE, add_rho, cannot_reach, row
from .runs import folder_of, run_missing
from .skips import skips_of
from .spec import LIMITS, PARTS, Cell, Spec, cells, limit_settings, part, read_spec
from .table import Map, read, write

DEFAULT = ROOT / "configs" / "gap_map" / "default.json"
RUNS = ROOT / "results" / "runs" / "gap_map"


def _limit_of(limit: dict) -> tuple:
    """Whether a resolved config has a strain limit, its shape, argument, policy and scale; whether alone
    where it has none.
    """
    if not limit.get("enabled"):
        return (False,)
    policy = limit.get("stiffness_policy") or {}
    return True, limit.get("shape"), limit.get("argument"), policy.get("name"), policy.get("scale", 1.0)


def _limit_asked(spec: Spec, cell: Cell) -> tuple:
    """The same of what a cell asks for."""
    asked = limit_settings(cell.limit, *spec.shapes[cell.shape], cell.theta)
    return _limit_of(
        {"enabled": cell.limit != "off", **{key.rpartition("/")[2]: value for key, value in asked.items()}}
    )


def check_cell(spec: Spec, cell: Cell, record: dict, folder: Path) -> None:
    """Errors: UserError where a record's settings are not those of its cell."""
    config = record["config"]
    found = (
        config["formulation"]["shape"],
        config["formulation"]["argument"],
        record["matching"]["theta"],
        *_limit_of(config.get("strain_limit") or {}),
    )
    asked = (*spec.shapes[cell.shape], cell.theta, *_limit_asked(spec, cell))
    size = next(s for s in spec.scenes if s.label == cell.scene).unknowns[cell.resolution]
    if record["scene"]["free_dofs"] != size:
        raise UserError(
            f"{spec.path}#/scenes/{cell.scene}/resolutions/{cell.resolution}/unknowns: found {size}; its runs"
            f" have {record['scene']['free_dofs']}"
        )
    if found != asked:
        raise UserError(
            f"{folder}/run.json: shape, argument, theta, limit {found}; {asked} is what {cell.label!r} asks"
            " for: remove this folder"
        )


def collect(
    spec: Spec, beyond: set[tuple[str, float]], runs: Path, kept: dict[tuple, tuple[dict, dict]]
) -> tuple[list[dict], list[dict]]:
    """Rows in the order of the spec, and their sources: from its record, else as an earlier call kept it. A
    cell with neither is named as not run.
    """
    folders = digests(spec)
    found = records_in(folder_of(runs, place, folders) for place in folders)
    rows, sources = [], []

    def index(source: dict) -> int:
        if source not in sources:
            sources.append(source)
        return sources.index(source)

    for cell in cells(spec):
        record, folder = found.get(f"gap_map_{spec.name}: {cell.label}", (None, None))
        if (cell.shape, cell.theta) in beyond:
            rows.append(row(cell, None, outcome=CANNOT))
        elif record is not None:
            check_cell(spec, cell, record, folder)
            rows.append(row(cell, record, folder) | {"source": index(source_of(record))})
        elif cell.key in kept:
            mine, source = kept[cell.key]
            rows.append(mine | {"source": index(source)})
        else:
            rows.append(row(cell, None))
    return rows, sources


def write_page(found: Map, spec: Spec, results: Path, docs: Path, figures: Path) -> None:
    copy_to_page(figure.draw_all(found, figures), docs)
    write_whole(results / "GAP_MAP.md", report.markdown(found, sort_out(found, spec)))


def what_arguments(parser: argparse.ArgumentParser) -> None:
    """Which runs are made: all that are missing, a part of them, none."""
    for name, text in PARTS.items():
        parser.add_argument(
            f"--{name}",
            dest="part",
            action="store_const",
            const=name,
            help=f"run no more than the part of the spec under `{name}`: {text}",
        )
    parser.add_argument(
        "--minutes",
        type=finite_number,
        metavar="M",
        help="begin no further sweep after so many minutes; what is left is said",
    )
    parser.add_argument(
        "--anew",
        action="store_true",
        help=(
            "run again what gap_map.json keeps from earlier calls or other machines; what was not run again"
            " by the end stays"
        ),
    )
    parser.add_argument(
        "--drop",
        action="store_true",
        help=(
            "write gap_map.json without its runs that do not count for the spec any more; without this option"
            " such a call is refused"
        ),
    )
    parser.add_argument(
        "--plan",
        action="store_true",
        help=(
            "say what there is to run and how long it would take, by the seconds of runs that are there; run"
            " nothing"
        ),
    )
    parser.add_argument(
        "--no-run",
        action="store_true",
        help="run nothing: judge the records that are there, or without any the numbers in gap_map.json",
    )


def skip_arguments(parser: argparse.ArgumentParser) -> None:
    """Cells whose end follows from a run that is there."""
    parser.add_argument(
        "--decided", action="store_true", help="run also the cells whose end follows from a run that is there"
    )
    parser.add_argument(
        "--spot-check",
        type=int,
        default=0,
        metavar="N",
        help="run N of the cells that were left out since another run decides them (default: 0)",
    )
    parser.add_argument("--seed", type=int, default=1, help="of the choice of these cells (default: 1)")


def arguments(argv: list[str]) -> argparse.Namespace:
    modes = "\n".join(f"  {mode:8} {text}" for mode, text in LIMITS.items())
    parser = parser_of("study gap-map", f"{__doc__}\nlimit modes:\n{modes}", "./bench study gap-map --plan")
    parser.add_argument(
        "spec",
        nargs="?",
        type=Path,
        default=DEFAULT,
        help="a gap map as data (default: configs/gap_map/default.json)",
    )
    what_arguments(parser)
    skip_arguments(parser)
    parser.add_argument(
        "--jobs", type=int, default=1, metavar="N", help="sweeps at a time, each of one thread (default 1)"
    )
    parser.add_argument(
        "--runs",
        type=Path,
        default=RUNS,
        metavar="DIR",
        help="folder of the records (default: results/runs/gap_map)",
    )
    parser.add_argument(
        "--results",
        type=Path,
        metavar="DIR",
        help="folder of GAP_MAP.md, gap_map.json and figures (default: results/ and docs/)",
    )
    args = parser.parse_args(argv)
    if args.jobs < 1:
        raise UserError(f"--jobs: found {args.jobs}; a number from 1 on is needed")
    if args.spot_check < 0:
        raise UserError(f"--spot-check: found {args.spot_check}; a number from 0 on is needed")
    for name, is_given in (("--no-run", args.no_run), ("--plan", args.plan)):
        if args.spot_check and is_given:
            raise UserError(
                f"--spot-check: found beside {name}, which runs nothing; allowed: one of the two, since a"
                " spot check runs cells"
            )
    if args.minutes is not None and not args.minutes > 0:
        raise UserError(f"--minutes: found {args.minutes}; a number above 0 is needed")
    return args


def decided(args: argparse.Namespace, rows: list[dict]) -> set[tuple]:
    """Places of the cells that this call leaves out, since other runs decide them."""
    return set() if args.decided else {skip.place for skip in skips_of(rows).left_out}


def show_plan(spec: Spec, rows: list[dict], beyond: set[tuple[str, float]], left_out: set[tuple]) -> int:
    sizes = {(s.label, r): n for s in spec.scenes for r, n in s.unknowns.items()}
    asked = [c for c in cells(spec) if (c.shape, c.theta) not in beyond and c.key not in left_out]
    print("\n".join(plan.lines(plan.estimate(asked, rows, sizes))))
    if left_out:
        print(f"{len(left_out)} more cells need no run, since others decide them (--decided runs them)")
    return 0


def check_store(kept: Path, spec: Spec) -> None:
    """Errors: UserError where the file that would be written has another map: it keeps what no other machine
    may have.
    """
    if kept.is_file() and (of := read(kept).about.get("name", "default")) != spec.name:
        raise UserError(
            f"{kept}: found the map {of!r}; {spec.path} is the map {spec.name!r}: give it a folder of its own"
            " with --results"
        )


def told_rows(kept: Path, spec: Spec) -> Kept:
    """The runs that gap_map.json keeps; what is refused of them is said, and why."""
    found = kept_rows(kept, spec)
    if found.refused:
        print(f"gap-map: {kept} has runs that do not count for {spec.path}: {found.why}", file=sys.stderr)
    return found


def check_kept(kept: Path, places: set[tuple], rows: list[dict]) -> None:
    """Errors: UserError where the file that would be written has fewer of its runs (places: PLACE of each)
    than now. It may be all that is left of them.
    """
    written = {tuple(r[column] for column in PLACE) for r in rows if r["source"] is not None}
    if lost := len(places - written):
        raise UserError(
            f"{kept}: found {len(places)} runs, of which {lost} would be gone, since they do not count for"
            " the spec any more and no record replaces them: make the new map in a folder of its own with"
            " --results DIR, or allow it with --drop"
        )


def spot_check(args: argparse.Namespace, spec: Spec, rows: list[dict]) -> None:
    """Runs a sample of the cells that were left out; their rows say how they ended."""
    sample = set(skips_of(rows).sample(args.spot_check, args.seed))
    print(f"gap-map: spot check of {len(sample)} cells that others decide", file=sys.stderr)
    chosen = [cell for cell in cells(spec) if cell.key in sample]
    run_missing(spec, chosen, args.runs, digests(spec), args.jobs, None, None)


def make_map(args: argparse.Namespace, spec: Spec, kept: Path) -> Map:
    """Runs what may be run and has no row, and writes gap_map.json. Errors: UserError, RecordError; nothing
    is run where the file would lose runs.
    """
    beyond, earlier = cannot_reach(spec), told_rows(kept, spec)
    before = earlier.counted
    if not args.drop and earlier.places - (before.keys() & {cell.key for cell in cells(spec)}):
        check_kept(kept, earlier.places, collect(spec, beyond, args.runs, before)[0])
    if not args.no_run:
        asked = part(spec, args.part) if args.part else spec
        wanted = [
            c for c in cells(asked) if (c.shape, c.theta) not in beyond and (args.anew or c.key not in before)
        ]
        ends = None if args.decided else {place: of[0]["outcome"] for place, of in before.items()}
        run_missing(spec, wanted, args.runs, digests(spec), args.jobs, args.minutes, ends)
    if args.spot_check:
        spot_check(args, spec, collect(spec, beyond, args.runs, before)[0])
    rows, sources = collect(spec, beyond, args.runs, before)
    add_rho(spec, rows)
    command = "./bench study gap-map" + ("" if args.spec.resolve() == DEFAULT else f" {args.spec}")
    found = Map(about(spec, command, rows, sources), rows)
    write(found, kept)
    if left := counts(rows)[NOT_RUN] - len(decided(args, rows)):
        print(f"gap-map: {left} of {len(rows)} cells are not run yet: {command}", file=sys.stderr)
    return found


@tells("study gap-map")
def main(argv: list[str]) -> int:
    args = arguments(argv)
    results = args.results or ROOT / "results"
    kept = results / "gap_map.json"
    spec = read_spec(args.spec)
    if args.plan:
        beyond = cannot_reach(spec)
        rows, _ = collect(spec, beyond, args.runs, told_rows(kept, spec).counted)
        return show_plan(spec, rows, beyond, decided(args, rows))
    check_store(kept, spec)
    # The page from the kept numbers, without the program.
    alone = args.no_run and kept.is_file() and next(args.runs.rglob("run.json"), None) is None
    write_page(
        read_for(kept, spec) if alone else make_map(args, spec, kept),
        spec,
        results,
        ROOT / "docs" if args.results is None else results,
        args.runs / "figures",
    )
    print(results / "GAP_MAP.md")
    return 0
