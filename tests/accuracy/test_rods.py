"""Rods in whole runs against beams, the elastica, the catenary and a loop on a sphere; momentum; contact of rods with rods and with cloth."""

import json

import numpy as np
import pytest
from motions import FIXED, ROOT, G, run
from scipy.integrate import solve_bvp
from scipy.optimize import brentq

EI = 1e-3  # N m^2


def config(bodies: list, obstacles=(), gravity: float = G, d_hat: float = 1e-3) -> dict:
    scene = {"name": "bodies", "gravity_m_per_s2": [0, 0, -gravity], "bodies": bodies, "obstacles": list(obstacles)}
    return {"schema": "barrierbench.config/1", "scene": scene, "formulation": {"name": "log", "d_hat_m": d_hat}, **FIXED}


def rod(segments: int, length: float, **material) -> dict:
    return {"name": "rod", "mesh": {"generator": "rod", "n_segments": segments, "length_m": length}, "material": material}


def cantilever(program, tmp_path, segments: int, load: float) -> np.ndarray:
    """Where the tip of a rod of 1 m is that bears `load` (N/m): [2] m, forwards and down. Its first segment is held, and the element
    at its end bends over half of it, so the rod is clamped in the middle of that segment.
    """
    step = 1 / (segments - 0.5)
    body = rod(segments, segments * step, line_density_kg_per_m=load / G, rod_stretching_N=1e4, rod_bending_N_m2=EI)
    body["pins"] = [{"indices": [0, 1]}]
    motion = run(program, config([body]), "quasi_static", 1.0, 10, tmp_path / str(segments), 1e-10, every=9)
    assert motion.record["scene"]["rods"] == segments - 1 and motion.record["scene"]["springs"] == segments - 1
    x = motion.x[-1]
    assert np.abs(x[:, 1]).max() < 1e-12
    return np.array([x[-1, 0] - (x[0, 0] + 0.5 * step), -x[-1, 2]])


def elastica(load: float) -> np.ndarray:
    """The same of the inextensible rod: E I theta'' = -load (1 - s) cos theta, clamped level, its end free."""

    def slopes(s, y):
        return np.array([y[1], -load / EI * (1 - s) * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])])

    s = np.linspace(0, 1, 201)
    guess = np.array([0.5 * s, 0.5 * (1 - s), s, 0.2 * s**2])
    found = solve_bvp(slopes, lambda a, b: np.array([a[0], b[1], a[2], a[3]]), s, guess, tol=1e-10, max_nodes=100000)
    assert found.success, found.message
    return found.y[2:, -1]


def test_the_elastica_of_this_test_is_the_beam_where_it_bends_little():
    assert elastica(8e-5)[1] == pytest.approx(8e-5 / (8 * EI), rel=1e-3)


@pytest.mark.parametrize("load", [8e-5, 1e-2], ids=["small", "large"])
def test_a_cantilever_bends_as_the_beam_and_as_the_elastica(program, tmp_path, load):
    """Of second order in the segments, within 2% from the coarsest on."""
    exact = elastica(load)
    levels = (8, 16, 32)
    tips = [cantilever(program, tmp_path, n, load) for n in levels]
    errors = [float(np.linalg.norm(tip - exact)) for tip in tips]
    print("segments, tip m, error:", [(n, tip.tolist(), error) for n, tip, error in zip(levels, tips, errors)], "exact", exact.tolist())
    assert exact[1] == pytest.approx(0.01, rel=0.01) if load < 1e-3 else exact[1] > 0.6
    if load < 1e-3:
        assert tips[-1][1] == pytest.approx(load / (8 * EI), rel=2e-3)
    assert max(errors) < 0.02 * exact[1]
    assert all(3.5 < a / b < 4.5 for a, b in zip(errors, errors[1:])), errors


