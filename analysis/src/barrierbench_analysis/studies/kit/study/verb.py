"""./bench study NAME run | plan | page, of every spec in configs/studies.

run: makes the runs that have no row, keeps their rows, writes the page. plan: counts the cells, those that
have a row, and what the rest is expected to take. page: writes the page from the kept rows.

Exit codes: 0 done, 2 a spec that cannot be read, or a page whose cells are not all there.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

from barrierbench_analysis.io.errors import tells
from barrierbench_analysis.program.arguments import parser_of
from barrierbench_analysis.program.start import built_program
from barrierbench_analysis.program.verbs import of_spec
from barrierbench_analysis.tables.words import counted

from . import page, store
from .collect import missing, run_cells
from .spec import SEED, Cell, Study, read_study

AT_ONCE = 60  # runs whose rows are kept together: what an interrupt loses at most is their reading


def arguments(argv: list[str]) -> argparse.Namespace:
    """argv: the spec, which the front door puts first, and the options of a mode."""
    row = of_spec(Path(argv[0]))
    parser = parser_of(row.name, __doc__, row=row)
    parser.add_argument("--plan", action="store_true", help="counts cells and expected seconds; runs nothing")
    parser.add_argument("--no-run", action="store_true", help="writes the page from the kept rows")
    return parser.parse_args(argv[1:])


def planned(study: Study) -> list[str]:
    """Lines: cells, those with a row, and what the rest takes as far as kept rows tell."""
    rows = store.read_rows(store.file_of(study))
    lacking = missing(study, rows)
    lines = [
        f"{study.name}: {counted(len(study.cells), 'cell')}, {len(study.cells) - len(lacking)} with a row in"
        f" {store.file_of(study).name}, {len(lacking)} to run"
    ]
    kept = [replace(rows[cell.key], place=cell.place) for cell in study.cells if cell.key in rows]
    known = [seconds for cell in lacking if (seconds := _expected(cell, kept)) is not None]
    if known:
        lines.append(f"about {sum(known):.0f} s of one core for {counted(len(known), 'run')} of these")
    if unknown := len(lacking) - len(known):
        lines.append(f"{counted(unknown, 'run')} without a kept row whose labels are alike: not estimated")
    return lines


def _expected(cell: Cell, rows: list[store.Row]) -> float | None:
    """Seconds: mean of the rows that differ in at most one label, where each label of the cell stands in some
    row; None without any.
    """
    if any(all(row.place[name] != word for row in rows) for name, word in cell.place.items() if name != SEED):
        return None
    near = [row.seconds for row in rows if sum(row.place[n] != word for n, word in cell.place.items()) <= 1]
    return sum(near) / len(near) if near else None


def make_rows(study: Study) -> int:
    """Runs what is missing and keeps it, a part at a time. Returns how many runs were made."""
    file = store.file_of(study)
    rows = store.read_rows(file)
    lacking = missing(study, rows)
    for start in range(0, len(lacking), AT_ONCE):
        new = run_cells(study, lacking[start : start + AT_ONCE])
        rows = store.added(rows, new, replace=True)  # of rows that lack a metric of today
        store.write_rows(file, rows)
        print(f"{study.name}: {len(lacking) - len(missing(study, rows))} of {len(lacking)} runs")
    return len(lacking)


def main(argv: list[str]) -> int:
    """argv: the spec, and the options."""
    return tells(of_spec(Path(argv[0])).name)(_main)(argv)


def _main(argv: list[str]) -> int:
    args = arguments(argv)
    study = read_study(argv[0])
    page.module_of(study)
    if args.plan:
        print("\n".join(planned(study)))
        return 0
    if not args.no_run:
        built_program()
        made = make_rows(study)
        print(f"{study.name}: {counted(made, 'new row')} in {store.file_of(study).name}")
    print(page.write_page(study))
    return 0
