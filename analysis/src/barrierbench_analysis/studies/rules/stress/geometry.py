"""The tests of geometry: pairs and shapes through `barrierbench eval`, in double and in float, against
exact.py. Each counts its subjects.
"""

import math
from dataclasses import dataclass, field
from decimal import Decimal
from fnmatch import fnmatchcase
from fractions import Fraction

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.spec_file import refused
from barrierbench_analysis.program.start import evaluated

from . import exact
from .entry import Test

SCALAR = {"double": np.float64, "float": np.float32}
OFFSETS, GAPS = (0, 1, 10, 100, 1000), (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)  # m
APEXES, ANGLES = (60, 90, 120, 150, 170, 179, 179.9), (1e-1, 1e-2, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6, 1e-7)
SHAPES = ("log", "log_squared", "quadratic", "cubic", "two_stage", "exponential")
SHARES = (1e-6, 1e-3, 0.1, 0.5, 0.9, 0.99, 0.999, 0.9999, 0.99999, 0.999999)  # gap over d_hat
SMALL = 10  # ulps: below, float may do anything


@dataclass
class Count:
    """One case in one precision: how many were judged, and the numbers that expectations bound from above."""

    case: str
    judged: int = 0
    not_judged: int = 0
    numbers: dict = field(default_factory=dict)

    def raised(self, name: str, value: float) -> None:
        self.numbers[name] = max(self.numbers[name], value)


def _ulp(x: np.ndarray) -> float:
    return float(np.spacing(np.abs(x).max()))


def _turn(rng) -> np.ndarray:
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return q


def _approach(rng, pair: str, gap: float, offset: float, scalar):
    """Start and end of a pair that is `gap` apart and moves through itself, rounded to the scalar."""
    if pair == "point_triangle":
        x = np.array([[0, 0, gap], [-0.05, -0.03, 0], [0.06, -0.04, 0], [0.01, 0.07, 0]])
        way = np.array([[0.3 * gap, 0.2 * gap, -gap * rng.uniform(1.2, 20)], *[[0, 0, 0]] * 3])
    else:
        angle = rng.uniform(0.05, 1.5)
        along = 0.05 * np.array([math.cos(angle), math.sin(angle), 0])
        x = np.array([[-0.05, 0, gap], [0.06, 0, gap], -along, along])
        down = -gap * rng.uniform(1.2, 20)
        way = np.array([[0.5 * gap, 0, down]] * 2 + [[0, 0.5 * gap, 0]] * 2)
    turn = _turn(rng)
    start = x @ turn.T + offset * np.array([1.0, 0.7, 0.4])
    return start.astype(scalar), (start + way @ turn.T).astype(scalar)


def ccd(precision: str) -> list[Count]:
    """Step bounds of pairs that move through themselves, eight motions at each offset and gap."""
    rng, made = np.random.default_rng(2), []
    for pair in exact.SQUARED:
        for offset in OFFSETS:
            for gap in GAPS:
                for _ in range(8):
                    made.append((pair, offset, gap, *_approach(rng, pair, gap, offset, SCALAR[precision])))
    answers = evaluated(
        [
            {
                "kind": "ccd",
                "pair": pair,
                "points_t0": x0.astype(float).tolist(),
                "points_t1": x1.astype(float).tolist(),
                "precision": precision,
            }
            for pair, _, _, x0, x1 in made
        ]
    )
    counts: dict[str, Count] = {}
    for (pair, offset, gap, x0, x1), answer in zip(made, answers):
        side = "above" if gap >= SMALL * _ulp(x0) else "below"
        case = f"{pair} offset {offset:g} m, {side} {SMALL} ulps"
        count = counts.setdefault(case, Count(case, numbers={"let_through": 0, "early": 0}))
        judge_ccd(count, pair, [exact.point(p) for p in x0], [exact.point(p) for p in x1], _ulp(x0), answer)
    return list(counts.values())


def judge_ccd(count: Count, pair: str, x0, x1, ulp: float, answer: dict) -> None:
    gap = exact.distance(pair, x0)
    impact = exact.time_of_impact(pair, x0, x1)
    if gap == 0 or impact is None or impact == 0:
        count.not_judged += 1  # rounding has closed the gap, or taken the contact away
        return
    count.judged += 1
    toi = Fraction(float(answer["toi"]))
    if not answer["hit"] or toi > impact:
        count.numbers["let_through"] += 1
        return
    left = exact.distance(pair, [exact.at(a, b, toi) for a, b in zip(x0, x1)])
    # ACCD stops at 16 ulps, or at half of a gap below twice that
    few = Decimal(64 * ulp)
    if left > max(few, Decimal("0.01") * gap) and not (gap < few and left < Decimal("0.6") * gap):
        count.numbers["early"] += 1


