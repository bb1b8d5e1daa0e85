"""Observed orders where forces depend on velocities, and where Newmark begins anew: what docs/results/method/accuracy.md says of them."""

import numpy as np
import pytest

from barrierbench_analysis.tables.accuracy.shapes import barrier
from motions import CHAIN_S, FIXED, G, chain_config, chain_exact, run
from scipy.optimize import brentq

STEPS = (50, 100, 200, 400)
DURATION, SPEED = 0.2, 1.5  # s, m/s of the start, upwards
DRAG, DENSITY = 0.8, 0.2  # N s/m^3, kg/m^2
LEFT = 0.05  # of a velocity after a second


def sheet(**more) -> dict:
    """Two triangles without elements that fly flat: their corners have one acceleration."""
    return {"name": "sheet", "mesh": {"generator": "grid", "n_x": 2, "n_y": 2}, "velocity_m_per_s": [0, 0, SPEED], "transform": {"translate_m": [0, 0, 9]},
            "material": {"model": "none", "density_kg_per_m2": DENSITY}, **more}


def flight(rate: float, times: np.ndarray) -> np.ndarray:
    """[times] m of the way up under v' = -g - rate v."""
    limit = -G / rate
    return limit * times + (SPEED - limit) * (1 - np.exp(-rate * times)) / rate


def flight_config(**scene) -> dict:
    return {"schema": "barrierbench.config/1", "scene": {"name": "bodies", "gravity_m_per_s2": [0, 0, -G], "bodies": [sheet()], **scene},
            "formulation": {"name": "log", "d_hat_m": 0.005}, **FIXED}


def order_of(errors: list[float]) -> float:
    assert min(errors) > 3e-10, errors  # above rounding and the tolerance of Newton's method
    return float(np.log2(errors[-2] / errors[-1]))


def flight_errors(program, tmp_path, config: dict, integrator: str, rate: float) -> list[float]:
    errors = []
    for n in STEPS:
        motion = run(program, config, integrator, DURATION, n, tmp_path / str(n))
        errors.append(float(np.abs(motion.x[:, :, 2] - 9 - flight(rate, motion.times)[:, None]).max()))
    return errors


@pytest.mark.parametrize("integrator", ["implicit_euler", "bdf2", "newmark"])
def test_drag_of_the_air_is_of_first_order(program, tmp_path, integrator):
    config = flight_config(air={"normal_N_s_per_m3": DRAG, "tangential_N_s_per_m3": 0.1})
    assert order_of(flight_errors(program, tmp_path, config, integrator, DRAG / DENSITY)) == pytest.approx(1, abs=0.1)


@pytest.mark.parametrize("integrator", ["implicit_euler", "newmark"])
def test_velocity_damping_is_of_first_order(program, tmp_path, integrator):
    config = flight_config(velocity_damping={"factor_per_s": LEFT})
    assert order_of(flight_errors(program, tmp_path, config, integrator, -np.log(LEFT))) == pytest.approx(1, abs=0.1)


def released(**scene) -> dict:
    """The chain, and beside it a sheet that is held up to the middle of the run: there Newmark begins anew, for the chain too."""
    config = chain_config()
    held = sheet(pins=[{"all": True, "release_s": CHAIN_S / 2}], velocity_m_per_s=[0, 0, 0])
    config["scene"]["bodies"].append(held)
    config["scene"] |= scene
    return config


@pytest.mark.parametrize("integrator", ["bdf2", "newmark"])
def test_a_new_start_elsewhere_keeps_the_second_order_of_the_chain(program, tmp_path, integrator):
    errors = []
    for n in (100, 200, 400):
        motion = run(program, released(), integrator, CHAIN_S, n, tmp_path / str(n))
        chain = motion.x[:, motion.body_of == 0]
        errors.append(float(np.linalg.norm(chain - chain_exact(motion.times), axis=-1).max()))
        rest = motion.x[:, motion.body_of == 1, 2] - 9
        assert np.abs(rest[n // 2]).max() == 0 and rest[-1].max() < -0.01, "the sheet has to be let go"
    assert order_of(errors) == pytest.approx(2, abs=0.1), errors


def test_a_new_start_in_the_air_costs_newmark_a_part_of_first_order(program, tmp_path):
    """A sheet in the air beside one that is let go in the middle: the first acceleration after it has no drag."""
    air = {"normal_N_s_per_m3": DRAG, "tangential_N_s_per_m3": 0.1}
    flying = sheet()
    held = sheet(name="held", pins=[{"all": True, "release_s": DURATION / 2}], velocity_m_per_s=[0, 0, 0], transform={"translate_m": [3, 0, 9]})
    errors, alone = [], []
    for n in STEPS:
        both = run(program, flight_config(bodies=[flying, held], air=air), "newmark", DURATION, n, tmp_path / f"both{n}")
        one = run(program, flight_config(air=air), "newmark", DURATION, n, tmp_path / f"one{n}")
        exact = 9 + flight(DRAG / DENSITY, both.times)[:, None]
        errors.append(float(np.abs(both.x[:, both.body_of == 0, 2] - exact).max()))
        alone.append(float(np.abs(one.x[:, :, 2] - exact).max()))
    assert order_of(errors) == pytest.approx(1, abs=0.1)
    assert abs(errors[-1] / alone[-1] - 1) > 0.01, "the new start has to be felt"


@pytest.mark.parametrize(("integrator", "order"), [("implicit_euler", 1), ("bdf2", 2), ("newmark", 1)])
def test_order_of_friction_under_a_load_that_stays(program, tmp_path, integrator, order):
    """A sheet slides over a plane at the gap at which the barrier carries it: v' = -mu g. Newmark's first acceleration has no friction."""
    mu, kappa, d_hat = 0.3, 400.0, 0.01
    weight = DENSITY * G / 4  # of a vertex of a square metre
    gap = brentq(lambda d: kappa * -barrier("log", "gap", d, d_hat)[1] - weight, 1e-6, d_hat * (1 - 1e-9), xtol=1e-16)
    body = sheet(velocity_m_per_s=[SPEED, 0, 0], transform={"translate_m": [0, 0, gap]})
    body["material"]["lumping"] = "uniform"
    floor = {"name": "floor", "kind": "plane", "point_m": [0, 0, 0], "axis": [0, 0, 1]}
    config = flight_config(bodies=[body], obstacles=[floor]) | {
        "formulation": {"name": "log", "d_hat_m": d_hat, "stiffness_policy": {"name": "fixed", "kappa_N_per_m": kappa}},
        "matching": {"rule": "as_given"}, "friction": {"mu": mu}}
    errors = []
    for n in STEPS:
        motion = run(program, config, integrator, DURATION, n, tmp_path / str(n))
        assert all(step["contacts"]["total"] == 4 for step in motion.record["steps"]), "contact has to be active throughout"
        way = motion.x[:, :, 0] - motion.x[0, :, 0]
        errors.append(float(np.abs(way - (SPEED * motion.times - mu * G * motion.times**2 / 2)[:, None]).max()))
    assert order_of(errors) == pytest.approx(order, abs=0.1), errors
