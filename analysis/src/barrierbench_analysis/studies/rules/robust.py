"""Jittered starts: every start coordinate of a free vertex of a mini scene is moved by a uniform number
within the jitter that the scene names, differently for each seed.

A run passes when it ends `ok` without a crossing; one of a scene that must be rejected, when it is.
"""

from __future__ import annotations

from collections.abc import Iterator

from barrierbench_analysis.io.text_table import fitted, markdown
from barrierbench_analysis.studies.catalogue import cells as mini
from barrierbench_analysis.studies.catalogue.checks import judge, no_crossing
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
    if entry.is_rejected:
        findings = [finding for _, finding in judge(record, entry.data["expect"])]
    elif outcome != OK:
        return {"failed": outcome}
    else:
        findings = [no_crossing(record)]
    return {"failed": next((finding.saw for finding in findings if finding.red), "")}


def _passed(rows: list[Row], of: str) -> Iterator[list[str]]:
    """Scene, formulation, how many seeds of how many passed, and which failed why."""
    of_pair: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        of_pair.setdefault((row.place["scene"], row.place["formulation"]), []).append(row)
    for (scene, formulation), mine in of_pair.items():
        failed = [f"seed {row.place['seed']}: {why}" for row in mine if (why := row.values["failed"])]
        yield [scene, formulation, f"{len(mine) - len(failed)}{of}{len(mine)}", "; ".join(failed)]


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
