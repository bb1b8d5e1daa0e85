"""./bench study NAME run | plan | page, of every spec in configs/studies.

run: makes the runs that have no row, keeps their rows, writes the page and its figures; stop it and call it
again, and it goes on. plan: counts the cells, those that have a row, and what the rest is expected to take.
page: writes the page from the kept rows.

Exit codes: 0 done, 1 runs of a study that judges them do not pass, 2 a spec that cannot be read, or a page
whose cells are not all there.
"""

import argparse
import random
import sys
import time
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.program.arguments import count_from_1, parser_of, plugin_argument, positive_number
from barrierbench_analysis.program.start import built_program
from barrierbench_analysis.program.verbs import of_spec
from barrierbench_analysis.tables.words import counted

from . import cost, page, store
from .collect import left_out, missing, parts, run_cells
from .spec import Cell, Study, read_study


def which_arguments(parser: argparse.ArgumentParser) -> None:
    """Which cells are run."""
    parser.add_argument(
        "--only",
        action="append",
        default=[],
        metavar="AXIS=LABEL[,LABEL]",
        help="runs the cells with one of these labels on the axis alone; several times: on all of them",
    )
    parser.add_argument(
        "--part", metavar="NAME", help="runs no more than the part of the spec with this name (key `parts`)"
    )
    parser.add_argument(
        "--again", action="store_true", help="runs chosen cells that have a row, too, and replaces their rows"
    )
    parser.add_argument(
        "--decided", action="store_true", help="runs also the cells whose outcome follows from kept rows"
    )
    parser.add_argument(
        "--spot-check",
        type=count_from_1,
        default=0,
        metavar="N",
        help="runs N of the cells whose outcome follows from kept rows, chosen at random",
    )
    parser.add_argument("--seed", type=int, default=1, help="of the choice of --spot-check (default 1)")


def arguments(argv: list[str]) -> argparse.Namespace:
    """argv: the spec, which the front door puts first, and the options of a mode."""
    row = of_spec(Path(argv[0]))
    parser = parser_of(row.name, __doc__, row=row)
    parser.add_argument("--plan", action="store_true", help="counts cells and expected seconds; runs nothing")
    parser.add_argument("--no-run", action="store_true", help="writes the page from the kept rows")
    which_arguments(parser)
    parser.add_argument(
        "--minutes", type=positive_number, metavar="M", help="begins no further sweep after so many minutes"
    )
    parser.add_argument(
        "--jobs", type=count_from_1, default=1, metavar="N", help="runs at a time (default 1)"
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help="runs, rows, page and figures in this folder, apart from kept rows: repeats a study",
    )
    plugin_argument(parser)
    args = parser.parse_args(argv[1:])
    if args.spot_check and (args.plan or args.no_run):
        mode = "--plan" if args.plan else "--no-run"
        raise UserError(f"--spot-check: found beside {mode}, which runs nothing; allowed: one of the two")
    return args


def _asked(texts: list[str]) -> dict[str, list[str]]:
    """--only as axis -> labels. Errors: UserError for another form."""
    found: dict[str, list[str]] = {}
    for text in texts:
        axis, equals, labels = text.partition("=")
        if not axis or not equals or not labels:
            raise UserError(f"--only: found {text!r}; allowed: AXIS=LABEL, several labels with commas")
        found[axis] = labels.split(",")
    return found


def chosen(study: Study, only: list[str], part: str | None) -> list[Cell]:
    """The cells that a call may run. Errors: UserError for an axis or a label that no cell has, or a part
    that the spec does not name.
    """
    wanted = [(f"--only {axis}", axis, labels) for axis, labels in _asked(only).items()]
    if part is not None:
        known = study.data.get("parts", {})
        if part not in known:
            raise UserError(
                f"--part: found {part!r}; allowed: {', '.join(known) or 'none, by ' + str(study.file)}"
            )
        wanted += [
            (f"{study.file}#/parts/{part}/{axis}", axis, labels) for axis, labels in known[part].items()
        ]
    cells = study.cells
    for place, axis, labels in wanted:
        if axis not in study.names:
            raise UserError(f"{place}: found {axis!r}; allowed: {', '.join(study.names)}")
        there = list(dict.fromkeys(cell.place[axis] for cell in study.cells))
        if unknown := next((label for label in labels if label not in there), None):
            raise UserError(f"{place}: found {unknown!r}; allowed: {', '.join(there)}")
        cells = [cell for cell in cells if cell.place[axis] in labels]
    return cells


def make_rows(
    study: Study,
    cells: list[Cell] | None = None,
    jobs: int = 1,
    minutes: float | None = None,
    every: bool = False,
    again: bool = False,
) -> int:
    """Runs what is missing of the cells, all without any, and keeps it, a sweep at a time. Returns how many
    runs were made. every: also those that others decide. again: also those that have a row, unless their
    records are there.
    """
    file, begun, made = store.file_of(study), time.monotonic(), 0
    rows = store.read_rows(file)
    keys = {cell.key for cell in (study.cells if cells is None else cells)}
    lacking = [cell for cell in (study.cells if again else missing(study, rows, every)) if cell.key in keys]
    for part in parts(study, lacking):
        if minutes is not None and time.monotonic() - begun > 60 * minutes:
            break
        left = {cell.key for cell in missing(study, rows, every)}  # fewer, where new rows decide others
        if not (part := [cell for cell in part if again or cell.key in left]):
            continue
        rows = store.added(rows, run_cells(study, part, jobs), replace=True)  # rows without a value of today
        store.write_rows(file, rows)
        made += len(part)
        print(f"{study.name}: {made} of {len(lacking)} runs", file=sys.stderr)
    return made


def spot_check(study: Study, cells: list[Cell], most: int, seed: int, jobs: int = 1) -> int:
    """Runs so many of these cells that others decide, and keeps their rows: the page counts those that ended
    as it follows from the others. Returns how many runs were made.
    """
    keys = {cell.key for cell in cells}
    left = [cell for cell in left_out(study, store.read_rows(store.file_of(study))) if cell.key in keys]
    sample = random.Random(seed).sample(left, min(most, len(left)))
    print(f"{study.name}: spot check of {counted(len(sample), 'cell')} that others decide", file=sys.stderr)
    return make_rows(study, sample, jobs, every=True)


def _judged(study: Study, cells: list[Cell]) -> int:
    """The exit code: 0 where the rule judges nothing (function `judged`), or its cells pass."""
    if not hasattr(study.module, "judged"):
        return 0
    keys = {cell.key for cell in cells}
    lines, passed = study.module.judged(study, [row for row in page.rows_of(study) if row.key in keys])
    print("\n".join(lines))
    return 0 if passed else 1


def main(argv: list[str]) -> int:
    """argv: the spec, and the options."""
    return reported(of_spec(Path(argv[0])).name)(_main)(argv)


def _main(argv: list[str]) -> int:
    args = arguments(argv)
    study = read_study(argv[0], args.out, args.plugin)
    cells = chosen(study, args.only, args.part)
    file = store.file_of(study)
    if args.plan:
        print("\n".join(cost.plan(study, store.read_rows(file), cells, args.decided)))
        return 0
    if not args.no_run:
        built_program()
        made = make_rows(study, cells, args.jobs, args.minutes, args.decided, args.again)
        if args.spot_check:
            made += spot_check(study, cells, args.spot_check, args.seed, args.jobs)
        left = len(missing(study, store.read_rows(file), args.decided))
        print(f"{study.name}: {counted(made, 'new row')} in {file.name}, {left} to run")
    print(page.write_page(study))
    return _judged(study, cells)
