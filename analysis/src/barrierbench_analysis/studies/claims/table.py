"""What the verdicts are computed from, results/studies/claims.jsonl: the numbers of all runs, and the answers
of `eval`. Rows share (io/shared_rows.py) their sweep, what made them and their columns.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from barrierbench_analysis.io.digests import of_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.origin import origin, run_of, seconds_of_run
from barrierbench_analysis.io.record_file import RecordError, other_meanings, read_record
from barrierbench_analysis.io.shared_rows import read_shared, write_shared
from barrierbench_analysis.studies.kit.metrics import FOLDER, METRICS
from barrierbench_analysis.studies.kit.success import RESIDUAL, read_for
from barrierbench_analysis.tables.gap_rule import gaps_of
from barrierbench_analysis.tables.numbers import rounded
from barrierbench_analysis.tables.outcomes import outcome_of

from .ends import ENDS, end_of_run
from .entry import ROOT, Claim, Sweep
from .inputs import asked, contradiction, inputs_of
from .merged import base_path
from .parts import MOST

FILE = ROOT / "results" / "studies" / "claims.jsonl"
RUNS = ROOT / "results" / "runs" / "claims"
NAME = "barrierbench.claims/2"
SHARED, ANSWER = ("sweep", "about", "columns"), ("query", "answer")
AGAIN = "; remove it, then ./bench study claims run"
PLACE = ("scene", "level", "case", "seed")
# run: the first 16 digits of run_id. pair: that is not comparable. Numbers of records before 3.5.0 have no
# pair, gaps and ends
STATE = ("outcome", "comparability", "gap_rel", "run", "pair", "gaps", *ENDS)
DIGITS = 12  # of a metric, so that a number beside a threshold stays on its side; 6 of gaps and residuals


@dataclass
class Runs:
    """The runs of a sweep as far as rules need them: place -> state and metrics."""

    about: (
        dict  # sha256 of the sweep file, inputs_sha256 of all that it names, date, machine, program, seconds
    )
    rows: list[dict]

    @property
    def of_earlier_rule(self) -> bool:
        """Whether verdicts on comparability are those of records before 3.5.0, by the smallest gap of a
        run."""
        return any(row.get("gaps") is None for row in self.rows)

    def check_one_rule(self, sweep: Sweep) -> None:
        """Errors: UserError where runs are judged comparable by the smallest gap (before 3.5.0) beside others
        that are by each pair's: no number pools two rules.
        """
        earlier = [row for row in self.rows if row["outcome"] == "ok" and row.get("gaps") is None]
        later = [row for row in self.rows if row["outcome"] == "ok" and row.get("gaps") is not None]
        if earlier and later:
            raise UserError(
                f"{sweep.name}: {len(earlier)} records of before 3.5.0 (run_id {earlier[0]['run']}) beside"
                f" {len(later)} later ones, of another rule of comparability: remove the folders of the"
                f" earlier ones, then {sweep.command}"
            )


@dataclass
class Table:
    sweeps: dict[str, Runs] = field(default_factory=dict)
    answers: dict[str, dict] = field(default_factory=dict)  # query of eval -> its answer


def used_metrics(claims: list[Claim]) -> dict[str, list[str]]:
    """Sweep -> metrics that some part reads."""
    used: dict[str, set] = {}
    for part in (part for claim in claims for part in claim.parts if "sweep" in part):
        equal, residual = (part.get("equal") or {}).get("metric"), RESIDUAL if MOST in part else None
        names = {part.get("metric"), *read_for(part.get("bad")), equal, residual} - {None}
        if unknown := names - set(METRICS):
            raise UserError(f"metric {sorted(unknown)[0]!r}: one of {', '.join(METRICS)}")
        for sweep in (part["sweep"], *((part["confirm"]["sweep"],) if "confirm" in part else ())):
            used.setdefault(sweep, set()).update(names)
    for frontier in (claim.frontier for claim in claims if claim.frontier):
        used.setdefault(frontier["sweep"], set()).update((frontier["cost"], *read_for(frontier.get("bad"))))
    return {sweep: sorted(names) for sweep, names in used.items()}


def _row(record: dict, place: tuple, metrics: list[str]) -> dict:
    comparability = record["comparability"]
    verdict = comparability["verdict"]
    pair = comparability.get("pair", "") if verdict == "not_comparable" else ""
    state = outcome_of(record), verdict, rounded(comparability.get("gap_rel")), run_of(record), pair
    row = dict(zip(PLACE, place)) | dict(zip(STATE, (*state, rounded(gaps_of(record)))))
    row |= rounded(end_of_run(record))
    return row | {name: rounded(METRICS[name][3](record), DIGITS) for name in metrics}


def _records(sweep: Sweep, folder: Path, metrics: list[str]) -> Iterator[tuple[dict, dict]]:
    """Record and row of every case; what cannot be read, or is of other inputs than the sweep has now, is
    said and counts as missing.
    """
    configs, base = dict(asked(sweep)), base_path(read_object(sweep.path), sweep.path).parent
    for path in sorted(folder.glob("*/run.json")):
        try:
            record = read_record(path)
            note = record["labels"].get("note", "")
            if note not in sweep.cases:
                continue
            if unlike := contradiction(record, configs[note], base):
                raise RecordError(f"{path}: of other inputs than {sweep.file} has now: {unlike}")
            record[FOLDER] = str(path.parent)
            yield record, _row(record, sweep.cases[note], metrics) | sweep.more.get(note, {})
        except RecordError as error:
            print(f"{error}; counted as missing", file=sys.stderr)


def _one_version(sweep: Sweep, folder: Path, records: list[dict]) -> str:
    """The versions of the records in words. Errors: UserError where a field means one thing in some of them
    and another in others.
    """
    found = {record["schema"]["version"] for record in records}
    versions = sorted(found, key=lambda version: [int(part) for part in version.split(".")])
    if records and (fields := other_meanings(versions[0], versions[-1])):
        raise UserError(
            f"{folder}: records of version {versions[0]} beside those of {versions[-1]}, in which"
            f" {', '.join(fields)} mean different things: remove those of the earlier version, then"
            f" {sweep.command}"
        )
    return ", ".join(versions)


def collect(sweep: Sweep, folder: Path, metrics: list[str]) -> Runs:
    """The records of a sweep below its folder. Those of other cases than the sweep file has, or of other
    inputs, do not count. Errors: UserError.
    """
    found = list(_records(sweep, folder, metrics))
    records, rows = [record for record, _ in found], [row for _, row in found]
    keys = (*PLACE, *sweep.axes)
    rows.sort(key=lambda row: tuple(str(row[key]) for key in keys))
    if len({tuple(row[key] for key in keys) for row in rows}) != len(rows):
        raise UserError(
            f"{folder}: two records of one case; remove the folder and run ./bench sweep {sweep.file} again"
        )
    file = folder / "sweep.json"  # the program's copy of the sweep file that made the records
    about = {
        "sha256": of_file(file) if file.is_file() else "",
        "inputs_sha256": inputs_of(sweep),
        "schema": _one_version(sweep, folder, records),
        "seconds": round(sum(map(seconds_of_run, records)), 1),
        "first_started_utc": min((r["status"]["started_utc"] for r in records), default=""),
    }
    about |= origin(records)
    sizes = [r["scene"]["free_dofs"] for r in records]
    about["unknowns"] = f"{min(sizes)} to {max(sizes)}" if sizes else ""
    return Runs(about, rows)


def write(table: Table, path: Path) -> None:
    """Answers of `eval` stand below the name of no sweep."""
    answers = [dict(zip(ANSWER, one)) for one in sorted(table.answers.items())]
    blocks = [
        *((name, runs.about, runs.rows) for name, runs in sorted(table.sweeps.items())),
        ("", {}, answers),
    ]
    rows = (
        (dict(zip(SHARED, (name, about, list(rows[0])))), list(row.values()))
        for name, about, rows in blocks
        for row in rows
    )
    write_shared(path, NAME, rows)


def _kept(row: list, shared: dict) -> tuple[str, dict, dict]:
    """Sweep, what made it, and the row. Errors: ValueError for another number of values, KeyError."""
    return shared["sweep"], shared["about"], dict(zip(shared["columns"], row, strict=True))


def read(path: Path) -> Table:
    """The kept table; empty when there is none. Errors: UserError."""
    table = Table()
    rows = read_shared(path, NAME, SHARED, _kept, "a row of ./bench study claims", AGAIN)
    for _, (sweep, about, row) in rows if path.is_file() else ():
        if sweep:
            table.sweeps.setdefault(sweep, Runs(about, [])).rows.append(row)
        else:
            table.answers[row["query"]] = row["answer"]
    return table
