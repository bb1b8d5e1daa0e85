"""Distances that `eval` answers, against rational arithmetic: what a reader of JSON sees is as good as what core/geometry computes."""

import itertools
import json
import math
import random
import struct
import subprocess
from fractions import Fraction

# Ulps of the pair's size: what tests/exact asserts of the function itself.
MOST_ULPS = 4
SPLIT = {"point_edge": (1, 3), "point_triangle": (1, 4), "edge_edge": (2, 4)}


def dot(a: list, b: list) -> Fraction:
    return sum(p * q for p, q in zip(a, b))


def minus(a: list, b: list) -> list:
    return [p - q for p, q in zip(a, b)]


def weights(r: list, d: list) -> list | None:
    """s with the least |r + sum s_k d_k|; None for dependent directions."""
    if not d:
        return []
    if len(d) == 1:
        return [-dot(r, d[0]) / dot(d[0], d[0])] if any(d[0]) else None
    aa, bb, ab, ra, rb = dot(d[0], d[0]), dot(d[1], d[1]), dot(d[0], d[1]), dot(r, d[0]), dot(r, d[1])
    det = aa * bb - ab * ab
    return [(rb * ab - ra * bb) / det, (ra * ab - rb * aa) / det] if det else None


def exact_distance(pair: str, points: list) -> float:
    split, n = SPLIT[pair]
    x = [[Fraction(c) for c in p] for p in points]
    best = None
    first = [f for k in range(1, split + 1) for f in itertools.combinations(range(split), k)]
    second = [f for k in range(1, n - split + 1) for f in itertools.combinations(range(split, n), k)]
    for a, b in itertools.product(first, second):
        r = minus(x[a[0]], x[b[0]])
        d = [minus(x[i], x[a[0]]) for i in a[1:]] + [minus(x[b[0]], x[i]) for i in b[1:]]
        s = weights(r, d)
        if s is None or any(v < 0 for v in s) or sum(s[: len(a) - 1]) > 1 or sum(s[len(a) - 1 :]) > 1:
            continue
        end = [c + sum(s[k] * d[k][i] for k in range(len(d))) for i, c in enumerate(r)]
        best = dot(end, end) if best is None else min(best, dot(end, end))
    # a square root to 200 bits, also of what is far below 1
    shift = 1 << 400
    return float(Fraction(math.isqrt(int(best * shift * shift)), shift))


def hard_points(pair: str, rng: random.Random) -> list:
    points = [[rng.uniform(-1, 1) for _ in range(3)] for _ in range(SPLIT[pair][1])]
    kind = rng.randrange(4)
    if kind == 1:  # far from the origin
        points = [[c + 100 for c in p] for p in points]
    if kind == 2:  # thin, or nearly parallel
        points[-1] = [a + 1e-6 * b for a, b in zip(points[-2], points[-1])]
    if kind == 3:  # coplanar
        points = [[*p[:2], 0.375] for p in points]
    return points


def test_distances_are_those_of_rational_arithmetic(program):
    rng = random.Random(4)
    queries = []
    for k in range(300):
        pair, precision = rng.choice(list(SPLIT)), ("double", "float")[k % 2]
        points = hard_points(pair, rng)
        if precision == "float":
            points = [[struct.unpack("f", struct.pack("f", c))[0] for c in p] for p in points]
        queries.append({"kind": "distance", "pair": pair, "points": points, "precision": precision})
    done = subprocess.run([program, "eval"], input="\n".join(map(json.dumps, queries)), capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, done.stderr
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(answers) == len(queries)
    apart = 0
    for query, answer in zip(queries, answers):
        size = max(max(c) - min(c) for c in zip(*query["points"]))
        ulp = size * (2.0**-52 if query["precision"] == "double" else 2.0**-23)
        assert abs(answer["d"] - exact_distance(query["pair"], query["points"])) <= MOST_ULPS * ulp, query
        apart += answer["d"] > 0
    assert apart > 200
