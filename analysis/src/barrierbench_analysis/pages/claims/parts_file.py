"""results/CLAIMS.csv: every part of every claim, a row each, exploratory and confirmed; and
results/CLAIMS_SWEEPS.csv: the sweeps from which they are computed.
"""

import csv
import io
from collections.abc import Iterator

from barrierbench_analysis.program.verbs import renewed
from barrierbench_analysis.studies.claims.entry import read_sweep
from barrierbench_analysis.studies.claims.judge import Answer
from barrierbench_analysis.studies.claims.sizes import of_sweeps
from barrierbench_analysis.studies.claims.table import Table
from barrierbench_analysis.studies.claims.verdict import ONLY_IF, OPEN, Judged
from barrierbench_analysis.studies.kit.metrics import METRICS
from barrierbench_analysis.tables.numbers import ratio, significant

COLUMNS = (
    *("claim", "evidence", "part", "says", "kind", "verdict", "condition_or_what_is_missing", "rests_on"),
    *("measures", "number", "lower", "upper", "interval", "unit", "asked", "scenes"),
    *(
        "unknowns_least",
        "unknowns_largest",
        "of_small_scenes",
        "conditions",
        "counted_and_left_out",
        "starts",
    ),
    *("by_scene", "ends_of_steps", "compared_by", "rule", "sweep", "depends_on_machine", "run_ids"),
    *("basis", "rerun"),
)
SWEEP_COLUMNS = (
    *(
        "sweep",
        "runs",
        "cases",
        "unknowns",
        "ok",
        "comparable",
        "seconds",
        "date",
        "machine",
        "build",
        "command",
    ),
)
DIGITS = 6  # of numbers


def _number(value: float | None) -> str:
    return significant(value, DIGITS, none="")


def _interval(j: Judged) -> str:
    """What lower and upper are."""
    if j.value is None:
        return ""
    if j.lower is None:
        return "none: one scene"
    return "least and largest" if j.extremes else "95% over scenes"


def unit_of(rule: dict) -> str:
    """Of the number: levels have that of their metric; ratios, shares, slopes and closed forms have none."""
    return METRICS[rule["metric"]][1] if rule.get("rule") == "level" else "1"


def by_scene(j: Judged) -> str:
    return "; ".join(
        f"{name} {ratio(value)} ({ratio(low)} to {ratio(high)} at {levels}, n = {n})"
        for name, value, low, high, levels, n in j.per_scene
    )


def _size(j: Judged, table: Table) -> dict[str, str]:
    sizes = of_sweeps([j.sweep], table) if j.sweep else None
    if sizes is None:
        return {}
    small = "yes" if sizes.small else "no"
    of = {"unknowns_least": sizes.least, "unknowns_largest": sizes.largest}
    return {name: str(n) for name, n in of.items()} | {"of_small_scenes": small}


def _row(a: Answer, evidence: str, j: Judged, table: Table) -> dict[str, str]:
    number, rule = next((k, part) for k, part in enumerate(a.claim.parts, 1) if part["says"] == j.says)
    confirmed = evidence == "confirmed"
    rests = a.confirmed_rests if confirmed else a.rests
    return _size(j, table) | {
        "claim": a.claim.id,
        "evidence": evidence,
        "part": str(number),
        "says": j.says,
        "kind": "observed" if j.beside else "deciding",
        "verdict": j.verdict,
        "condition_or_what_is_missing": {ONLY_IF: j.condition, OPEN: j.missing}.get(j.verdict, ""),
        "rests_on": rests.get(j.says, ""),
        "measures": j.measures,
        "number": _number(j.value),
        "lower": _number(j.lower),
        "upper": _number(j.upper),
        "interval": _interval(j),
        "unit": unit_of(rule),
        "asked": j.threshold,
        "scenes": str(j.scenes) if j.scenes else "",
        "conditions": j.slice,
        "counted_and_left_out": j.counted,
        "starts": j.starts,
        "by_scene": by_scene(j),
        "ends_of_steps": j.ends,
        "compared_by": "smallest gaps" if j.smallest_gaps else "",
        "rule": "closed form" if j.proof else j.rule,
        "sweep": j.sweep,
        "depends_on_machine": "yes" if j.machine else "no",
        "run_ids": " ".join(j.runs),
        "basis": a.state.why if confirmed else a.why_exploratory,
        "rerun": renewed(a.claim.command),
    }


def rows(answers: list[Answer], table: Table) -> Iterator[dict[str, str]]:
    for a in answers:
        for evidence, parts in (("exploratory", a.parts), ("confirmed", a.confirmed_parts)):
            for j in parts:
                yield _row(a, evidence, j, table)


def sweep_rows(table: Table) -> Iterator[dict[str, str]]:
    for name, runs in sorted(table.sweeps.items()):
        sweep, about = read_sweep(name), runs.about
        made = {key: about[key] for key in ("unknowns", "date", "machine")}
        yield made | {
            "sweep": name,
            "runs": str(len(runs.rows)),
            "cases": str(len(sweep.cases)),
            "ok": str(sum(row["outcome"] == "ok" for row in runs.rows)),
            "comparable": str(sum(row["comparability"] == "comparable" for row in runs.rows)),
            "seconds": f"{about['seconds']:.0f}",
            "build": about["build"][:8],
            "command": renewed(sweep.command),
        }


def as_csv(columns: tuple[str, ...], found: Iterator[dict[str, str]]) -> str:
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(found)
    return text.getvalue()


def parts_text(answers: list[Answer], table: Table) -> str:
    return as_csv(COLUMNS, rows(answers, table))


def sweeps_text(table: Table) -> str:
    return as_csv(SWEEP_COLUMNS, sweep_rows(table))
