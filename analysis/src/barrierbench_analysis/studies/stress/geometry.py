"""The tests of geometry: pairs and shapes through `barrierbench eval`, in double and in float, against
exact.py. Each counts its subjects.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from decimal import Decimal
from fnmatch import fnmatchcase
from fractions import Fraction

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.start import evaluated

from . import exact
from .entry import Test

PRECISIONS = ("double", "float")
SCALAR = {"double": np.float64, "float": np.float32}
PAIRS = ("point_triangle", "edge_edge")
SMALL = 10  # ulps: below, float may do anything


@dataclass
class Count:
    """One case in one precision: how many were judged, and the numbers that expectations bound from above."""

    test: str
    case: str
    precision: str
    judged: int
    numbers: dict = field(default_factory=dict)
    not_judged: int = 0
    reason: str = ""
    allowed: dict = field(default_factory=dict)
    as_expected: bool = False


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
        x = np.array(
            [
                [-0.05, 0, gap],
                [0.06, 0, gap],
                [-0.05 * math.cos(angle), -0.05 * math.sin(angle), 0],
                [0.05 * math.cos(angle), 0.05 * math.sin(angle), 0],
            ]
        )
        down = -gap * rng.uniform(1.2, 20)
        way = np.array([[0.5 * gap, 0, down]] * 2 + [[0, 0.5 * gap, 0]] * 2)
    turn = _turn(rng)
    start = x @ turn.T + offset * np.array([1.0, 0.7, 0.4])
    return start.astype(scalar), (start + way @ turn.T).astype(scalar)


def _approaches(offsets: tuple, gaps: tuple, n: int, precision: str) -> list[tuple]:
    """Pair, offset (m), gap (m), start and end of n motions through themselves at each; the same every
    time.
    """
    rng = np.random.default_rng(2)
    made = []
    for pair in PAIRS:
        for offset in offsets:
            for gap in gaps:
                made += [
                    (pair, offset, gap, *_approach(rng, pair, gap, offset, SCALAR[precision]))
                    for _ in range(n)
                ]
    return made


def ccd(quick: bool) -> list[Count]:
    counts: dict[tuple, Count] = {}
    offsets, gaps, n = (
        ((0, 1000), (1e-3, 1e-6), 4)
        if quick
        else ((0, 1, 10, 100, 1000), (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8), 8)
    )
    for precision in PRECISIONS:
        made = _approaches(offsets, gaps, n, precision)
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
        for (pair, offset, gap, x0, x1), answer in zip(made, answers):
            side = "above" if gap >= SMALL * _ulp(x0) else "below"
            count = counts.setdefault(
                (precision, pair, offset, side),
                Count(
                    "S02",
                    f"{pair} offset {offset:g} m, {side} {SMALL} ulps",
                    precision,
                    0,
                    {"let_through": 0, "early": 0},
                ),
            )
            _judge_ccd(
                count, pair, [exact.point(p) for p in x0], [exact.point(p) for p in x1], _ulp(x0), answer
            )
    return list(counts.values())


def _judge_ccd(count: Count, pair: str, x0, x1, ulp: float, answer: dict) -> None:
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


def _distances(test: str, pair: str, made: list[tuple[str, np.ndarray]], precision: str) -> list[Count]:
    """made: case and points. Largest relative error of the distance, and by how much it is over-reported."""
    counts: dict[str, Count] = {}
    answers = evaluated(
        [
            {"kind": "distance", "pair": pair, "points": x.astype(float).tolist(), "precision": precision}
            for _, x in made
        ]
    )
    for (case, x), answer in zip(made, answers):
        count = counts.setdefault(case, Count(test, case, precision, 0, {"error": 0.0, "over_report": 0.0}))
        true = exact.distance(pair, [exact.point(p) for p in x])
        if true == 0:
            count.not_judged += 1
            continue
        error = float(Decimal(answer["d"]) / true - 1)
        count.judged += 1
        count.numbers["error"] = max(count.numbers["error"], abs(error))
        count.numbers["over_report"] = max(count.numbers["over_report"], error)
    return list(counts.values())


def obtuse(quick: bool) -> list[Count]:
    out = []
    for precision in PRECISIONS:
        rng, made = np.random.default_rng(3), []
        for apex in (60, 150, 179.9) if quick else (60, 90, 120, 150, 170, 179, 179.9):
            half = math.radians(apex) / 2
            triangle = 0.1 * np.array(
                [[0, 0, 0], [math.cos(half), math.sin(half), 0], [math.cos(half), -math.sin(half), 0]]
            )
            for _ in range(20 if quick else 200):
                x = np.vstack([rng.uniform(-0.2, 0.2, size=(1, 3)), triangle]) @ _turn(rng).T
                made.append((f"apex {apex:g} deg", x.astype(SCALAR[precision])))
        out += _distances("S03", "point_triangle", made, precision)
    return out


def parallel(quick: bool) -> list[Count]:
    out = []
    for precision in PRECISIONS:
        rng, made = np.random.default_rng(4), []
        for angle in (1e-1, 1e-4, 1e-7) if quick else (1e-1, 1e-2, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6, 1e-7):
            for _ in range(10 if quick else 100):
                a, b = (np.array([math.cos(x), math.sin(x), 0]) for x in (0, angle))
                height, slide = np.array([0, 0, rng.uniform(0.5e-3, 2e-3)]), rng.uniform(-0.4, 0.4)
                x = (
                    np.array([-a / 2, a / 2, slide * a - b / 2 + height, slide * a + b / 2 + height])
                    @ _turn(rng).T
                )
                made.append((f"{angle:g} rad", x.astype(SCALAR[precision])))
        out += _distances("S04", "edge_edge", made, precision)
    return out


def shapes(quick: bool) -> list[Count]:
    del quick
    out = []
    gaps = (1e-6, 1e-3, 0.1, 0.5, 0.9, 0.99, 0.999, 0.9999, 0.99999, 0.999999)
    for precision in PRECISIONS:
        names = [
            (name, float(SCALAR[precision](u)))
            for name in ("log", "log_squared", "quadratic", "cubic", "two_stage", "exponential")
            for u in gaps
        ]
        answers = evaluated(
            [
                {"kind": "shape", "shape": name, "d": u, "d_hat": 1, "precision": precision}
                for name, u in names
            ]
        )
        counts: dict[str, Count] = {}
        for (name, u), answer in zip(names, answers):
            count = counts.setdefault(name, Count("M16", name, precision, 0, {"error": 0.0}))
            for key, true in zip(("b", "db", "d2b"), exact.shape(name, u, 1.0)):
                if answer[key] is None:
                    raise UserError(f"eval: shape {name} at {u}: no {key}")
                count.judged += 1
                count.numbers["error"] = max(
                    count.numbers["error"], float(abs(Decimal(answer[key]) / true - 1))
                )
        out += list(counts.values())
    return out


TESTS = {"ccd": ccd, "obtuse": obtuse, "parallel": parallel, "shapes": shapes}


def run_geometry(test: Test, quick: bool = False) -> list[Count]:
    """Counts of one test, judged. Raises UserError: unknown kind, a case that nothing is expected of."""
    kind = test.data["geometry"]
    if kind not in TESTS:
        raise UserError(f"{test.path}: /geometry: {kind!r}; one of {', '.join(TESTS)}")
    return [judge(count, test) for count in TESTS[kind](quick)]


def judge(count: Count, test: Test) -> Count:
    """By the first expectation that covers its precision and case. What judged nothing is not as expected."""
    for k, entry in enumerate(test.data["expect"]):
        if unknown := set(entry) - {"precisions", "cases", "most", "reason"}:
            raise UserError(
                f"{test.path}: /expect/{k}/{sorted(unknown)[0]}: unknown; allowed: precisions, cases, most,"
                " reason"
            )
        if count.precision in entry["precisions"] and any(
            fnmatchcase(count.case, p) for p in entry.get("cases", ["*"])
        ):
            if missing := set(entry["most"]) - set(count.numbers):
                raise UserError(
                    f"{test.path}: /expect/{k}/most: {sorted(missing)[0]!r}; one of"
                    f" {', '.join(count.numbers)}"
                )
            count.reason, count.allowed = entry["reason"], entry["most"]
            free = not entry["most"]  # anything is expected: rounding may leave nothing to judge
            count.as_expected = free or (
                count.judged > 0 and all(count.numbers[key] <= most for key, most in entry["most"].items())
            )
            return count
    raise UserError(f"{test.path}: /expect: nothing is expected of {count.precision} in case {count.case!r}")
