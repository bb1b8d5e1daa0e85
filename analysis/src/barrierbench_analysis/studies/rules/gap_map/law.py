"""What the rows of a gap map say of single runs and of pairs of a shape and the log: which runs fail, which
gaps are not reached, and the area law against what was measured. Shapes beside each other: compare.py.
"""

import math
from collections import Counter
from dataclasses import dataclass

import numpy as np

from barrierbench_analysis.studies.kit.front import reached
from barrierbench_analysis.tables.outcomes import OK

from .compare import path, runs_of
from .spec import REFERENCE
from .table import NOT_RUN

MADE = 3.0  # contact makes the largest eigenvalue where cond is at least this many times that without contact
FAR = 2.0  # a measured ratio farther than this factor from the predicted one is an exception
STIFF_AT_FIRST_TOUCH = ("quadratic", "two_stage")  # b'' does not vanish at d_hat
LOADS = 1.25  # two runs whose loads differ by more do not carry the same load


def failures(rows: list[dict]) -> dict[tuple[str, str, float], dict[str, int]]:
    """(shape, limit, theta) -> outcome -> runs; runs that reached a gap, and cells that were not run, are not
    in it.
    """
    found: dict[tuple[str, str, float], Counter] = {}
    for r in rows:
        if r["outcome"] not in (OK, NOT_RUN):
            found.setdefault((r["shape"], r["limit"], r["theta"]), Counter())[r["outcome"]] += 1
    return found


def unreached(rows: list[dict], targets: list[float]) -> dict[tuple[str, str], list[float]]:
    """(limit, shape) -> targets that no place's path comes down to: named, never filled in."""
    found = {}
    for limit, shape in dict.fromkeys((r["limit"], r["shape"]) for r in rows):
        ranges = [reached(path(of, "gap")) for of in runs_of(rows, limit, shape).values()]
        if left := [t for t in targets if not any(r and r[0] <= t <= r[1] for r in ranges)]:
            found[limit, shape] = left
    return found


@dataclass(frozen=True)
class Pair:
    """A shape and the log in the same place, with the same target: the same loads, each at the gap that it
    reaches.
    """

    row: dict
    log: dict
    predicted: float  # ratio of rho at the median gaps
    predicted_p05: float  # the same where the 5% of the load that rests deepest begins
    measured: float  # ratio of cond at step ends
    made: tuple[float, float]  # cond over cond without contact, of both
    floor: float  # cond without contact over the log's cond: the ratio below which contact has nothing to say

    @property
    def by_contact(self) -> bool:
        return min(self.made) >= MADE

    @property
    def by_log(self) -> bool:
        """Contact makes the log's, so that its share in the shape's can be predicted from it."""
        return self.made[1] >= MADE

    @property
    def floored(self) -> float:
        """The law with its floor: what rho predicts, or what is left without contact."""
        return max(self.predicted, self.floor)

    @property
    def error(self) -> float:
        """ln(measured/predicted)."""
        return math.log(self.measured / self.predicted)

    @property
    def floor_error(self) -> float:
        return math.log(self.measured / self.floored)

    @property
    def name(self) -> str:
        return "{scene} {resolution}, limit {limit}, theta {theta:g}, {shape}".format(**self.row)


def pairs(rows: list[dict], raw: bool = True) -> list[Pair]:
    """Every row beside the log's of the same place, limit and theta, where both reached a gap and every
    number is there. raw: cond, else block-Jacobi scaled.
    """
    cond, without = ("cond_end", "nc_end") if raw else ("bj_end", "nc_bj_end")

    def key(r: dict) -> tuple:
        return r["scene"], r["resolution"], r["limit"], r["theta"]

    def beside(r: dict, log: dict) -> Pair:
        made = (r[cond] / r[without], log[cond] / log[without])
        rho = (r[name] / log[name] for name in ("rho", "rho_p05"))
        return Pair(r, log, *rho, r[cond] / log[cond], made, r[without] / log[cond])

    needed = ("rho", "rho_p05", cond, without)
    good = [r for r in rows if r["outcome"] == OK and all(r[name] and r[name] > 0 for name in needed)]
    logs = {key(r): r for r in good if r["shape"] == REFERENCE}
    return [beside(r, logs[key(r)]) for r in good if r["shape"] != REFERENCE and key(r) in logs]


