"""Iterations that Newton's method takes where one contact is too deep (docs/theory/newton-price.md)."""

import math

import pytest

from barrierbench_analysis.program.start import evaluated

DEEP, LOAD_GAP = 1e-5, 0.1  # gaps in d_hat: where Newton's method starts, and where the log rests


def force(shape, u):
    """(f, |f'|) of the barrier of the program, d_hat 1 m and kappa 1 N/m."""
    found = evaluated([{"kind": "shape", "shape": shape, "argument": "gap", "d": u, "d_hat": 1}])[0]
    return -found["db"], found["d2b"]


def falls(shape, load, u, most=60):
    """ln f of the iterates of Newton's method for f(u) = load, until it is within 1e-10."""
    found = []
    for _ in range(most):
        f, slope = force(shape, u)
        found.append(math.log(f / load))
        if abs(found[-1]) < 1e-10:
            return found
        u += (f - load) / slope
    raise AssertionError(f"{shape}: {found}")


def test_the_log_takes_ln_2_off_the_logarithm_of_the_load():
    load = force("log", LOAD_GAP)[0]
    path = falls("log", load, DEEP)
    deep = [a - b for a, b in zip(path, path[1:]) if a > math.log(100)]
    assert len(deep) >= 6 and path[0] > 8
    assert deep == pytest.approx([math.log(2)] * len(deep), rel=0.02)


def test_the_exponential_takes_one():
    load = force("exponential:20", 0.9)[0]
    path = falls("exponential:20", load, 0.05)
    deep = [a - b for a, b in zip(path, path[1:]) if a > math.log(1000)]
    assert len(deep) >= 6
    assert deep == pytest.approx([1.0] * len(deep), rel=0.02)


def test_the_cubic_takes_twice_ln_2():
    load = force("cubic", 0.999)[0]
    path = falls("cubic", load, 0.0)
    deep = [a - b for a, b in zip(path, path[1:]) if a > math.log(1000)]
    assert len(deep) >= 4
    assert deep == pytest.approx([2 * math.log(2)] * len(deep), rel=1e-3)


def test_the_quadratic_is_linear():
    assert len(falls("quadratic", force("quadratic", 0.999)[0], 0.01)) == 2


@pytest.mark.parametrize("overshoot", [1e2, 1e4])
def test_the_log_needs_at_most_twice_the_iterations_of_the_cubic(overshoot):
    """From the same overshoot: the log from its small gaps, the cubic from contact."""
    log = falls("log", force("log", 1e-6 * overshoot)[0], 1e-6)
    cubic = falls("cubic", 2 / overshoot, 0.0)
    assert log[0] == pytest.approx(cubic[0], abs=0.3)
    ratio = (len(log) - 1) / (len(cubic) - 1)
    assert 1.2 < ratio <= 2
