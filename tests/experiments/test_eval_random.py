"""`eval` against computations of its own in 60 digits: random queries of shapes, loads, limits, stiffness, crossings and motions; distances
are in test_eval_exact.py, elements in test_eval_elements.py.
"""

import itertools
import random
from fractions import Fraction

import mpmath as mp
import numpy as np
from eval_known import EPS, SHAPES, cross, dot, off, requested, rounded, sub, terms
from mpmath import mpf


def test_shapes(program):
    rng, queries = random.Random(1), []
    for k in range(400):
        h, u = 10 ** rng.uniform(-6, 2), (rng.uniform(0.01, 0.9), 10 ** rng.uniform(-7, 0))[k % 2]
        queries.append({"kind": "shape", "shape": rng.choice(list(SHAPES)), "argument": rng.choice(["gap", "squared_gap"]), "d": u * h, "d_hat": h,
                        "precision": ("double", "float")[k // 2 % 2]})
    for query, answer in requested(program, queries):
        q = rounded(query)
        b, db, d2b = terms(q["shape"], q["argument"], q["d"], q["d_hat"])
        u, eps = q["d"] / q["d_hat"], EPS[q["precision"]]
        assert off(answer["b"], b) < 200 * eps / (1 - u) and off(answer["db"], db) < 200 * eps / (1 - u), query
        # b'' on the squared gap changes its sign: what cancels there is 2 b'/d
        assert abs(answer["d2b"] - d2b) < 200 * eps / (1 - u) * (abs(d2b) + abs(db) / q["d"]), query


def test_contacts_under_a_load(program):
    rng, queries = random.Random(2), []
    for k in range(150):
        shape, argument = rng.choice(list(SHAPES)), rng.choice(["gap", "squared_gap"])
        u, h, size = rng.uniform(0.02, 0.95), 10 ** rng.uniform(-4, 1), 10 ** rng.uniform(-4, 4)
        common = {"shape": shape, "argument": argument}
        queries += [{"kind": "rho", **common, "u": u}, {"kind": "match", "rule": "equal_force", **common, "d_hat": h, "load": size, "theta": u}]
        if terms(shape, argument, u, 1)[2] > 1e-3:
            queries.append({"kind": "match", "rule": "equal_curvature", **common, "d_hat": h, "curvature": size, "theta": u})
        if k % 3 == 0:
            queries.append({"kind": "equilibrium", **common, "kappa": size, "d_hat": h, "load": size * h * rng.uniform(0.01, 0.3)})
    answered = 0
    for q, answer in requested(program, queries):
        if q["kind"] == "equilibrium":
            if answer.get("status") == "above_capacity":
                continue
            _, db, d2b = terms(q["shape"], q["argument"], answer["d"], q["d_hat"])
            rounding = 8 * EPS["double"] * (1 + float(abs(d2b) * q["d_hat"] / abs(db)))
            assert off(q["kappa"] * abs(db), q["load"]) < rounding and off(answer["K"], q["kappa"] * d2b) < 1e-9, q
            above = [terms(q["shape"], q["argument"], answer["d"] + (q["d_hat"] - answer["d"]) * i / 20, q["d_hat"])[1] for i in range(1, 20)]
            assert max(q["kappa"] * abs(x) for x in above) < q["load"], q  # the largest such gap
            answered += 1
            continue
        u, h = (q["u"], 1) if q["kind"] == "rho" else (q["theta"], q["d_hat"])
        _, db, d2b = terms(q["shape"], q["argument"], mpf(u) * h, h)
        if q["kind"] == "rho":
            assert abs(answer["rho"] - d2b / abs(db)) < 1e-12 * (abs(d2b / db) + 1 / u), q
        else:
            known = q["load"] / abs(db) if "load" in q else q["curvature"] / d2b
            assert off(answer["kappa"], known) < 1e-11, q
    assert answered > 30


def test_strain_limits_and_singular_values(program):
    rng, queries = np.random.default_rng(3), []
    for k in range(120):
        m, n = ((2, 2), (3, 2), (3, 3))[k % 3]
        f = rng.normal(size=(m, n)) * 10.0 ** (rng.integers(-120, 120) if k % 4 == 0 else 0)
        if k % 5 == 0:
            f = np.outer(f[:, 0], f[0]) / np.abs(f).max()  # of rank one
        queries.append({"kind": "svd", "F": f.tolist()})
        onset, width = float(rng.choice([0, 0.01])), 10 ** rng.uniform(-3, 0)
        s = 1 + onset + width * np.sort(rng.uniform(0.05, 0.9, 2))[::-1]
        u, v = np.linalg.qr(rng.normal(size=(3, 2)))[0], np.linalg.qr(rng.normal(size=(2, 2)))[0]
        queries.append({"kind": "strain_limit", "shape": list(SHAPES)[k % len(SHAPES)], "F": (u * s @ v.T).tolist(), "onset": onset, "width": width})
    for q, answer in requested(program, queries):
        f = np.array(q["F"])
        if q["kind"] == "svd":
            u, s, v = (np.array(answer[name]) for name in ("U", "sigma", "V"))
            size = np.abs(f).max()
            assert np.abs(u * (s / size) @ v.T - f / size).max() < 1e-14 and np.abs(u.T @ u - np.eye(len(s))).max() < 1e-14, q
            assert abs(np.linalg.det(v) - 1) < 1e-14 and (f.shape == (3, 2) or abs(np.linalg.det(u) - 1) < 1e-14), q
            assert (np.diff(np.abs(s)) <= 0).all() and (s[:-1] >= 0).all() and (f.shape != (3, 2) or s[-1] >= 0), q
            continue
        u, s, vt = mp.svd_r(mp.matrix(q["F"]))
        width, slopes = mpf(q["width"]), []
        for k in range(2):
            y = width - (s[k] - 1 - mpf(q["onset"]))
            b, db, d2b = terms(q["shape"], "gap", y, width)
            slopes.append(-db)
            rounding = 1e-13 + 1e-15 / float(min(y, width - y)) * 8
            assert max(off(answer["E"][k], b), off(answer["dE"][k], -db), off(answer["d2E"][k], d2b)) < rounding, q
        stress = [[sum(u[i, k] * slopes[k] * vt[k, j] for k in range(2)) for j in range(2)] for i in range(3)]
        largest = max(slopes) * (1 + 1 / float(s[0] - s[1] + width * mpf(0.01)))
        assert max(abs(stress[i][j] - answer["PK1"][i][j]) for i in range(3) for j in range(2)) < 1e-11 * largest, q


def test_stiffness(program):
    rng, queries = np.random.default_rng(4), []
    for k in range(90):
        n = 1 + k % 4
        a, w, normal = rng.normal(size=(3 * n, 3 * n)), rng.uniform(-1, 1, n), rng.normal(size=3)
        queries.append({"kind": "stiffness", "policy": "elasticity_inclusive", "mass_term": ("paper", "inertia", "none")[k % 3], "weights": w.tolist(),
                        "normal": (normal / np.linalg.norm(normal)).tolist(), "gap": 10 ** rng.uniform(-4, 0), "masses": rng.uniform(0.1, 2, n).tolist(),
                        "hessian": (a @ a.T).tolist(), **({"dt": 0.013, "c": 4 / 9} if k % 3 == 1 else {})})
    for q, answer in requested(program, queries):
        w = np.kron(q["weights"], q["normal"])
        over = {"paper": q["gap"] ** 2, "inertia": q.get("c", 0) * q.get("dt", 0) ** 2, "none": np.inf}[q["mass_term"]]
        mass = w * np.repeat(q["masses"], 3) / over
        assert abs(answer["kappa"] / ((w @ mass + w @ np.array(q["hessian"]) @ w) / (w @ w)) - 1) < 1e-11, q


def orient(a, b, c, d):
    return dot(cross(sub(b, a), sub(c, a)), sub(d, a))


def crosses(segment, triangle):
    """Of end points strictly on opposite sides of the plane: through the inside, its border, or beside it; else None."""
    ends = orient(*triangle, segment[0]), orient(*triangle, segment[1])
    if ends[0] * ends[1] >= 0:
        return None
    sides = [orient(*segment, triangle[i], triangle[(i + 1) % 3]) for i in range(3)]
    inside = all(s > 0 for s in sides) or all(s < 0 for s in sides)
    return {"crossing": inside, "touch": not inside and (all(s >= 0 for s in sides) or all(s <= 0 for s in sides))}


def test_crossings(program):
    rng, queries = random.Random(7), []
    for k in range(600):
        scale = 10.0 ** (0, -150, 150)[k % 3]
        points = [[rng.randrange(-2, 3) * scale for _ in range(3)] for _ in range(5)]
        if k % 2:  # within rounding of a lattice
            points = [[c * (1 + rng.choice([0, 0, 2.0**-52])) for c in p] for p in points]
        queries.append({"kind": "intersects", "segment": points[:2], "triangle": points[2:]})
    seen = {"crossing": 0, "touch": 0}
    for q, answer in requested(program, queries):
        known = crosses(*([[Fraction(c) for c in p] for p in q[name]] for name in ("segment", "triangle")))
        assert not (answer["crossing"] and answer["touch"]), q
        assert answer == known if known else not answer["crossing"], q
        seen = {word: seen[word] + answer[word] for word in seen}
    assert seen["crossing"] > 15 and seen["touch"] > 30


def test_a_motion_is_free_until_its_time_of_impact(program):
    """Points against points and edges against edges, a third of which meet half-way: gaps at a hundred times on the way."""
    rng, queries = np.random.default_rng(8), []
    for k in range(80):
        n = 2 if k % 2 else 4
        start, end = rng.normal(size=(2, n, 3))
        if k % 3 == 0:
            side = rng.normal(size=(2, 3))
            middle = np.zeros((2, 3)) if n == 2 else np.array([-side[0], side[0], -side[1], side[1]])
            end = 2 * middle - start
        queries.append({"kind": "ccd", "pair": "point_point" if n == 2 else "edge_edge", "points_t0": start.tolist(), "points_t1": end.tolist(),
                        "offset": float(rng.choice([0, 0.05, 0.4]))})
    states = []
    for q, answer in requested(program, queries):
        start, end = np.array(q["points_t0"]), np.array(q["points_t1"])
        times = np.unique([*np.linspace(0, 1, 101), *(answer["toi"] * np.array([0.5, 0.9, 0.999, 1 - 1e-6]))])
        states += [(q, answer, t, {"kind": "distance", "pair": q["pair"], "points": (start + t * (end - start)).tolist()}) for t in times]
    gaps = [near["d"] - q["offset"] for (q, _, _, _), (_, near) in zip(states, requested(program, [s[3] for s in states]))]
    hits = 0
    for _, group in itertools.groupby(zip(states, gaps), key=lambda item: id(item[0][0])):
        group = list(group)
        _, answer, _, _ = group[0][0]
        before = [gap for (_, _, t, _), gap in group if t < answer["toi"]]
        least = min(gap for _, gap in group)
        if answer.get("status") == "overlap_at_start":
            assert group[0][1] <= 0 and answer["toi"] == 0
            continue
        assert all(gap > 0 for gap in before) and answer["hit"] == (answer["toi"] < 1)
        if least <= 0:
            assert answer["hit"]
        hits += answer["hit"]
    assert hits > 30
