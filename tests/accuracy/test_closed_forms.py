"""Closed forms: shapes against the program, the bounce against another integrator and simple limits, the catenary against its forces."""

import json
import subprocess

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.tables.accuracy.catenary import chain_nodes
from barrierbench_analysis.tables.accuracy.reference import rigid_gap
from barrierbench_analysis.tables.accuracy.shapes import SHAPES, barrier, gap_of_load
from bounce import BarrierBounce

D_HAT = 0.01


@pytest.mark.parametrize("argument", ["gap", "squared_gap"])
def test_shapes_are_those_of_the_program(program, argument):
    """Written twice on purpose: here they are the oracle."""
    gaps = [D_HAT * u for u in (1e-6, 0.01, 0.3, 0.499, 0.501, 0.82, 0.9, 0.999)]
    queries = [{"kind": "shape", "shape": shape, "argument": argument, "d": d, "d_hat": D_HAT} for shape in SHAPES for d in gaps]
    done = subprocess.run([program, "eval"], input="".join(json.dumps(q) + "\n" for q in queries), capture_output=True, text=True, check=True)
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(answers) == len(queries) == 64
    for query, answer in zip(queries, answers):
        b, slope = barrier(query["shape"], argument, query["d"], D_HAT)
        assert [answer["b"], answer["db"]] == pytest.approx([b, slope], rel=1e-9), query


def test_every_registered_shape_has_a_closed_form(program):
    listed = subprocess.run([program, "list", "shapes"], capture_output=True, text=True, check=True).stdout.splitlines()
    assert {line.split()[0] for line in listed if line.startswith("  ")} == set(SHAPES)


@pytest.mark.parametrize("shape", SHAPES)
def test_gap_of_load_carries_the_load(shape):
    gap = gap_of_load(shape, "gap", 500.0, D_HAT, 3.0)
    assert 0 < gap < D_HAT and 500.0 * -barrier(shape, "gap", gap, D_HAT)[1] == pytest.approx(3.0, rel=1e-12)


def test_a_load_above_the_capacity_is_told():
    """kappa 500: the quadratic carries at most 2 kappa d_hat = 10 N."""
    assert gap_of_load("quadratic", "gap", 500.0, D_HAT, 5.0) == pytest.approx(D_HAT / 2)
    with pytest.raises(UserError, match="at most 10 N"):
        gap_of_load("quadratic", "gap", 500.0, D_HAT, 11.0)
    with pytest.raises(UserError, match="cubik"):
        barrier("cubik", "gap", 0.1, 1.0)


def bounce(shape="log", acceleration=9.81, v0=0.0) -> BarrierBounce:
    return BarrierBounce(shape, "gap", 400.0, D_HAT, 0.3, 3, acceleration, 0.05, v0)


def test_quadratic_without_gravity_is_half_a_harmonic_period():
    """The quadratic is a spring of stiffness n 2 kappa: contact lasts pi sqrt(m/(2 n kappa)), depth v sqrt(m/(2 n kappa))."""
    b = bounce("quadratic", 0.0, 0.1)
    omega = np.sqrt(2 * 3 * 400.0 / 0.3)
    assert 2 * b.half_contact == pytest.approx(np.pi / omega, rel=1e-10)
    assert D_HAT - b.smallest_gap == pytest.approx(0.1 / omega, rel=1e-10)
    assert b.entry_time == pytest.approx(0.4) and b.gap(0.4 + 2 * b.half_contact + 0.1) == pytest.approx(D_HAT + 0.01, rel=1e-9)


@pytest.mark.parametrize("shape", SHAPES)
def test_the_bounce_agrees_with_another_integrator(shape):
    b = bounce(shape, 9.81, 0.2)
    if shape in ("quadratic", "cubic", "exponential", "minimax_bounded"):
        b = BarrierBounce(shape, "gap", 8000.0, D_HAT, 0.3, 3, 9.81, 0.05, 0.2)
    times = np.linspace(0.0, 0.9 * (b.entry_time + b.period), 12)
    inside = [b.entry_time + f * b.half_contact for f in (0.3, 1.0, 1.6)]
    all_times = np.unique(np.concatenate([times, inside]))
    found = solve_ivp(lambda t, y: [y[1], b.contacts * b.kappa * -barrier(shape, "gap", y[0], D_HAT)[1] / b.mass - 9.81], (0.0, all_times[-1]), [0.05, -0.2],
                      method="DOP853", t_eval=all_times, rtol=1e-11, atol=1e-14, max_step=1e-4)
    gaps = np.array([b.gap(t) for t in all_times])
    assert (gaps < D_HAT).sum() >= 3
    assert np.abs(gaps - found.y[0]).max() < 2e-8


def test_a_barrier_that_cannot_stop_the_mass_is_told():
    with pytest.raises(ValueError, match="pass a barrier"):
        bounce("quadratic", 9.81, 30.0).smallest_gap


def test_a_small_d_hat_gives_the_elastic_bounce():
    thin = BarrierBounce("log", "gap", 1e10, 1e-6, 0.3, 3, 9.81, 0.05)
    for t in (0.05, 0.15, 0.25, 0.35):
        assert thin.gap(t) == pytest.approx(rigid_gap(0.05, 0.0, 9.81, t), abs=3e-5)
    fall = np.sqrt(2 * 0.05 / 9.81)
    assert rigid_gap(0.05, 0.0, 9.81, fall) == pytest.approx(0, abs=1e-12) and rigid_gap(0.05, 0.0, 9.81, 2 * fall) == pytest.approx(0.05)
    assert rigid_gap(0.02, 1.0, 0.0, 0.05) == pytest.approx(0.03)


def test_the_chain_is_in_balance_at_every_node():
    nodes = chain_nodes(10, 0.1, 500.0, 0.4, np.array([0.7, 0.1]))
    legs = np.diff(nodes, axis=0)
    length = np.linalg.norm(legs, axis=1)
    pull = (500.0 * (length - 0.1) / length)[:, None] * legs
    assert len(pull) == 10 and np.abs(np.diff(pull, axis=0) - [0.0, 0.4]).max() < 1e-9
    assert nodes[-1] == pytest.approx([0.7, 0.1], abs=1e-12) and nodes[5, 1] < -0.2


def test_a_stiff_fine_chain_is_the_catenary_of_the_textbook():
    """y = a cosh(x/a): length 1 over a span of 0.8 has a sag that a table gives from 2 a sinh(0.4/a) = 1."""
    from scipy.optimize import brentq

    a = brentq(lambda a: 2 * a * np.sinh(0.4 / a) - 1, 0.1, 10)
    nodes = chain_nodes(400, 1 / 400, 1e9, 0.01, np.array([0.8, 0.0]))
    assert -nodes[200, 1] == pytest.approx(a * (np.cosh(0.4 / a) - 1), rel=1e-4)


def test_a_chain_without_an_equilibrium_is_told():
    with pytest.raises(UserError):
        chain_nodes(10, 0.1, 500.0, 0.4, np.array([np.nan, 0.0]))
