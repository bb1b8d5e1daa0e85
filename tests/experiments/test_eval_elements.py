"""Energies of elements and friction that `eval` answers, against their formulas from the points in 60 digits, and derivatives against differences."""

import mpmath as mp
import numpy as np
from eval_known import cross, dot, norm, off, requested, sub
from mpmath import mpf


def density(model, s, mu, lam):
    j = s[0] * s[1] * (s[2] if len(s) == 3 else 1)
    green = [(v * v - 1) / 2 for v in s]
    return {
        "arap": lambda: mu * sum((v - 1) ** 2 for v in s),
        "corotational": lambda: mu * sum((v - 1) ** 2 for v in s) + lam / 2 * sum(v - 1 for v in s) ** 2,
        "stvk": lambda: mu * sum(e * e for e in green) + lam / 2 * sum(green) ** 2,
        "stable_neo_hookean": lambda: mu / 2 * (sum(v * v for v in s) - len(s)) - mu * (j - 1) + lam / 2 * (j - 1) ** 2,
    }[model]()


def element_energy(q, x):
    """By the formulas of docs/theory/incremental-potential.md, from the points."""
    model, rest = q["model"], [[mpf(c) for c in p] for p in q["rest"]]
    if model == "spring":
        return mpf(q["k"]) / 2 * (norm(sub(x[1], x[0])) - norm(sub(rest[1], rest[0]))) ** 2
    if model == "rod_bend":
        a, b = sub(x[1], x[0]), sub(x[2], x[1])
        return mpf(q["k"]) / 2 * (mp.atan2(norm(cross(a, b)), dot(a, b)) - mpf(q["rest_angle"])) ** 2
    if model == "hinge":
        e = sub(x[1], x[0])
        first, second = cross(e, sub(x[2], x[0])), cross(sub(x[3], x[0]), e)
        return mpf(q["k"]) / 2 * (mp.atan2(dot(cross(first, second), e) / norm(e), dot(first, second)) - mpf(q["rest_angle"])) ** 2
    mu, lam, n = mpf(q["lame_mu"]), mpf(q["lame_lambda"]), len(rest)
    sides, now = ([sub(p[i], p[0]) for i in range(1, n)] for p in (rest, x))
    if n == 4:
        d = mp.matrix(sides).T
        f = mp.matrix(now).T * d**-1
        s = list(mp.svd_r(f, compute_uv=False))
        s[2] *= mp.sign(mp.det(f))
        return mp.det(d) / 6 * density(model.removesuffix("_solid"), s, mu, lam)
    normal = cross(*sides)
    area, normal = norm(normal) / 2, [c / norm(normal) for c in normal]
    warp = [(1 if i == 0 else 0) - normal[0] * normal[i] for i in range(3)]
    warp = [c / norm(warp) for c in warp]
    weft = cross(normal, warp)
    f = mp.matrix(now).T * mp.matrix([[dot(s, axis) for s in sides] for axis in (warp, weft)]) ** -1
    if model == "baraff_witkin":
        u, v = ([f[i, k] for i in range(3)] for k in range(2))
        return area * (mu / 2 * ((norm(u) - 1) ** 2 + (norm(v) - 1) ** 2) + lam / 2 * dot(u, v) ** 2)
    return area * density(model, list(mp.svd_r(f, compute_uv=False)), mu, lam)


def derivatives_agree(energy, x, answer, scale, rng, directions=6):
    """Energy, gradient and the Hessian along random directions against differences in 60 digits."""
    h, n = mpf(10) ** -15, 3 * len(x)

    def along(direction, step):
        return energy([[c + step * h * mpf(float(direction[3 * i + k])) for k, c in enumerate(p)] for i, p in enumerate(x)])

    e, hessian = energy(x), np.array(answer["hessian"])
    assert abs(answer["energy"] - e) <= 1e-11 * (abs(e) + scale)
    for i, unit in enumerate(np.eye(n)):
        assert abs(answer["gradient"][i] - (along(unit, 1) - along(unit, -1)) / (2 * h)) < 1e-11 * scale, i
    assert (hessian == hessian.T).all()
    for v in rng.normal(size=(directions, n)):
        curvature = (along(v, 1) - 2 * e + along(v, -1)) / (h * h)
        assert abs(v @ hessian @ v - curvature) < 1e-11 * scale * (v @ v)
    projected = np.array(answer["hessian_psd"])
    size = np.abs(hessian).max()
    assert (projected == projected.T).all() and np.linalg.eigvalsh(projected)[0] > -1e-12 * size
    assert np.linalg.eigvalsh(projected - hessian)[0] > -1e-12 * size  # nothing but negative curvature is taken away
    convex = np.linalg.eigvalsh(hessian)[0] > -1e-12 * size
    assert not convex or np.abs(projected - hessian).max() < 1e-12 * size
    return convex


