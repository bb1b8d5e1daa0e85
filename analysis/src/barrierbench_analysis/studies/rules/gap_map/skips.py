"""Cells of a gap map that need no run, since a run that is there decides them. A run that ended
`stall_overload` bore a load over what its barrier can carry. At a smaller theta the same load is matched by a
smaller kappa, kappa |b'(theta)| being that load, so that the largest force kappa max|b'| is smaller too: the
cells of the same scene, resolution, limit and shape at smaller theta end in the same way. A cell that follows
from such a run and was run all the same checks the rule.
"""

from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.studies.kit.study.store import Row

from .spec import Run, run_of
from .table import CANNOT, NOT_RUN

OVERLOAD = "stall_overload"


def overloaded(ends: dict[Run, str]) -> dict[tuple, float]:
    """All of a run but its theta -> the largest theta at which one ended in an overload."""
    found: dict[tuple, float] = {}
    for run, outcome in ends.items():
        if outcome == OVERLOAD:
            found[run[:-1]] = max(found.get(run[:-1], 0.0), run.theta)
    return found


def decided(study: Study, rows: dict[str, Row]) -> dict[str, str]:
    """key -> outcome, of the cells that a run at a larger theta decides."""
    runs = {cell.key: run_of(cell.place) for cell in study.cells}
    known = overloaded({run: rows[key].outcome for key, run in runs.items() if key in rows})
    return {key: OVERLOAD for key, run in runs.items() if run.theta < known.get(run[:-1], 0.0)}


def table(rows: list[dict]) -> list[str]:
    """A row a cell that was left out, or that ended otherwise than it follows from another."""
    ends = {Run(*(row[field] for field in Run._fields)): row["outcome"] for row in rows}
    known, body = overloaded(ends), []
    shown = [pair for word in (True, False) for pair in ends.items() if (pair[1] == NOT_RUN) == word]
    for run, end in shown:
        by = known.get(run[:-1], 0.0)
        if run.theta < by and end not in (CANNOT, OVERLOAD):
            place = [run.scene, run.resolution, f"`{run.shape}`", f"limit {run.limit}", f"{run.theta:g}"]
            body.append([*place, f"{by:g}", "left out" if end == NOT_RUN else f"**{end}**"])
    head = ["scene", "level", "shape", "conditions", "theta", "a run decides it, at theta", "how it ended"]
    return markdown(head, body) if body else []