def _distances(pair: str, made: list[tuple[str, np.ndarray]], precision: str) -> list[Count]:
    """made: case and points. Largest relative error of the distance, and by how much it is over-reported."""
    made = [(case, x.astype(SCALAR[precision])) for case, x in made]
    answers = evaluated(
        [
            {"kind": "distance", "pair": pair, "points": x.astype(float).tolist(), "precision": precision}
            for _, x in made
        ]
    )
    counts: dict[str, Count] = {}
    for (case, x), answer in zip(made, answers):
        count = counts.setdefault(case, Count(case, numbers={"error": 0.0, "over_report": 0.0}))
        true = exact.distance(pair, [exact.point(p) for p in x])
        if true == 0:
            count.not_judged += 1
            continue
        error = float(Decimal(answer["d"]) / true - 1)
        count.judged += 1
        count.raised("error", abs(error))
        count.raised("over_report", error)
    return list(counts.values())


def obtuse(precision: str) -> list[Count]:
    rng, made = np.random.default_rng(3), []
    for apex in APEXES:
        half = math.radians(apex) / 2
        x, y = math.cos(half), math.sin(half)
        triangle = 0.1 * np.array([[0, 0, 0], [x, y, 0], [x, -y, 0]])
        for _ in range(200):
            points = np.vstack([rng.uniform(-0.2, 0.2, size=(1, 3)), triangle]) @ _turn(rng).T
            made.append((f"apex {apex:g} deg", points))
    return _distances("point_triangle", made, precision)


def parallel(precision: str) -> list[Count]:
    rng, made = np.random.default_rng(4), []
    for angle in ANGLES:
        a, b = (np.array([math.cos(x), math.sin(x), 0]) for x in (0, angle))
        for _ in range(100):
            height, slide = np.array([0, 0, rng.uniform(0.5e-3, 2e-3)]), rng.uniform(-0.4, 0.4)
            points = np.array([-a / 2, a / 2, slide * a - b / 2 + height, slide * a + b / 2 + height])
            made.append((f"{angle:g} rad", points @ _turn(rng).T))
    return _distances("edge_edge", made, precision)


def shapes(precision: str) -> list[Count]:
    names = [(name, float(SCALAR[precision](u))) for name in SHAPES for u in SHARES]
    answers = evaluated(
        [{"kind": "shape", "shape": name, "d": u, "d_hat": 1, "precision": precision} for name, u in names]
    )
    counts: dict[str, Count] = {}
    for (name, u), answer in zip(names, answers):
        count = counts.setdefault(name, Count(name, numbers={"error": 0.0}))
        for key, true in zip(("b", "db", "d2b"), exact.shape(name, u, 1.0)):
            if answer[key] is None:
                raise UserError(f"eval: shape {name} at {u}: no {key}")
            count.judged += 1
            count.raised("error", float(abs(Decimal(answer[key]) / true - 1)))
    return list(counts.values())


TESTS = {"ccd": ccd, "obtuse": obtuse, "parallel": parallel, "shapes": shapes}


def counted(kind: str, precision: str) -> list[dict]:
    """The counts of one kind of test, as rows keep them."""
    return [vars(count) for count in TESTS[kind](precision)]


def judge(count: Count, precision: str, test: Test) -> tuple[dict, bool]:
    """What is allowed by the first expectation that covers precision and case, and whether it holds. What
    judged nothing is not as expected.
    """
    for k, entry in enumerate(test.data["expect"]):
        is_of_case = any(fnmatchcase(count.case, pattern) for pattern in entry.get("cases", ["*"]))
        if precision in entry["precisions"] and is_of_case:
            allowed = entry["most"]
            if missing := sorted(set(allowed) - set(count.numbers)):
                names = ", ".join(count.numbers)
                raise refused(test.path, f"expect/{k}/most", missing[0], f"one of {names}")
            free = not allowed  # anything is expected: rounding may leave nothing to judge
            holds = free or (
                count.judged > 0 and all(count.numbers[key] <= most for key, most in allowed.items())
            )
            return allowed, holds
    raise UserError(f"{test.path}#/expect: nothing is expected of {precision} in case {count.case!r}")
