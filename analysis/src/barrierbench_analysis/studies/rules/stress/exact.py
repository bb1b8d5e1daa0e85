"""Distances, times of impact and barrier shapes in exact or very long arithmetic: what the answers of `eval`
are compared with. It shares nothing with the program.

Points are tuples of three Fractions; the numbers that the program gets are exactly representable.
"""

from decimal import Decimal, localcontext
from fractions import Fraction

DIGITS = 60
PARTS = 64  # of the motion, looked at one by one
BISECTIONS = 100  # a time of impact to 2^-100 of a part


def point(x) -> tuple:
    return tuple(Fraction(float(c)) for c in x)


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def dot(a, b) -> Fraction:
    return sum((x * y for x, y in zip(a, b)), Fraction(0))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def at(a, b, t: Fraction):
    return tuple(x + t * (y - x) for x, y in zip(a, b))


def root(x: Fraction) -> Decimal:
    with localcontext() as context:
        context.prec = DIGITS
        return (Decimal(x.numerator) / Decimal(x.denominator)).sqrt()


def point_segment(p, a, b) -> Fraction:
    """Squared distance."""
    ab, ap = minus(b, a), minus(p, a)
    t = dot(ap, ab) / dot(ab, ab)
    q = minus(p, at(a, b, min(max(t, Fraction(0)), Fraction(1))))
    return dot(q, q)


def point_triangle(x) -> Fraction:
    """Squared distance of x[0] to the triangle of the other three."""
    p, a, b, c = x
    n = cross(minus(b, a), minus(c, a))
    weights = [dot(cross(minus(w, v), minus(p, v)), n) for v, w in ((a, b), (b, c), (c, a))]
    if min(weights) >= 0:
        return dot(minus(p, a), n) ** 2 / dot(n, n)
    return min(point_segment(p, v, w) for v, w in ((a, b), (b, c), (c, a)))


def edge_edge(x) -> Fraction:
    """Squared distance of the edges x[0] x[1] and x[2] x[3]."""
    a0, a1, b0, b1 = x
    u, v, r = minus(a1, a0), minus(b1, b0), minus(a0, b0)
    uu, vv, uv = dot(u, u), dot(v, v), dot(u, v)
    gram = uu * vv - uv * uv
    if gram > 0:
        s = (uv * dot(v, r) - vv * dot(u, r)) / gram
        t = (uu * dot(v, r) - uv * dot(u, r)) / gram
        if 0 <= s <= 1 and 0 <= t <= 1:
            n = cross(u, v)
            return dot(r, n) ** 2 / dot(n, n)
    return min(
        point_segment(a0, b0, b1),
        point_segment(a1, b0, b1),
        point_segment(b0, a0, a1),
        point_segment(b1, a0, a1),
    )


SQUARED = {"point_triangle": point_triangle, "edge_edge": edge_edge}


def distance(pair: str, x) -> Decimal:
    return root(SQUARED[pair](x))


def _volume(x) -> Fraction:
    return dot(minus(x[1], x[0]), cross(minus(x[2], x[0]), minus(x[3], x[0])))


def _cubic(x0, x1) -> list[Fraction]:
    """Coefficients of the volume over time, from its values at 0, 1, 2, 3."""
    f = [_volume([at(a, b, Fraction(k)) for a, b in zip(x0, x1)]) for k in range(4)]
    d1, d2, d3 = f[1] - f[0], f[2] - 2 * f[1] + f[0], f[3] - 3 * f[2] + 3 * f[1] - f[0]
    return [f[0], d1 - d2 / 2 + d3 / 3, d2 / 2 - d3 / 2, d3 / 6]


def time_of_impact(pair: str, x0, x1) -> Fraction | None:
    """First time in [0, 1] at which the four points lie in a plane with the pair in contact, None: none. The
    volume of the four is a cubic in time; intervals between sign changes on equal parts are bisected, so that
    two roots in one part may be missed.
    """
    c = _cubic(x0, x1)

    def volume(t):
        return c[0] + t * (c[1] + t * (c[2] + t * c[3]))

    marks = [Fraction(k, PARTS) for k in range(PARTS + 1)]
    values = [volume(t) for t in marks]
    scale = max(root(dot(minus(a, b), minus(a, b))) for a in x0 for b in x0)
    for (low, f_low), (high, f_high) in zip(zip(marks, values), zip(marks[1:], values[1:])):
        if f_low != 0 and (f_low > 0) == (f_high > 0):
            continue
        for _ in range(BISECTIONS):
            middle = (low + high) / 2
            if (volume(middle) > 0) == (f_low > 0):
                low = middle
            else:
                high = middle
        if distance(pair, [at(a, b, high) for a, b in zip(x0, x1)]) < scale * Decimal("1e-24"):
            return low  # the volume has its first sign up to here
    return None


def shape(name: str, d: float, d_hat: float) -> tuple[Decimal, Decimal, Decimal]:
    """b, b', b'' of the gap by the formulas of docs/theory/barriers.md."""
    with localcontext() as context:
        context.prec = DIGITS
        d, h = Decimal(d), Decimal(d_hat)
        e, log = d - h, (d / h).ln()
        if name == "log":
            return -e * e * log, -2 * e * log - e * e / d, -2 * log - 4 * e / d + e * e / (d * d)
        if name == "log_squared":
            return (
                e * e * log**2,
                2 * e * log**2 + 2 * e * e * log / d,
                2 * log**2 + 8 * e * log / d + 2 * e * e * (1 - log) / (d * d),
            )
        if name == "quadratic" or (name == "two_stage" and d >= h / 2):
            return e * e, 2 * e, Decimal(2)
        if name == "cubic":
            return 2 * (-e) ** 3 / (3 * h), -2 * e * e / h, -4 * e / h
        if name == "two_stage":
            return h * h / 4 - h * h / 2 * (2 * d / h).ln(), -h * h / (2 * d), h * h / (2 * d * d)
        if name == "exponential":
            a = 6
            t = a * (h - d) / h
            p1 = t.exp() - 1
            return (
                h * h * (p1 - t - t * t / 2) / (a * Decimal(a).exp()),
                -h * (p1 - t) / Decimal(a).exp(),
                a * p1 / Decimal(a).exp(),
            )
    raise KeyError(name)