def scene(program, tmp_path, name: str, every: int, tolerance: float = 1e-5):
    file = json.loads((ROOT / f"configs/scenes/{name}.json").read_text())
    duration, steps = file["time"]["dt_s"] * file["time"]["steps"], file["time"]["steps"]
    settings = {key: file[key] for key in ("schema", "scene", "formulation")}
    motion = run(program, {**settings, **FIXED}, "implicit_euler", duration, steps, tmp_path / name, tolerance, every=every)
    assert motion.record["audit"]["judged"] > 0 and motion.record["audit"]["crossings"] == 0 and motion.record["audit"]["violations"] == 0
    return motion


def test_a_hanging_cable_is_the_catenary(program, tmp_path):
    x = scene(program, tmp_path, "hanging_cable", 199).x[-1]
    length, span = 1.0, x[-1, 0] - x[0, 0]
    assert span == pytest.approx(0.6, abs=1e-9)
    a = brentq(lambda a: 2 * a * np.sinh(span / (2 * a)) - length, 0.05, 5)
    middle, sag = 0.5 * (x[0, 0] + x[-1, 0]), a * (np.cosh(span / (2 * a)) - 1)
    exact = a * (np.cosh((x[:, 0] - middle) / a) - np.cosh(span / (2 * a)))
    print("sag m:", -x[:, 2].min(), "catenary:", sag, "largest distance:", np.abs(x[:, 2] - x[0, 2] - exact).max())
    assert np.abs(x[:, 2] - x[0, 2] - exact).max() < 0.01 * sag


def test_a_loop_on_a_sphere_is_held_by_its_hoop_tension(program, tmp_path):
    motion = scene(program, tmp_path, "ring_on_sphere", 59)
    first, x = motion.x[0], motion.x[-1]
    radius, height = np.linalg.norm(x[:, :2], axis=1), x[:, 2]
    assert np.ptp(height) < 1e-4 and motion.record["steps"][-1]["contacts"]["total"] >= 48
    middles = 0.5 * (x + np.roll(x, 1, axis=0))  # where edges are closest to the ball
    assert 0.151 < np.linalg.norm(middles, axis=1).min() < 0.153
    strain = np.linalg.norm(x - np.roll(x, 1, axis=0), axis=1) / np.linalg.norm(first - np.roll(first, 1, axis=0), axis=1) - 1
    tension = 0.05 * G * radius.mean() * radius.mean() / height.mean()
    print("tension N:", 20 * strain.mean(), "closed form:", tension)
    assert 20 * strain.mean() == pytest.approx(tension, rel=0.02)


def test_a_noodle_comes_to_lie_on_itself(program, tmp_path):
    motion = scene(program, tmp_path, "noodle", 59)
    last = motion.record["steps"][-1]
    # more contacts than the floor has with the vertices: turns lie on turns
    assert last["contacts"]["total"] > 0 and max(step["contacts"]["edge_edge"] for step in motion.record["steps"]) > 10
    assert np.ptp(motion.x[-1][:, 2]) < 0.5 * np.ptp(motion.x[0][:, 2])


def test_a_free_rod_keeps_its_momentum_while_it_uncoils(program, tmp_path):
    velocity = [0.3, -0.2, 0.5]
    body = {"name": "rod", "mesh": {"generator": "helix", "n_segments": 40, "n_turns": 2, "radius_m": 0.1, "pitch_m": 0.1}, "velocity_m_per_s": velocity,
            "material": {"line_density_kg_per_m": 0.1, "rod_stretching_N": 50, "rod_bending_N_m2": EI, "rod_rest": "straight"}}
    motion = run(program, config([body], gravity=0), "implicit_euler", 0.2, 20, tmp_path / "free", every=1)
    steps = motion.record["steps"]
    assert steps[-1]["elastic_J"] < 0.7 * steps[0]["elastic_J"] and steps[0]["kinetic_J"] > 0
    exact = motion.masses.sum() * np.array(velocity)
    errors = [np.linalg.norm(motion.momentum(k, k + 1) - exact) / np.linalg.norm(exact) for k in range(len(motion.times) - 1)]
    print("relative change of momentum:", max(errors))
    assert max(errors) < 1e-12


