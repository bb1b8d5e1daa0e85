"""Shells in whole runs against closed forms: a strip that is clamped at one end and bends under its weight, and a tube that a pressure widens."""

import numpy as np
import pytest
from motions import FIXED, G, run

EI, WIDTH, LOAD = 1e-3, 0.1, 8e-5  # N m^2, m, N/m: it bends by 1% of its length of 1 m
YOUNGS, POISSON, RADIUS, PRESSURE = 1000.0, 0.3, 0.5, 4.0  # N/m, 1, m, Pa


def config(body: dict, gravity: float) -> dict:
    scene = {"name": "bodies", "gravity_m_per_s2": [0, 0, -gravity], "bodies": [body]}
    return {"schema": "barrierbench.config/1", "scene": scene, "formulation": {"name": "log", "d_hat_m": 1e-4}, "strain_limit": {"enabled": False}, **FIXED}


def strip(program, tmp_path, cells: int, across: int) -> float:
    """How far the free end of a strip of 1 m falls under LOAD, m. Its first column of quads is held: the hinges at the end of it bend over half of that
    column, so that the strip is clamped in its middle. In every row it has `across` edges over its width, and E I = stiffness x these x their distance.
    """
    step = 1 / (cells - 0.5)
    material = {"youngs_N_per_m": 2e4, "poisson": 0.0, "density_kg_per_m2": LOAD / G / WIDTH, "bending_J": EI / (across * step)}
    mesh = {"generator": "grid", "n_x": cells + 1, "n_y": across + 1, "size_x_m": cells * step, "size_y_m": WIDTH}
    left = -0.5 * cells * step
    pins = [{"box_m": [[left - step / 2, -1, -1], [left + 1.5 * step, 1, 1]]}]
    body = {"name": "strip", "mesh": mesh, "material": material, "pins": pins}
    motion = run(program, config(body, G), "quasi_static", 1.0, 10, tmp_path / f"{cells}-{across}", 1e-10, every=9)
    assert motion.record["scene"]["free_dofs"] == 3 * (cells - 1) * (across + 1)
    rest, end = motion.x[0], motion.x[-1]
    tip = np.isclose(rest[:, 0], rest[:, 0].max())
    assert tip.sum() == across + 1
    return float(-end[tip, 2].mean())


def test_a_strip_bends_as_a_cantilever(program, tmp_path):
    """w L^4/(8 E I), where quads are narrow: their diagonals lie nearly along the strip, and do not fold."""
    exact = LOAD / (8 * EI)
    assert exact == pytest.approx(0.01)
    falls = {cells: strip(program, tmp_path, cells, cells) for cells in (8, 16, 32)}
    print("cells, fall m:", falls, "closed form:", exact)
    assert all(fall == pytest.approx(exact, rel=0.01) for fall in falls.values())


def of_folds(cells: int) -> float:
    """The fall of a strip of one quad across, a row of folds one behind the other: the edges over its width, and between them the diagonals, which turn
    by the part of the moment along them, of which again that part turns the end.
    """
    step = 1 / (cells - 0.5)
    stiffness, along = EI / step, WIDTH**2 / (WIDTH**2 + step**2)
    folds = [(step * (k - 0.5), 1.0) for k in range(1, cells)] + [(step * k, along) for k in range(1, cells)]
    return sum(LOAD * (1 - x) ** 2 / 2 / stiffness * part * (1 - x) for x, part in folds)


def test_a_strip_of_one_quad_across_bends_in_its_diagonals_too(program, tmp_path):
    """So it is up to twice as soft, the more the shorter its quads are: a stiffness of hinges is not one of a material."""
    falls = {cells: strip(program, tmp_path, cells, 1) for cells in (8, 16, 32)}
    exact = {cells: of_folds(cells) for cells in falls}
    print("cells, fall m:", falls, "row of folds:", exact)
    assert exact[32] > 1.8 * LOAD / (8 * EI)
    assert all(falls[cells] == pytest.approx(exact[cells], rel=0.005) for cells in falls)


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
