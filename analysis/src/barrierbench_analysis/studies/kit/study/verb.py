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
from dataclasses import replace
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.whole_file import alone
from barrierbench_analysis.program.arguments import count_from_1, parser_of, plugin_argument, positive_number
from barrierbench_analysis.program.start import built_program
from barrierbench_analysis.program.verbs import of_spec
from barrierbench_analysis.tables.words import counted

from . import cost, memory, page, registration, repeat, store
from .collect import left_out, missing, parts, run_cells, wanted
from .spec import Cell, Study, read_study

# Options that studies had before they were specs -> what takes their place.
BEFORE = {
    "--anew": "--again",
    "--formulations": "--only formulation=LABEL[,LABEL]",
    "--full": "./bench study configs/stress/stress_full.json run",
    "--large": "--part large",
    "--list": "plan",
    "--quick": "--part quick",
    "--results": "--out DIR",
    "--runs": "--out DIR",
    "--seeds": "--only seed=LABEL[,LABEL]",
    "--set": "a spec of your own (docs/guides/add-a-study.md)",
    "--sheet": "run --again --only formulation=log",
    "--shards": "--only AXIS=LABEL or --minutes M",
}


def which_arguments(parser: argparse.ArgumentParser) -> None:
    """Which cells are run."""
    parser.add_argument(
        "--only",
        action="append",
        default=[],
        metavar="AXIS=LABEL[,LABEL]",
        help="runs the cells with one of these labels on the axis alone; of several axes: on all of them",
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
        "--register",
        metavar="WHY",
        help="of a spec with `registered`: fixes spec and rule before the first run, or after a change with"
        " its reason; runs nothing",
    )
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
        help="runs, rows, page and figures in this folder, apart from kept rows: repeats a study, and prints"
        " how far the new rows are from the kept ones",
    )
    plugin_argument(parser)
    for word in argv[1:]:
        if new := BEFORE.get(word.partition("=")[0]):
            raise UserError(f"{word}: found an option of before; allowed: {new}")
    args = parser.parse_args(argv[1:])
    _check_mode(parser, args)
    return args


