"""Shells in whole runs against closed forms: a strip that is clamped at one end and bends under its weight, and a tube that a pressure widens."""

import numpy as np
import pytest
from motions import FIXED, G, run

EI, WIDTH = 1e-3, 0.1  # N m^2, m
YOUNGS, POISSON, RADIUS, PRESSURE = 1000.0, 0.3, 0.5, 4.0  # N/m, 1, m, Pa


def config(body: dict, gravity: float) -> dict:
    scene = {"name": "bodies", "gravity_m_per_s2": [0, 0, -gravity], "bodies": [body]}
    return {"schema": "barrierbench.config/1", "scene": scene, "formulation": {"name": "log", "d_hat_m": 1e-4}, "strain_limit": {"enabled": False}, **FIXED}


def strip(program, tmp_path, cells: int, across: int, load: float) -> np.ndarray:
    """Where the middle of the free end of a strip of 1 m is that bears `load` (N/m): forwards and down, m. Its first column of quads is held: the hinges
    at the end of it bend over half of that column, so that the strip is clamped in its middle. Of `across` quads side by side each has an edge across the
    strip in every row, which is where a strip bends; the diagonals lie in the plane of their quads. So E I = stiffness x edges of a row x their distance.
    """
    step = 1 / (cells - 0.5)
    material = {"youngs_N_per_m": 2e4, "poisson": 0.0, "density_kg_per_m2": load / G / WIDTH, "bending_J": EI / (across * step)}
    mesh = {"generator": "grid", "n_x": cells + 1, "n_y": across + 1, "size_x_m": cells * step, "size_y_m": WIDTH}
    left = -0.5 * cells * step
    pins = [{"box_m": [[left - step / 2, -1, -1], [left + 1.5 * step, 1, 1]]}]
    body = {"name": "strip", "mesh": mesh, "material": material, "pins": pins}
    motion = run(program, config(body, G), "quasi_static", 1.0, 10, tmp_path / f"{cells}-{across}", 1e-10, every=9)
    held = 2 * (across + 1)
    assert motion.record["scene"]["free_dofs"] == 3 * ((cells + 1) * (across + 1) - held)
    rest, end = motion.x[0], motion.x[-1]
    tip = np.isclose(rest[:, 0], rest[:, 0].max())
    assert tip.sum() == across + 1
    return np.array([end[tip, 0].mean() - (rest[:, 0].min() + 0.5 * step), -end[tip, 2].mean()])


@pytest.mark.parametrize("across", [1, 2])
def test_a_strip_bends_as_a_cantilever(program, tmp_path, across):
    """w L^4/(8 E I), within 2% from 16 cells on, and of second order in them."""
    load = 8e-5  # so that it bends by 1% of its length
    exact = load / (8 * EI)
    assert exact == pytest.approx(0.01)
    falls = {cells: strip(program, tmp_path, cells, across, load)[1] for cells in (8, 16, 32)}
    errors = {cells: abs(fall / exact - 1) for cells, fall in falls.items()}
    print("cells, fall m, error:", falls, errors)
    assert errors[16] < 0.02 and errors[32] < 0.01
    assert 3 < errors[8] / errors[16] < 5, errors


def tube(program, tmp_path, around: int, along: int) -> tuple[float, float]:
    """Relative growth of the radius and of the length of a closed tube in its middle. One lid is held, the other is free."""
    length = 4.0
    material = {"youngs_N_per_m": YOUNGS, "poisson": POISSON, "density_kg_per_m2": 0.1, "model": "corotational"}
    mesh = {"generator": "cylinder", "n_around": around, "n_along": along, "radius_m": RADIUS, "length_m": length, "closed": True}
    pins = [{"box_m": [[-1, -1, -length / 2 - 1e-6], [1, 1, -length / 2 + 1e-6]]}]
    body = {"name": "tube", "mesh": mesh, "material": material, "pressure_Pa": PRESSURE, "pins": pins}
    motion = run(program, config(body, 0), "quasi_static", 1.0, 10, tmp_path / f"tube-{around}", 1e-9, every=9)
    rest, end = motion.x[0], motion.x[-1]
    middle = np.abs(rest[:, 2]) < 0.51
    radius = np.linalg.norm(end[middle, :2] - end[middle, :2].mean(axis=0), axis=1)
    assert middle.sum() > around and radius.std() < 2e-3 * radius.mean()
    rows = [x[middle & (np.sign(side) * rest[:, 2] > 0.4)][:, 2].mean() for x in (rest, end) for side in (-1, 1)]
    return radius.mean() / RADIUS - 1, (rows[3] - rows[2]) / (rows[1] - rows[0]) - 1


def test_a_pressure_widens_a_tube(program, tmp_path):
    """p R/(E t) (1 - nu/2) around, where the lids draw with p R/2 along; p R/(E t) (1/2 - nu) along; within 2%."""
    hoop, along = (PRESSURE * RADIUS / YOUNGS * factor for factor in (1 - POISSON / 2, 0.5 - POISSON))
    assert hoop > 1e-3 and along > 3e-4
    found = {around: tube(program, tmp_path, around, cells) for around, cells in ((16, 16), (32, 32))}
    print("around, growth of radius and length:", found, "closed form:", hoop, along)
    assert found[32][0] == pytest.approx(hoop, rel=0.02) and found[32][1] == pytest.approx(along, rel=0.02)
    assert abs(found[32][0] - hoop) < abs(found[16][0] - hoop)
