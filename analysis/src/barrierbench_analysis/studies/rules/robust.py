"""Jittered starts: every start coordinate of a free vertex of a mini scene is moved by a uniform number
within the jitter that the scene names, differently for each seed.

A run passes when it ends `ok` without a crossing; one of a scene that must be rejected, when it is.
"""

from collections.abc import Iterator
from itertools import groupby

from barrierbench_analysis.io.text_table import fitted, markdown
from barrierbench_analysis.studies.catalogue import cells as mini
from barrierbench_analysis.studies.catalogue.checks import judge
from barrierbench_analysis.studies.catalogue.entry import names, read_entry
from barrierbench_analysis.studies.kit.study.spec import Case, Cell, Study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.tables.outcomes import OK, outcome_of

PARTIAL = True
MEASURED = {"failed": "why the start did not pass: outcome, crossings, or the rejection that it lacks"}


def cells(study: Study) -> Iterator[Case]:
    return mini.cells(study, lambda entry: {"/seeds/jitter_m": entry.data["jitter_m"]})


def measure(study: Study, cell: Cell, record: dict) -> dict:
    entry, outcome = read_entry(cell.place["scene"]), outcome_of(record)
    if not entry.is_rejected and outcome != OK:
        return {"failed": outcome}
    expected = entry.data["expect"] if entry.is_rejected else [{"check": "no_crossing"}]
    return {"failed": next((found.saw for _, found in judge(record, expected) if found.red), "")}


def _passed(rows: list[Row], of: str) -> Iterator[list[str]]:
    """Scene, formulation, how many seeds of how many passed, and which failed why."""
    for pair, of_pair in groupby(rows, key=lambda row: (row.place["scene"], row.place["formulation"])):
        mine = list(of_pair)
        failed = [f"seed {row.place['seed']}: {why}" for row in mine if (why := row.values["failed"])]
        yield [*pair, f"{len(mine) - len(failed)}{of}{len(mine)}", "; ".join(failed)]


def rule(study: Study, rows: list[Row]) -> dict:
    """The table of the page."""
    body = [
        [scene, formulation, passed, f"{read_entry(scene).data['jitter_m']:g}", failed.replace("|", "/")]
        for scene, formulation, passed, failed in _passed(rows, " of ")
    ]
    return {
        "table": "\n".join(markdown(["scene", "formulation", "passed", "jitter (m)", "what failed"], body)),
        "dates": ", ".join(sorted({row.origin["date"] for row in rows})),
        "runs": len(rows),
        "passed": sum(not row.values["failed"] for row in rows),
        "scenes": len({row.place["scene"] for row in rows}),
        "of": len(names()),
    }


def judged(study: Study, rows: list[Row]) -> tuple[list[str], bool]:
    head = ["scene", "formulation", "passed", "what failed"]
    return fitted(head, list(_passed(rows, "/"))), not any(row.values["failed"] for row in rows)
