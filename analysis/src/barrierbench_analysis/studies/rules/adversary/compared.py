"""What the runs of a draw say about their statement."""

import json
import math
from dataclasses import dataclass

from barrierbench_analysis.studies.claims.numbers import gap_refusal
from barrierbench_analysis.studies.claims.outcomes import good
from barrierbench_analysis.studies.claims.parts import MOST
from barrierbench_analysis.studies.kit.study.store import Row, timed_alike
from barrierbench_analysis.studies.kit.success import failures
from barrierbench_analysis.studies.rules.at_size.laws import MADE, log_pays
from barrierbench_analysis.tables.numbers import significant
from barrierbench_analysis.tables.outcomes import OK

from .statement import Statement, contrary

CONTRADICTS = 1.0  # margin of a run that has to get through and does not


@dataclass(frozen=True)
class Contrast:
    """What a draw says. margin: how far it contradicts (above 0) or agrees; None where it compares nothing.
    numbers: of its runs, in words.
    """

    margin: float | None
    numbers: str
    why: str = ""  # it compares nothing


def ended(rows: dict[str, Row]) -> str:
    """Which runs did not end ok, in words."""
    return ", ".join(f"{arm} {row.outcome}" for arm, row in rows.items() if row.outcome != OK)


def _gaps(row: Row) -> dict:
    """Of the rule of comparability."""
    kept = row.values["gaps"]
    return {"gaps": None if kept is None else json.loads(kept), "gap_rel": row.values["gap_min"]}


def _logs(statement: Statement, rows: dict[str, Row]) -> tuple[list[float], str]:
    """Logarithms of the metric of all runs, or why there is none."""
    values = [row.values[statement.metric] for row in rows.values()]
    if why := ended(rows):
        return [], why
    if statement.metric.endswith("seconds") and not timed_alike(rows.values()):
        return [], "two machines or builds"
    if statement.comparable and (why := gap_refusal(*map(_gaps, rows.values()))):
        return [], why
    if any(value is None or value <= 0 for value in values):
        return [], f"no {statement.metric} above 0"
    return [math.log(value) for value in values], ""


def _numbers(statement: Statement, rows: dict[str, Row]) -> str:
    found = ((arm, row.values[statement.metric]) for arm, row in rows.items())
    return ", ".join(f"{arm} {significant(x, 4)}" for arm, x in found)


def ratio(statement: Statement, rows: dict[str, Row]) -> Contrast:
    """Of two runs the first over the second; of four the ratio of the first two over that of the others."""
    logs, why = _logs(statement, rows)
    if not logs:
        return Contrast(None, "", why)
    x = logs[0] - logs[1] - (logs[2] - logs[3] if len(logs) == 4 else 0.0)
    text = f"{math.exp(x):.4g} ({_numbers(statement, rows)})"
    return Contrast(contrary(statement.side, x), text)


def level(statement: Statement, rows: dict[str, Row]) -> Contrast:
    """The number of each run that ended ok; the most contrary one counts."""
    values = [
        x for row in rows.values() if row.outcome == OK and (x := row.values[statement.metric]) is not None
    ]
    if not values:
        return Contrast(None, "", ended(rows) or f"no {statement.metric}")
    return Contrast(max(contrary(statement.side, x) for x in values), _numbers(statement, rows))


def _fails(statement: Statement, row: Row) -> bool:
    """Whether a run fails in the way that the statement means: in its outcome, or as the part of a claim
    says. A run that left no record fails."""
    bad = (statement.part or {}).get("bad")
    if bad is None or not row.unknowns or any(row.values[name] is None for name in failures(bad)):
        return row.outcome != OK
    place = {"level": "", "case": "", **row.place, "seed": row.place["draw"]}
    return not good({**place, **row.values, "outcome": row.outcome}, bad, statement.part.get(MOST))


def outcomes(statement: Statement, rows: dict[str, Row]) -> Contrast:
    """The first run has to get through, where the second one does. Of those that get through the one with the
    smaller gap is the nearer to a failure."""
    fails = {arm: _fails(statement, row) for arm, row in rows.items()}
    first, *others = fails
    text = ", ".join(
        f"{arm} {'fails' if fails[arm] else 'gets through'} ({row.outcome})" for arm, row in rows.items()
    )
    if all(fails.values()) and others:
        return Contrast(None, "", "no run gets through")
    gap = rows[first].values["gap_min"]
    return Contrast(CONTRADICTS if fails[first] else -(1.0 if gap is None else gap), text)


def sign(statement: Statement, rows: dict[str, Row]) -> Contrast:
    """Law 1: whether ln(cond_log/cond_cubic) has the sign of 1/theta - 2 sqrt(r), where contact makes the
    largest eigenvalue of both."""
    if why := ended(rows):
        return Contrast(None, "", why)
    log, cubic = rows.values()
    made = [row.values["made"] for row in (log, cubic)]
    high, low = (log.values[name] for name in ("load_high", "load_low"))
    if None in (*made, high, low) or min(made) < MADE or not low:
        return Contrast(None, "", "contact does not make the largest eigenvalue")
    price = log_pays(log.values["theta"], high / low)
    seen = math.log(log.values[statement.metric] / cubic.values[statement.metric])
    text = f"{math.exp(seen):.4g} ({_numbers(statement, rows)}), f_hi/f_lo {high / low:.3g}"
    return Contrast(-math.copysign(1.0, price) * seen, text)


COMPARED = {"ratio": ratio, "level": level, "outcomes": outcomes, "sign": sign}


def contrast(statement: Statement, rows: dict[str, Row]) -> Contrast:
    """What the runs of a draw say. rows: arm -> run, of every arm of the statement in its order."""
    return COMPARED[statement.compares](statement, rows)
