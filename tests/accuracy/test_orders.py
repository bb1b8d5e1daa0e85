"""Observed order of every integrator in whole runs of the program on smooth problems, and what it does to the energy."""

import subprocess

import numpy as np
import pytest

from motions import BARRIER_S, CHAIN_S, D_HAT, G, MASS, START, barrier_config, barrier_exact, chain_config, chain_exact, run

ORDERS = {"implicit_euler": 1.0, "bdf2": 2.0, "newmark": 2.0}
SMALLEST = 3e-10  # m: rounding and the tolerance of Newton's method, 1e-8 m/s times the time step, stay below

def chain_error(motion) -> float:
    return float(np.linalg.norm(motion.x - chain_exact(motion.times), axis=-1).max())


def barrier_error(motion) -> float:
    assert len(motion.record["steps"]) > 0 and all(step["contacts"]["total"] == 3 for step in motion.record["steps"]), "contact has to be active throughout"
    return float(np.abs(motion.x[:, :, 2] - barrier_exact(motion.times)[:, None]).max())


PROBLEMS = {"chain": (chain_config, CHAIN_S, chain_error, (50, 100, 200, 400, 800)),
            "barrier": (barrier_config, BARRIER_S, barrier_error, (100, 200, 400, 800))}


@pytest.mark.parametrize("problem", PROBLEMS)
@pytest.mark.parametrize("integrator", ORDERS)
def test_observed_order(program, tmp_path, integrator, problem):
    config, duration, error_of, steps = PROBLEMS[problem]
    errors = [error_of(run(program, config(), integrator, duration, n, tmp_path / str(n))) for n in steps]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert min(errors) > SMALLEST, errors
    assert orders[-1] == pytest.approx(ORDERS[integrator], abs=0.1), (integrator, problem, errors, orders)
    slope = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert slope == pytest.approx(ORDERS[integrator], abs=0.1), (errors, orders)


def test_every_integrator_with_inertia_has_an_order(program):
    listed = subprocess.run([program, "list", "integrators"], capture_output=True, text=True, check=True).stdout.splitlines()
    names = {line.split()[0] for line in listed if line.startswith("  ") and not line.startswith("   ")}
    assert names == {*ORDERS, "half_gravity", "quasi_static"}  # half_gravity tends to the motion under g/2: tests/integrators


def swing_energies(motion) -> np.ndarray:
    """Of every step: energy above that of the place of rest, over the same at the start."""
    from scipy.optimize import minimize_scalar

    from barrierbench_analysis.tables.accuracy.shapes import barrier
    from motions import KAPPA

    def potential(gap: float) -> float:
        return 3 * KAPPA * barrier("log", "gap", gap, D_HAT)[0] + MASS * G * gap

    rest = minimize_scalar(potential, bounds=(1e-4, D_HAT), method="bounded", options={"xatol": 1e-12}).fun
    return np.array([(motion.energy(k) - rest) / (potential(START) - rest) for k in range(len(motion.record["steps"]))])


def test_energy_of_a_swing_on_the_barrier(program, tmp_path):
    """32 periods, 63 steps each: implicit Euler stills it, BDF2 takes a little in every period, Newmark keeps it within bounds that do not grow."""
    swings = {name: swing_energies(run(program, barrier_config(), name, 1.0, 2000, tmp_path / name, every=2000)) for name in ORDERS}
    assert all(len(swing) == 2000 for swing in swings.values())
    euler, bdf2, newmark = (swings[name] for name in ("implicit_euler", "bdf2", "newmark"))
    assert euler[-1] < 0.02 and np.diff(euler).max() < 0
    assert 0.98 < bdf2[-1] < 0.995 and np.diff(bdf2[::63]).max() < 0
    assert np.abs(newmark - 1).max() < 1e-4 and np.abs(newmark[-200:] - 1).max() < 1.1 * np.abs(newmark[:200] - 1).max()


def test_quasi_static_has_no_time(program, tmp_path):
    """Every load step ends at rest under its part of the weight, whatever the time step: no order."""
    sheet = {"name": "sheet", "mesh": {"generator": "grid", "n_x": 3, "n_y": 3}, "pins": [{"top_row": True}], "material": {"youngs_N_per_m": 100}}
    scene = {"name": "bodies", "planar": True, "gravity_m_per_s2": [0, -G, 0], "bodies": [sheet]}
    runs = [run(program, {**chain_config(), "scene": scene}, "quasi_static", t, 4, tmp_path / str(t), 1e-9 / t) for t in (0.1, 10.0)]
    assert np.abs(runs[0].x - runs[1].x).max() < 1e-9 and np.abs(runs[0].x[-1] - runs[0].x[0]).max() > 1e-3
    assert all(step["kinetic_J"] == 0 for motion in runs for step in motion.record["steps"])