def test_rods_lie_along_and_across_a_rod_without_a_crossing(program, tmp_path):
    """One rod is held at its ends; one falls on it along its axis, edges exactly parallel, and a third across both."""
    material = {"line_density_kg_per_m": 0.05, "rod_stretching_N": 500, "rod_bending_N_m2": 1e-4}
    held, along, across = ({**rod(20, 0.4, **material), "offset_m": 0.002, "name": name} for name in ("held", "along", "across"))
    held["pins"] = [{"indices": [0, 20]}]
    along["transform"] = {"translate_m": [0.007, 0, 0.008]}
    across["transform"] = {"axis": [0, 0, 1], "angle_deg": 90, "translate_m": [0.003, 0, 0.016]}
    motion = run(program, config([held, along, across], d_hat=2e-3), "implicit_euler", 0.15, 30, tmp_path / "rods", every=29)
    record = motion.record
    assert record["scene"]["rods"] == 57 and record["audit"]["crossings"] == 0 and record["audit"]["violations"] == 0 and record["audit"]["judged"] > 100
    assert max(step["contacts"]["total"] for step in record["steps"]) > 20 and max(step["contacts"]["edge_edge"] for step in record["steps"]) > 0
    held, along, across = (motion.x[-1][motion.body_of == b] for b in range(3))
    height = [np.interp(0.003, held[:, 0], held[:, 2]), np.interp(0.003, along[:, 0], along[:, 2]), np.interp(0, across[:, 1], across[:, 2])]
    print("heights where they cross, m:", height)
    assert height[1] > height[0] + 0.004 and height[2] > height[1] + 0.004  # twice the radius
    assert min(step["gap_min_m"] for step in record["steps"] if step["gap_min_m"] is not None) > 0


def test_a_loop_lies_on_cloth(program, tmp_path):
    cloth = {"name": "cloth", "mesh": {"generator": "grid", "n_x": 12, "n_y": 12, "size_x_m": 0.4, "size_y_m": 0.4}, "offset_m": 0.001,
             "material": {"youngs_N_per_m": 200, "density_kg_per_m2": 0.2}, "pins": [{"indices": [0, 11, 132, 143]}]}
    ring = {"name": "ring", "mesh": {"generator": "ring", "n_segments": 30, "radius_m": 0.1}, "transform": {"translate_m": [0.003, 0.002, 0.01]}, "offset_m": 0.002,
            "material": {"line_density_kg_per_m": 0.05, "rod_stretching_N": 100, "rod_bending_N_m2": 1e-4}}
    motion = run(program, config([cloth, ring], d_hat=2e-3), "implicit_euler", 0.3, 30, tmp_path / "cloth", every=29)
    record = motion.record
    assert record["audit"]["crossings"] == 0 and record["audit"]["violations"] == 0
    assert min(step["contacts"]["total"] for step in record["steps"][15:]) > 10
    sagged, ring_z = motion.x[-1][motion.body_of == 0, 2], motion.x[-1][motion.body_of == 1, 2]
    assert sagged.min() < -0.005 and ring_z.min() > sagged.min() + 0.003


def test_a_rod_swings_on_an_executor_as_on_the_cpu_path(program, tmp_path):
    body = rod(6, 0.5, line_density_kg_per_m=0.1, rod_stretching_N=50, rod_bending_N_m2=EI)
    body["pins"] = [{"indices": [0, 1]}]
    on_host = run(program, config([body]), "implicit_euler", 0.1, 10, tmp_path / "cpu", 1e-9, every=9)
    device = {"device": "host", "linear_solver": {"name": "pcg_resident", "forcing": "fixed", "tol_rel": 1e-11}}
    there = run(program, {**config([body]), **device}, "implicit_euler", 0.1, 10, tmp_path / "device", 1e-9, every=9)
    assert np.abs(on_host.x[-1] - on_host.x[0]).max() > 1e-2
    assert np.abs(there.x[-1] - on_host.x[-1]).max() < 1e-7
