"""The stress suite: scenes that are meant to be hard (configs/stress/ID.json) under all formulations, held
against what was expected before the first run; relations between runs; pairs and shapes in exact arithmetic.
A run may hang, crash or be refused: that is its outcome.
"""

from collections.abc import Iterator
from datetime import datetime, timezone
from pathlib import Path

from barrierbench_analysis.io import fields
from barrierbench_analysis.io.json_file import number_at
from barrierbench_analysis.studies.kit import alone
from barrierbench_analysis.studies.kit.study import collect
from barrierbench_analysis.studies.kit.study.spec import Case, Cell, Study
from barrierbench_analysis.studies.kit.study.store import Row

from . import geometry
from .entry import ONE, Test, Variant, ids, left_out, read_test
from .results import Result, result_of, tables

PARTIAL = True  # relations and outcomes are judged of the runs that there are
MEASURED = {
    "gravity_work_J": "work of gravity from the end of the first step to that of the last",
    "state_hash": "the first 16 digits of the hash of the last state",
    "counts": "subjects of a test of geometry, and their numbers, in each case",
}
KIND, PRECISION = "/geometry", "/precision"  # settings of a cell of geometry


def tests(study: Study) -> list[Test]:
    """Those of the folder that the spec names."""
    folder = (study.file.parent / study.about["tests"]).resolve()
    return [read_test(name, folder, study.about["full"]) for name in ids(folder)]


def is_known(need: dict) -> bool:
    """Whether the schema of configs allows the value at the pointer."""
    schema = node = fields.schema("config")
    for key in need["pointer"].strip("/").split("/"):
        if "$ref" in node:
            node = schema["$defs"][node["$ref"].rsplit("/", 1)[1]]
        node = node.get("properties", {}).get(key)
        if node is None:
            return False
    allowed = node.get("enum") or ([node["const"]] if "const" in node else None)
    return allowed is None or need["value"] in allowed


def waits(case: Variant) -> bool:
    """Whether it needs a setting that configs do not have yet."""
    return not all(map(is_known, case.needs))


def cells(study: Study) -> Iterator[Case]:
    """Formulations x cases of every test that do not wait; of a test of geometry its two precisions."""
    for test in tests(study):
        if "geometry" in test.data:
            for name in geometry.SCALAR:
                place = {"test": test.id, "formulation": name, "case": ONE}
                yield Case(place, {KIND: test.data["geometry"], PRECISION: name})
            continue
        base, more = test.base(study.base)
        for formulation in test.formulations:
            for case in (case for case in test.cases if not waits(case)):
                place = {"test": test.id, "formulation": formulation.label, "case": case.label}
                yield Case(place, more | test.settings(formulation, case), base)


def measure(_: Study, cell: Cell, record: dict) -> dict:
    steps = record["steps"]
    ends = [number_at(step, ["gravity_J"]) for step in (*steps[:1], *steps[-1:])]
    return {
        "gravity_work_J": None if not ends or None in ends else ends[0] - ends[1],
        "state_hash": record["summary"].get("state_hash", "")[:16] or None,
        "counts": record.get("counts"),
    }


def run(study: Study, chosen: list[Cell], folder: Path, jobs: int) -> list[Row]:
    """Rows of cells of one base: each run has its own limit of processor time, so that no verdict depends on
    what else was run; tests of geometry query `eval`.
    """
    runs = [cell for cell in chosen if KIND not in cell.settings]
    rows = collect.run_each(study, runs, folder, jobs, study.about["limit_s"])
    for cell in (cell for cell in chosen if KIND in cell.settings):
        begun = datetime.now(timezone.utc)
        counts = geometry.counted(cell.settings[KIND], cell.settings[PRECISION])
        record = alone.without_record("ok", "", begun, valid=True) | {"counts": counts}
        rows.append(collect.row_of(study, cell, record))
    return rows


def results_of(study: Study, rows: list[Row]) -> list[Result]:
    """Of the tests that there are rows of."""
    of = {test: [row for row in rows if row.place["test"] == test.id] for test in tests(study)}
    return [result_of(test, mine) for test, mine in of.items() if mine]


def judged(study: Study, rows: list[Row]) -> tuple[list[str], bool]:
    """What is not as expected of these rows, and whether all is."""
    results = results_of(study, rows)
    lines = [line for result in results for line in result.faults]
    return lines or ["everything is as expected"], all(result.as_expected for result in results)


def rule(study: Study, rows: list[Row]) -> dict:
    """The numbers of the page."""
    results = results_of(study, rows)
    runs = [run for result in results for run in result.runs]
    origins = [run.row.origin for run in runs if run.row.run]
    every = tests(study)
    return tables(results) | {
        "results": results,
        "tests": every,
        "runs": runs,
        "relations": [relation for result in results for relation in result.relations],
        "counts": [one for result in results for one in result.counts],
        "lacking": len(study.cells) - len(rows),
        "waiting": sum(len(test.formulations) for test in every for case in test.cases if waits(case)),
        "minutes": sum(run.row.seconds for run in runs) / 60,
        "dates": sorted({row.origin["date"] for row in rows}),
        "machines": sorted({origin["machine"] for origin in origins}),
        "commits": sorted({origin["commit"] for origin in origins}),
        "left_out": left_out(every[0].path.parent),
    }
