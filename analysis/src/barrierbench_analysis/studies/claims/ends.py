"""Cases whose steps are not asked to converge: which residual their ends have, in the words of all tables and
figures.
"""

import re
from statistics import median

from barrierbench_analysis.tables.run_words import end_word

from .entry import Sweep

ENDS = ("convergence", "end_error_tolerances_median")  # columns of `runs`, which end_word reads
STIFFNESS = re.compile(r"(.+) x([0-9.e+-]+)$")  # a case of a sweep over stiffness: NAME xSCALE
NOT_ASKED = (
    "accumulated_toi",
)  # step solvers that stop by another rule: of kept numbers without these columns


def end_of_run(record: dict) -> dict:
    summary = record["summary"]
    return {ENDS[0]: summary.get(ENDS[0]), ENDS[1]: (summary.get("end_error_tolerances") or {}).get("median")}


def _name(case: str) -> str:
    """Of a case NAME xSCALE its name."""
    match = STIFFNESS.match(case)
    return match.group(1) if match else case


def end_of_case(rows: list[dict], name: str, sweep: Sweep) -> str:
    """end_word of a case, or of all scales of one: the median over its runs. Empty when its steps are asked
    to converge.
    """
    mine = [row for row in rows if name in (row["case"], _name(row["case"]))]
    asked = {row.get(ENDS[0]) for row in mine} - {None}
    if not asked:  # numbers of before 3.5.0: what the sweep file says
        asked = {
            "not_asked" if solver in NOT_ASKED else "asked"
            for case, solver in sweep.solvers.items()
            if name in (case, _name(case))
        }
    residuals = [row[ENDS[1]] for row in mine if row.get(ENDS[1]) is not None]
    return end_word(
        {
            ENDS[0]: "not_asked" if "not_asked" in asked else "asked",
            ENDS[1]: median(residuals) if residuals else None,
        }
    )


def ends_of_part(part: dict, rows: list[dict], sweep: Sweep) -> str:
    """The cases that a part of a claim reads, each with its end; empty when all of them are asked to
    converge.
    """
    cases = [part[key] for key in ("case", "over") if key in part] or sorted({row["case"] for row in rows})
    return "; ".join(f"{case}: {word}" for case in cases if (word := end_of_case(rows, case, sweep)))
