"""The records of a sweep, or of any folder, as one tidy table: a row for each run, whatever its outcome; a
column for each pointer that a sweep varies and for each field of the record, the unit in its name. NAME.csv
has it as text, NAME.parquet beside it the same rows with their types; where OUT is a name of Parquet it is
written alone. NAME.columns.csv says of every column its unit, type, place in the record and meaning. May be
called while runs go on: the table has those that are over. Numbers read back bit for bit.

Exit codes: 0 written, 2 no record can be read, or the file cannot be written.
"""

import argparse
import io
import os
import sys
from pathlib import Path

import pandas as pd

from barrierbench_analysis.io.cases import has_list, read_cases, records_below
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.record_file import RecordError, read_record
from barrierbench_analysis.io.whole_file import write_whole, write_whole_bytes
from barrierbench_analysis.program import processes
from barrierbench_analysis.program.arguments import parser_of
from barrierbench_analysis.tables.archive import study
from barrierbench_analysis.tables.run_rows import run_row

from . import dictionary

FIRST = ("run", "outcome", "valid", "repetition")  # behind them the swept pointers
OWN = ("folder", "series", "group")  # of run_row, for figures
PARALLEL_FROM = 500  # records, from which on reading them is shared by the cores


def files_of(folder: Path) -> list[Path]:
    """Records of the cases that the folder lists, in their order; of a folder without a list every record
    below it. Errors: UserError where there is no folder.
    """
    if has_list(folder):
        return [case.record for case in read_cases(folder) if case.record.is_file()]
    if not folder.is_dir():
        raise UserError(f"{folder}: no such folder; one with records is needed")
    return records_below(folder)


def _flat(row: dict) -> dict:
    """Objects in a row as columns of their own, named by their keys; lists are left out."""
    out: dict = {}
    for name, value in row.items():
        if isinstance(value, dict):
            out |= _flat({f"{name}_{key}": below for key, below in value.items()})
        elif not isinstance(value, list):
            out[name] = value
    return out


def _row(path: Path, folder: Path) -> dict | str:
    """The row of a record, or why it cannot be read."""
    try:
        row = run_row(read_record(path), str(path.parent.relative_to(folder)))
    except RecordError as error:
        return str(error)
    swept = row.pop("swept") or {}
    return {name: value for name, value in _flat(row).items() if name not in OWN} | {
        name: row[name] for name in swept
    }


def read_rows(folder: Path) -> tuple[list[dict], list[str]]:
    """One row a record, and what could not be read. Cost: about 10 ms for each MB of records and core."""
    paths = files_of(folder)
    workers = len(os.sched_getaffinity(0))
    if len(paths) < PARALLEL_FROM or workers == 1:
        found = [_row(path, folder) for path in paths]
    else:
        with processes.pool(workers) as pool:
            found = list(pool.map(_row, paths, [folder] * len(paths), chunksize=64))
    rows = [row for row in found if isinstance(row, dict)]
    unreadable = [text for text in found if isinstance(text, str)]
    if not rows:
        raise UserError("\n".join([f"{folder}: no record that can be read", *unreadable]))
    return rows, unreadable


def table_of(rows: list[dict]) -> dict[str, list]:
    """Column -> values: FIRST, the swept pointers, then the fields of the record in their order. Columns that
    no row has a value in are left out.
    """
    names = dict.fromkeys(name for row in rows for name in row)
    swept = sorted(name for name in names if name.startswith("/"))
    head = [name for name in (*FIRST, *swept) if name in names]
    table = {name: [row.get(name) for row in rows] for name in dict.fromkeys((*head, *names))}
    return {name: values for name, values in table.items() if any(value is not None for value in values)}


def as_frame(table: dict[str, list]) -> pd.DataFrame:
    """Typed by what the columns hold: whole numbers with gaps stay whole numbers."""
    types = {"integer": "Int64", "number": "float64", "truth": "boolean"}
    return pd.DataFrame(
        {
            name: pd.array(values, dtype=types.get(dictionary.type_of(values), "object"))
            for name, values in table.items()
        }
    )


def _parquet(table: pd.DataFrame) -> bytes:
    """A column of Parquet has one type: one of words and numbers has texts, those of the CSV."""
    buffer = io.BytesIO()
    mixed = table.select_dtypes("object").columns
    table.astype(dict.fromkeys(mixed, "string")).to_parquet(buffer, index=False)
    return buffer.getvalue()


def write(table: pd.DataFrame, out: Path) -> list[Path]:
    """NAME.csv and NAME.parquet, or that alone. Errors: OSError."""
    binary = out.with_suffix(".parquet")
    if out.suffix == ".csv":
        write_whole(out, table.to_csv(index=False, lineterminator="\n"))
    write_whole_bytes(binary, _parquet(table))
    return list(dict.fromkeys([out, binary]))


def _check_out(out: Path) -> None:
    if out.suffix not in (".csv", ".parquet"):
        raise UserError(f"{out}: found the suffix {out.suffix!r}; .csv or .parquet is needed")


def _say_what_is_not_there(folder: Path, rows: list[dict], unreadable: list[str]) -> None:
    for text in unreadable:
        print(f"{text}; left out", file=sys.stderr)
    if has_list(folder) and (absent := len(read_cases(folder)) - len(rows) - len(unreadable)):
        print(f"{folder}: {absent} runs have no record yet (./bench status {folder})", file=sys.stderr)
    for name, what in (("build_id", "programs"), ("machine_id", "machines")):
        if len(known := {row.get(name) for row in rows}) > 1:
            print(
                f"{folder}: records of {len(known)} {what}: the column {name} distinguishes them",
                file=sys.stderr,
            )


def arguments(argv: list[str]) -> argparse.Namespace:
    parser = parser_of("data collect", __doc__, "./bench data collect results/runs/my_sweep my_sweep.parquet")
    parser.add_argument(
        "folder",
        type=Path,
        metavar="DIR",
        help="the folder of a sweep, one with records below it, or an archive",
    )
    parser.add_argument(
        "out",
        type=Path,
        metavar="OUT",
        help="NAME.csv, beside which NAME.parquet is written, or NAME.parquet",
    )
    return parser.parse_args(argv)


@reported("data collect")
def main(argv: list[str]) -> int:
    args = arguments(argv)
    _check_out(args.out)
    with study(args.folder) as (folder,):
        rows, unreadable = read_rows(folder)
        _say_what_is_not_there(folder, rows, unreadable)
    table = table_of(rows)
    beside = args.out.with_suffix(".columns.csv")
    written = write(as_frame(table), args.out)
    write_whole(beside, pd.DataFrame(dictionary.rows(table)).to_csv(index=False, lineterminator="\n"))
    print(f"{', '.join(map(str, written))}: {len(rows)} runs, {len(table)} columns, which {beside} explains")
    return 0