def test_energies(program):
    rng, queries, convex = np.random.default_rng(5), [], 0
    sheets = ["corotational", "arap", "stvk", "stable_neo_hookean", "baraff_witkin"]
    solids = ["corotational_solid", "arap_solid", "stvk_solid", "stable_neo_hookean_solid"]
    for k, model in enumerate(2 * [*sheets, *solids, "spring", "hinge", "rod_bend"]):
        n = {"spring": 2, "rod_bend": 3, "hinge": 4}.get(model, 4 if model in solids else 3)
        rest = np.eye(4)[:n, :3][[3, 0, 1, 2]] if model in solids else np.array([[0, 0, 0], [1, 0, 0.1], [0.3, 1, 0], [0.4, -0.9, 0.2]])[:n]
        rest = rest + rng.uniform(-0.2, 0.2, rest.shape)
        x = rest * 1.4 + rng.uniform(-0.05, 0.05, rest.shape) if k < 12 else rest + rng.uniform(-0.4, 0.4, rest.shape)
        if model in solids and k > 11:
            x[[1, 2]] = x[[2, 1]]  # inverted
        more = {"k": 3.0} if model == "spring" else {"k": 2.0, "rest_angle": 0.3} if model in ("hinge", "rod_bend") else {"lame_mu": 3.0, "lame_lambda": 2.0}
        queries.append({"kind": "energy", "model": model, "rest": rest.tolist(), "x": x.tolist(), **more})
    for q, answer in requested(program, queries):
        x = [[mpf(c) for c in p] for p in q["x"]]
        convex += derivatives_agree(lambda p, q=q: element_energy(q, p), x, answer, 10.0, rng)
        assert np.abs(answer["gradient"]).max() > 1e-3
    assert 2 < convex < len(queries) - 2


def test_friction(program):
    rng, queries = np.random.default_rng(6), []
    for k, n in enumerate(6 * (2, 3, 4, 4)):
        pair = ("point_point", "point_edge", "point_triangle", "edge_edge")[k % 4]
        lagged, start = rng.normal(size=(n, 3)), rng.normal(size=(n, 3))
        end = start + rng.normal(size=(n, 3)) * (0.02, 0.3)[k // 4 % 2]
        law = ("smoothed_coulomb", "capped", "static_kinetic")[k // 8]
        two = {"mu_static": 0.7, "reach": 0.15} if law == "static_kinetic" else {}
        queries.append({"kind": "friction", "law": law, "mu": 0.4, "load": 5.0, "eps": 0.1, "pair": pair, **two,
                        "points_lagged": lagged.tolist(), "points_start": start.tolist(), "points_end": end.tolist()})
    closest = requested(program, [{"kind": "distance", "pair": q["pair"], "points": q["points_lagged"]} for q in queries])
    regimes = set()
    for (q, answer), (_, near) in zip(requested(program, queries), closest):
        weights, eps = [mpf(w) for w in near["weights"]], mpf(q["eps"])
        sums = lambda x, w=weights: [sum(w[i] * mpf(x[i][c]) for i in range(len(w))) for c in range(3)]  # noqa: E731
        n = sums(q["points_lagged"])
        n = [c / norm(n) for c in n]

        def energy(x, slide_only=False, n=n, eps=eps, sums=sums, q=q):
            way = sub(sums(x), sums(q["points_start"]))
            y = norm([a - dot(way, n) * b for a, b in zip(way, n)])
            cap = (eps + y * y / eps) / 2 if q["law"] == "capped" else eps / 3 + y * y / eps - y**3 / (3 * eps**2)
            mu, most, reach = mpf(q["mu"]), mpf(q.get("mu_static", q["mu"])), mpf(q.get("reach", 1))
            if slide_only or y < eps:
                return y if slide_only else most * mpf(q["load"]) * cap
            t = (min(y, reach) - eps) / (reach - eps)  # the integral of most - (most - mu) t^2 (3 - 2 t), then of mu
            falling = most * (reach - eps) * t - (most - mu) * (reach - eps) * (t**3 - t**4 / 2)
            return mpf(q["load"]) * (most * eps + falling + mu * max(y - reach, 0))

        x = [[mpf(c) for c in p] for p in q["points_end"]]
        slide = energy(x, slide_only=True)
        falls = q["law"] == "static_kinetic" and eps < slide < mpf(q["reach"])
        regimes.add((q["law"], bool(slide < eps), bool(falls)))
        assert off(answer["slide"], slide) < 1e-12
        assert derivatives_agree(energy, x, answer, 40.0, rng) == (not falls)  # convex elsewhere
    assert len(regimes) == 7
