"""What is kept of a run beside the metrics of the spec."""

import json
from dataclasses import replace
from pathlib import Path

from barrierbench_analysis.studies.kit.study import collect, store
from barrierbench_analysis.studies.kit.study.spec import Cell, Study
from barrierbench_analysis.studies.rules.at_size import measured as size
from barrierbench_analysis.tables.gap_rule import gaps_of
from barrierbench_analysis.tables.numbers import rounded

from . import size_region
from .gathered import gathered

HARD = 1.5  # times the limit of a run, after which one that does not end by itself is ended
SIZE = {  # value of a row -> that of the study at size
    "size_cond_p95": "cond_p95",
    "size_cond_most": "cond_most",
    "size_bj_lambda_max": "bj_lambda_max",
    "size_newton": "velocity_newton",
    "size_products": "velocity_products",
    "size_seconds": "velocity_seconds",
    "made": "made",
    "load_high": "load_high",
    "load_low": "load_low",
}
MEASURED = {
    **{name: f"{size.MEASURED[of]}, as in the study at size" for name, of in SIZE.items()},
    "theta": "the gap in d_hat at which the stiffness is matched",
    "gaps": "gaps of the pairs of bodies, as the rule of comparability reads them; JSON",
}


def measure(study: Study, cell: Cell, record: dict) -> dict[str, float | str | None]:
    """Values of a row. Of a run without a record there are none."""
    found: dict[str, float | str | None] = dict.fromkeys(MEASURED)
    if not record["summary"]:
        return found
    found["theta"] = cell.settings.get("/matching", {}).get("theta")
    statement = gathered(study).named(cell.place["statement"])
    if statement.part is None:
        place = {"scene": cell.place["scene"], "size": cell.place["arm"].partition(size_region.AT)[2]}
        values = size.measure(size_region.study(), replace(cell, place=place), record)
        return found | {name: values[of] for name, of in SIZE.items()}
    if statement.comparable:
        found["gaps"] = json.dumps(rounded(gaps_of(record)))
    return found


def run(study: Study, cells: list[Cell], folder: Path, jobs: int) -> list[store.Row]:
    """Each run alone: one that hangs, crashes or is refused ends no other."""
    return collect.run_each(study, cells, folder, jobs, HARD * study.data["run_s"])
