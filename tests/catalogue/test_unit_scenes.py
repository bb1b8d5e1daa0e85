"""The scenes of one contact or one body against closed forms: where two points turn, what a lever and a funnel carry."""

import numpy as np
import pytest
from own_spec import run as made, written
from scipy.optimize import brentq
from scipy.spatial import ConvexHull

from barrierbench_analysis.io.record_file import read_record
from barrierbench_analysis.tables.accuracy.shapes import barrier
from barrierbench_analysis.tables.accuracy.state import read_motion
from barrierbench_analysis.studies.catalogue.entry import read_entry

G, DENSITY = 9.81, 1000.0


@pytest.fixture(autouse=True)
def built(program, monkeypatch):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)


def run(name, tmp_path, label="log", **given):
    """The scene, the record of its run and its folder."""
    entry = read_entry(name)
    (row,), (folder,) = made(written(tmp_path / label, "catalogue", [name], [label], **given))
    assert row.outcome == "ok" and not row.values["red"] and len(row.values["seen"]) == len(entry.data["expect"]), row
    return entry, read_record(folder / "run.json"), folder


@pytest.mark.parametrize("shape", ["log", "cubic", "quadratic"])
def test_two_points_turn_where_the_barrier_has_their_energy(tmp_path, shape):
    """kappa b(d) = 1/2 mu v^2, v the speed at which they meet, mu half of the mass of one; then velocities are exchanged."""
    entry, record, folder = run("two-points", tmp_path, shape, **{"/integrator/name": "newmark"})
    left, right = entry.config()["scene"]["bodies"]
    mass = left["material"]["line_density_kg_per_m"] * left["mesh"]["length_m"] / 2
    energy = 0.5 * (mass / 2) * (left["velocity_m_per_s"][0] - right["velocity_m_per_s"][0]) ** 2
    kappa, d_hat = record["matching"]["kappa_N_per_m"], 0.01
    exact = brentq(lambda d: kappa * barrier(shape, "gap", d, d_hat)[0] - energy, 1e-9, d_hat)
    found = record["summary"]["gap_min_m"]
    print(shape, "turn at", found, "m, closed form", exact)
    assert 0.01 < exact / d_hat < 0.5 and found == pytest.approx(exact, rel=2e-3)
    x = read_motion(folder).x  # the first and the last state
    start, end, time = x[0], x[-1], record["steps"][-1]["t_s"]
    rear = end[0, 0] - start[0, 0]  # of the end that meets nothing: it goes on as it came
    assert rear == pytest.approx(0.5 * time, rel=1e-9) and end[1, 0] < start[1, 0] + 0.5 * rear
    assert record["steps"][-1]["kinetic_J"] == pytest.approx(record["steps"][0]["kinetic_J"], rel=1e-5)


@pytest.mark.parametrize("label", ["log", "cubic"])
def test_a_wedge_carries_what_the_lever_asks_for(tmp_path, label):
    entry, record, folder = run("beam-on-wedge", tmp_path, label)
    beam, wedge = entry.config()["scene"]["bodies"]
    mesh = beam["mesh"]
    weight = DENSITY * G * mesh["size_x_m"] * mesh["size_y_m"] * mesh["size_z_m"]
    exact = weight * (mesh["size_x_m"] / 2) / wedge["transform"]["translate_m"][0]
    (stated,) = (one["load_N"] for one in entry.data["expect"] if one["check"] == "carries")
    assert exact == pytest.approx(65.4) and stated == pytest.approx(exact, rel=1e-6)
    assert record["steps"][-1]["contact_load_sum_N"] == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize("label", ["log", "cubic"])
def test_a_funnel_carries_the_weight_over_the_sine_of_its_half_angle(tmp_path, label):
    entry, record, folder = run("ball-in-funnel", tmp_path, label)
    ball, funnel = entry.config()["scene"]["bodies"]
    n = ball["mesh"]["n"]
    x = read_motion(folder).x
    ours = (2 * n + 1) * (5 * n * n + 5 * n + 3) // 3  # vertices of the ball
    weight = DENSITY * G * ConvexHull(x[0][:ours]).volume
    cone = funnel["mesh"]
    half_angle = np.arctan(np.cos(np.pi / cone["n_around"]) * cone["radius_m"] / cone["height_m"])
    exact = weight / np.sin(half_angle)
    (stated,) = (one["load_N"] for one in entry.data["expect"] if one["check"] == "carries")
    load = record["steps"][-1]["contact_load_sum_N"]
    print("load", load, "N, closed form", exact, "weight", weight)
    assert stated == pytest.approx(exact, rel=1e-3) and load == pytest.approx(exact, rel=1e-3) and exact > 1.5 * weight
    center = x[-1][:ours].mean(axis=0)  # in the axis, as high as the radius requires, less what the ball gives way and its corners lack
    radius = ball["mesh"]["radius_m"]
    assert np.abs(center[:2]).max() < 1e-6 and 0.97 * radius < center[2] * np.sin(half_angle) < radius + 0.004