def _check_mode(parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
    """Errors: UserError for an option of `run` beside a mode that runs nothing, which it would not change,
    and for plugins where rows of this tree would be written.
    """
    if args.plan and args.no_run:
        raise UserError("--plan: found beside --no-run; allowed: one of the two")
    mode = "plan" if args.plan else "page" if args.no_run else ""
    of_run = [
        "minutes",
        "jobs",
        "spot_check",
        "seed",
        "register",
        *(["again", "decided"] if mode == "page" else []),
    ]
    for name in of_run if mode else []:
        if getattr(args, name) != parser.get_default(name):
            word = f"--{name.replace('_', '-')}"
            raise UserError(f"{word}: found beside {mode}, which runs nothing; allowed: with run")
    for plugin in args.plugin:
        if not Path(plugin).is_file():
            raise UserError(f"--plugin: found {plugin!r}, which is no file; allowed: a shared library")
    if args.plugin and not args.out:
        raise UserError("--plugin: found without --out; allowed: with a folder for what is made with it")


def _asked(texts: list[str]) -> dict[str, list[str]]:
    """--only as axis -> labels. Errors: UserError for another form."""
    found: dict[str, list[str]] = {}
    for text in texts:
        axis, equals, labels = text.partition("=")
        if not axis or not equals or not labels:
            raise UserError(f"--only: found {text!r}; allowed: AXIS=LABEL, several labels with commas")
        found.setdefault(axis, []).extend(labels.split(","))
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
    runs were made. every: also those that others decide. again: also those that have a row, whose records
    may be there.
    """
    file, begun, made = store.file_of(study), time.monotonic(), 0
    rows = store.read_rows(file)
    keys = {cell.key for cell in (study.cells if cells is None else cells)}
    lacking = [cell for cell in wanted(study, rows, every, again) if cell.key in keys]
    memory.require(study, rows, lacking, jobs)
    there = {*rows} if again else set()
    for part in parts(study, lacking):
        if minutes is not None and time.monotonic() - begun > 60 * minutes:
            break
        left = {cell.key for cell in missing(study, rows, every)}  # fewer, where new rows decide others
        if not (part := [cell for cell in part if cell.key in left | there]):
            continue
        new = run_cells(study, part, jobs, again)
        with alone(file):  # other calls may have added rows meanwhile
            rows = store.added(store.read_rows(file), new, replace=True)  # rows without a value of today
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


def _judged(study: Study, cells: list[Cell], new: int | None) -> int:
    """The exit code: 0 where the rule judges nothing (function `judged`), or its cells pass. new: how many
    rows the call made. Errors: UserError where no cell of the call has a row.
    """
    if not hasattr(study.module, "judged"):
        return 0
    keys = {cell.key for cell in cells}
    rows = [row for row in page.rows_of(study) if row.key in keys]
    if not rows:
        raise UserError(
            f"{store.file_of(study)}: found no row of {counted(len(cells), 'cell')} of the call; allowed:"
            f" some; {study.call('run')} makes them"
        )
    lines, passed = study.module.judged(study, rows)
    print("\n".join(lines))
    if without := len(cells) - len(rows):
        print(f"{counted(without, 'cell')} of the call without a row: not judged")
    if new == 0:
        print("no run was made: kept rows were judged; --again makes them with this build")
    return 0 if passed else 1


def main(argv: list[str]) -> int:
    """argv: the spec, and the options."""
    return reported(of_spec(Path(argv[0])).name)(_main)(argv)


def _main(argv: list[str]) -> int:
    args = arguments(argv)
    study = read_study(argv[0], args.out, args.plugin)
    file = store.file_of(study)
    if args.register is not None:
        print(f"{registration.file_of(study)}: {registration.register(study, args.register)}")
        return 0
    if args.plan:
        cells = chosen(study, args.only, args.part)
        rows = store.read_rows(file)
        keys = {cell.key for cell in wanted(study, rows, args.decided, args.again)}
        to_run = [cell for cell in cells if cell.key in keys]
        lines = cost.plan(study, rows, cells, args.decided, args.again)
        print("\n".join([*lines, *memory.line(study, rows, to_run)]))
        return 0
    made = None
    if not args.no_run:
        study, made = _made(study, args)
    left = len(missing(study, store.read_rows(file), args.decided))
    if made and left and not getattr(study.module, "PARTIAL", False):
        print(f"no page yet: {counted(left, 'cell')} without a row; {study.call('run')} goes on")
        return 0
    print(page.write_page(study))
    return _judged(study, chosen(study, args.only, args.part), made)


def _made(study: Study, args: argparse.Namespace) -> tuple[Study, int]:
    """Runs what a call wants, and says how many rows it made and how many cells are left. Returns the study
    with its cells of then. Where cells follow from rows (GROWS of a rule) the call goes on with those that
    its rows brought.
    """
    registration.require(study)
    built_program()
    begun, made, left = time.monotonic(), 0, args.minutes
    while True:
        cells = chosen(study, args.only, args.part)
        new = make_rows(study, cells, args.jobs, left, args.decided, args.again)
        made += new
        if args.again or not new or not getattr(study.module, "GROWS", False):
            break
        study = replace(study)  # whose cells are asked for anew
        left = None if args.minutes is None else args.minutes - (time.monotonic() - begun) / 60
    if args.spot_check:
        made += spot_check(study, cells, args.spot_check, args.seed, args.jobs)
    file = store.file_of(study)
    left = len(missing(study, store.read_rows(file), args.decided))
    print(f"{study.name}: {counted(made, 'new row')} in {file.name}, {left} to run")
    if study.out and (kept := store.file_of(replace(study, out=None))).is_file():
        keys = {cell.key for cell in cells}
        new = [row for row in store.read_rows(file).values() if row.key in keys]
        print("\n".join(repeat.lines(store.read_rows(kept), new)))
    return study, made
