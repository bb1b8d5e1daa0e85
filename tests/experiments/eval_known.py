"""What tests of `eval` compute by themselves, in 60 digits and more: shapes with their derivatives, vectors."""

import json
import struct
import subprocess

import mpmath as mp
from mpmath import mpf

EPS = {"double": 2.0**-52, "float": 2.0**-23}
mp.mp.dps = 60


def exponential(a):
    return lambda d, h: h * h * (mp.exp(a * (1 - d / h)) - 1 - a * (1 - d / h) - (a * (1 - d / h)) ** 2 / 2) / (a * mp.exp(a))


def minimax(a, infinite_at_zero):
    c, joint = mp.exp(mpf(5) / 2 - a), 1 / a if infinite_at_zero else mpf(0)

    def b(d, h):
        u = d / h
        t = a * (1 - max(u, joint))
        if t <= 1:
            return h * h * c * t**3 / (6 * a)
        if t <= mpf(3) / 2:
            return h * h * c * (mpf(1) / 6 + t * (t - 1) / 2) / a
        return h * h * (mp.exp(t + 1 - a) - 11 * c / 24 - (mp.log(a * u) if u < joint else 0)) / a

    return b


SHAPES = {
    "log": lambda d, h: -((d - h) ** 2) * mp.log(d / h),
    "log_squared": lambda d, h: (d - h) ** 2 * mp.log(d / h) ** 2,
    "quadratic": lambda d, h: (d - h) ** 2,
    "cubic": lambda d, h: 2 * (h - d) ** 3 / (3 * h),
    "two_stage": lambda d, h: (d - h) ** 2 if 2 * d >= h else h * h * (mpf(1) / 4 - mp.log(2 * d / h) / 2),
    "exponential": exponential(mpf(6)),
    "exponential:0.5": exponential(mpf("0.5")),
    "exponential:40": exponential(mpf(40)),
    "minimax_bounded": minimax(mpf(7), False),
    "minimax_bounded:40": minimax(mpf(40), False),
    "minimax": minimax(mpf(7), True),
    "minimax:3": minimax(mpf(3), True),
}


def requested(program, queries):
    done = subprocess.run([program, "eval"], input="".join(json.dumps(q) + "\n" for q in queries), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
    return list(zip(queries, map(json.loads, done.stdout.splitlines()), strict=True))


def rounded(query):
    """The numbers that the program computes with."""
    if query.get("precision") != "float":
        return query
    walk = lambda v: [walk(x) for x in v] if isinstance(v, list) else struct.unpack("f", struct.pack("f", v))[0] if isinstance(v, float) else v  # noqa: E731
    return {name: walk(value) for name, value in query.items()}


def terms(shape, argument, d, h):
    """b, b', b'' by differences in 200 digits."""
    with mp.workdps(200):
        d, h = mpf(d), mpf(h)
        f = SHAPES[shape]
        b = (lambda x: f(x, h)) if argument == "gap" else (lambda x: f(x * x, h * h) / (h * h))
        s = min(d, h - d) * mpf(10) ** -40
        return b(d), (b(d + s) - b(d - s)) / (2 * s), (b(d + s) - 2 * b(d) + b(d - s)) / (s * s)


def off(value, known):
    return float(abs(mpf(value) - known) / abs(known))


def sub(a, b):
    return [p - q for p, q in zip(a, b)]


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def norm(a):
    return mp.sqrt(dot(a, a))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