def scatter(errors: list[float]) -> tuple[float, float] | None:
    """Mean and standard deviation of ln(measured/predicted); None below two pairs."""
    return (float(np.mean(errors)), float(np.std(errors, ddof=1))) if len(errors) > 1 else None


def reason(pair: Pair) -> str:
    """Why a pair leaves the law with its floor, where its own numbers say so."""
    if not pair.by_log:
        return (
            f"contact does not make the log's largest eigenvalue: cond {pair.log['cond_end']:.3g} with"
            f" contact, {pair.log['nc_end']:.3g} without"
        )
    load = (pair.row["load"] or 0) / (pair.log["load"] or math.inf)
    if (
        load > 0
        and abs(math.log(load)) > math.log(LOADS)
        and abs(math.log(pair.measured / max(pair.predicted * load, pair.floor))) < abs(pair.floor_error)
    ):
        return f"the loads are not the same: the largest is {load:.2f} times the log's"
    if abs(math.log(pair.measured / max(pair.predicted_p05, pair.floor))) <= math.log(FAR):
        return (
            "loads rest at very different gaps: with rho where the deepest 5% of the load begins,"
            f" {pair.predicted_p05:.3g} is predicted"
        )
    if pair.row["shape"] in STIFF_AT_FIRST_TOUCH and pair.measured > pair.floored:
        return (
            "stiffer than predicted, and not explained by these numbers; a reason it can have: a"
            f" `{pair.row['shape']}` contact is as stiff when it bears nothing as at its load, so that those"
            " beside it, which the median load does not count, add up in one place"
        )
    return "not explained by these numbers"


def exceptions(found: list[Pair]) -> list[Pair]:
    """Pairs whose log's is made by contact, and which are farther than FAR from the law with its floor."""
    return sorted(
        (p for p in found if p.by_log and abs(p.floor_error) > math.log(FAR)),
        key=lambda p: -abs(p.floor_error),
    )


def made_by_contact(rows: list[dict], limit: str) -> tuple[int, int]:
    """In how many runs of the log contact makes the largest eigenvalue at step ends, and of how many."""
    mine = [r for of in runs_of(rows, limit, REFERENCE).values() for r in of if r["outcome"] == OK]
    logs = [r["cond_end"] / r["nc_end"] for r in mine if r["cond_end"] and r["nc_end"]]
    return sum(ratio >= MADE for ratio in logs), len(logs)


def sentences(rows: list[dict]) -> list[str]:
    """Of condition numbers as they are, and scaled."""
    return [_sentence(pairs(rows), "Raw"), _sentence(pairs(rows, raw=False), "Block Jacobi")]


def _sentence(found: list[Pair], what: str) -> str:
    """Scatter of both forms of the law."""
    parts = []
    for form, errors in (
        ("the law, contact making both", [p.error for p in found if p.by_contact]),
        ("the law with its floor, contact making the log's", [p.floor_error for p in found if p.by_log]),
    ):
        text = ", too few for a scatter"
        if spread := scatter(errors):
            mean, deviation = spread
            text = (
                f", ln(measured/predicted) {mean:+.2f} in the mean with standard deviation {deviation:.2f} (a"
                f" factor {math.exp(deviation):.2f})"
            )
        parts.append(f"{form}: {len(errors)} of {len(found)} pairs{text}")
    floor = sum(p.by_log and p.floor > p.predicted for p in found)
    parts.append(
        f"in {floor} of the latter the floor decides, which says no more than that contact adds nothing there"
    )
    return f"{what}: {'; '.join(parts)}."
