"""`bench engine cases`: what is measured, under this program and under engines that are here; rods and obstacles that move in scenes of engines."""

import json
from pathlib import Path

import numpy as np
import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.studies.engines import card as cards
from barrierbench_analysis.studies.engines import cases, environment, launch, ours, report, scene, verb
from barrierbench_analysis.studies.engines.judged import judge

BY_NAME = {case.name: case for case in cases.CASES}


def quiet(line):
    pass


def measured(name, x, data):
    return [bound.measure(np.array(x, float), data) for bound in BY_NAME[name].bounds]


def within(name, numbers):
    return [b.least <= value <= b.most for b, value in zip(BY_NAME[name].bounds, numbers)]


def test_a_sheet_that_goes_nine_times_too_far_is_outside():
    x = np.zeros((2, 9, 3))
    x[1, :, 0] = 0.002
    assert measured("E1", x, {}) == pytest.approx([2.0]) and within("E1", [2.0]) == [True]
    x[1, 4, 0] = 0.018  # one vertex alone
    assert measured("E1", x, {}) == pytest.approx([18.0]) and within("E1", [18.0]) == [False]


def test_the_stop_is_that_of_coulomb_and_ice_is_outside():
    dt, data = 0.005, {"dt_s": 0.005}
    t = dt * np.arange(81)
    stop = 0.5 / (0.5 * 9.81)
    way = np.where(t < stop, 0.5 * t - 0.5 * 0.5 * 9.81 * t**2, 0.5 * stop / 2)
    x = np.zeros((81, 4, 3))
    x[:, :, 0] = way[:, None]
    assert measured("E2", x, data) == pytest.approx([25.484, 0.0], abs=1e-3) and within("E2", measured("E2", x, data)) == [True, True]
    x[:, :, 0] = 0.5 * t[:, None]
    assert within("E2", measured("E2", x, data)) == [False, False]
    x[:, :, 0] = 0.002 * t[:, None]  # a creep of 2 mm/s
    assert measured("E3", x, data) == pytest.approx([2.0]) and within("E3", [2.0]) == [False]


def test_sheets_that_change_places_are_outside_whenever_they_do():
    data = {"bodies": [{"first_vertex": 0}, {"first_vertex": 2}]}
    x = np.zeros((3, 4, 3))
    x[:, 2:, 2] = np.array([0.02, -0.01, 0.03])[:, None]
    assert measured("E4", x, data) == pytest.approx([-10.0]) and within("E4", [-10.0]) == [False]
    x[:, 0, 2] = -0.03  # the sheet lies in the dent that it made
    assert measured("E4", x, data) == pytest.approx([20.0]) and within("E4", [20.0]) == [True]


def test_our_program_is_within_in_all_cases(program, tmp_path):
    rows = cases.rows_of([cases.OURS], tmp_path, quiet)
    assert [(row["case"], row["outcome"], row["verdict"]) for row in rows] == [(f"E{k}", "within", "clean") for k in (1, 2, 3, 4)], rows
    numbers = {row["case"]: row["numbers"] for row in rows}
    assert numbers["E1"] == pytest.approx([2.0], abs=1e-6)
    # Smoothed friction, f0(v) = 2 v/eps - (v/eps)^2, carries half of mu's load at v = (1 - sqrt(1/2)) eps; eps 1 mm/s.
    assert numbers["E3"] == pytest.approx([1 - 0.5**0.5], rel=1e-3)


def test_an_engine_without_contact_of_cloth_is_outside_and_one_that_is_not_there_is_skipped(program, here, tmp_path, capsys):
    rows = cases.rows_of(["template", "mujoco"], tmp_path, quiet)
    assert [(row["engine"], row["case"], row["outcome"]) for row in rows[:4]] == [
        ("template", "E1", "outside"), ("template", "E2", "refused"), ("template", "E3", "refused"), ("template", "E4", "outside"),
    ]  # fmt: skip
    assert rows[0]["numbers"] == pytest.approx([1.9978], abs=1e-4)  # its damping takes 0.2 % of the speed in 2 ms
    assert rows[3]["numbers"][0] < -20 and "friction" in cards.read_card("template").data["cannot"]
    assert {row["outcome"] for row in rows[4:]} == {"skipped"} and all("./bench engine mujoco setup" in row["detail"] for row in rows[4:])
    page = cases.page_of(rows, "./bench engine cases")
    assert "| template | plain | E4 |" in page and "skipped" in page and "1.999 to 2.001 mm" in page
    assert verb.main(["mujoco", "cases", "--runs", str(tmp_path / "runs")]) == verb.NOT_RUN
    assert "skipped" in capsys.readouterr().out
    assert verb.main(["mujocco", "cases"]) == 2


@pytest.mark.parametrize("name", cards.names())
def test_engines_that_are_here_go_two_millimetres_or_say_why_not(program, tmp_path, name):
    if why := environment.why_not(cards.read_card(name)):
        pytest.skip(f"{name} is {why}")
    for variant in cases.variants_of(name):
        row = cases.row_of(name, variant, BY_NAME["E1"], tmp_path / variant)
        assert row["outcome"] == "within" or (name == "template" and row["numbers"] == pytest.approx([1.9978], abs=1e-4)), row
    card = cards.read_card(name)
    row = cases.row_of(name, cases.variants_of(name)[0], BY_NAME["E2"], tmp_path / "friction")
    assert (row["outcome"] == "refused") == ("friction" in card.data["cannot"]), row


# --- rods


def rod_scene(n=1, stretching=50.0, bending=0.0, held=(0,), steps=60, dt=0.01, gravity=(10.0, 0, 0), mass=0.5, length=0.5):
    """A rod along x, whose mass is lumped at its vertices."""
    x = np.stack([np.linspace(0, length, n + 1), np.zeros(n + 1), np.ones(n + 1)], 1)
    m = np.full(n + 1, mass / n)
    m[[0, -1]] /= 2
    m[list(held)] = 0
    rod = {"stretching_N": stretching, "bending_N_m2": bending} | ({"straight": True} if bending else {})
    body = {"name": "rod", "first_vertex": 0, "vertices": n + 1, "half_thickness_m": 0.0, "d_hat_m": 0.005, "hinge_J": 0.0, "rod": rod}
    data = {
        "schema": "barrierbench.engine_scene/1", "name": "rod", "dt_s": dt, "steps": steps, "gravity_m_s2": list(gravity), "positions_m": x.tolist(),
        "rest_m": x.tolist(), "velocities_m_s": np.zeros_like(x).tolist(), "mass_kg": m.tolist(), "triangles": [], "segments": [[k, k + 1] for k in range(n)],
        "bodies": [body], "given": {"vertices": list(held), "positions_m": [x[list(held)].tolist()]}, "obstacles": [],
    }  # fmt: skip
    return scene.made(data, Path("rod"))


def stretch_of(x):
    return x[:, 1, 0] - x[:, 0, 0] - 0.5


def swing(frames, dt):
    """A mass of 0.25 kg at a spring of 100 N/m under 10 m/s^2, let go without stretch."""
    return 0.025 * (1 - np.cos(20 * dt * np.arange(frames)))


def test_a_rod_of_the_template_swings_as_its_spring_does(program, here, tmp_path):
    data = rod_scene()
    done = launch.run(cards.read_card("template"), data, tmp_path, "plain", {"damping_per_s": 0.0})
    assert done["outcome"] == "ok", done
    x = launch.positions(tmp_path)
    assert stretch_of(x) == pytest.approx(swing(61, 0.01), abs=5e-4) and stretch_of(x).max() > 0.049
    assert judge(tmp_path, data)["gained_J"] < 0.02 * 0.25 * 10 * 0.05
    bends = rod_scene(n=4, bending=1e-3)
    assert launch.run(cards.read_card("template"), bends, tmp_path / "bends", "plain")["outcome"] == "refused"


def static_drop(n, length, gravity):
    """Of the far end of a cantilever of E I = 1 N m^2 and 1 kg/m in n segments, the first of which is held: each vertex turns by
    its moment over E I/h; small angles.
    """
    h = length / n
    mass = np.full(n + 1, h)
    mass[-1] /= 2
    moment = [gravity * sum(mass[j] * (j - i) * h for j in range(i + 1, n + 1)) for i in range(1, n)]
    return float(h * np.cumsum(h * np.array(moment)).sum())


def test_rods_of_mujoco_stretch_and_bend_as_ours(program, tmp_path):
    card = cards.read_card("mujoco")
    if why := environment.why_not(card):
        pytest.skip(f"mujoco is {why}")
    free = {"contact": "penalty", "dt_s": 2e-4}
    done = launch.run(card, rod_scene(), tmp_path / "stretch", "newton", free)
    assert done["outcome"] == "ok", done
    assert stretch_of(launch.positions(tmp_path / "stretch")) == pytest.approx(swing(61, 0.01), abs=1e-3)
    # A cantilever of E I = 1 N m^2, clamped by its first segment: the mean over two periods is its static drop.
    n, length = 20, 0.5
    drop = static_drop(n, length, 2.0)
    period = 2 * np.pi * length**2 / 3.516 * (drop / (2.0 * length**4 / 8)) ** 0.5
    data = rod_scene(n, 5000.0, 1.0, (0, 1), 80, period / 40, (0, 0, -2.0), length, length)
    done = launch.run(card, data, tmp_path / "bend", "newton", {"contact": "penalty", "dt_s": 1e-3})
    assert done["outcome"] == "ok", done
    assert 1 - launch.positions(tmp_path / "bend")[1:, -1, 2].mean() == pytest.approx(drop, rel=0.04) and drop > 0.01
    curved = rod_scene(4, 50.0, 1e-3)
    curved["rest_m"][2][2] += 0.05
    assert "curved at rest" in launch.run(card, curved, tmp_path / "curved", "newton", free)["detail"]
    assert "ipc is of triangles" in launch.run(card, rod_scene(), tmp_path / "ipc", "newton")["detail"]


def test_rods_of_a_config_are_exported_with_their_stiffness(program):
    chain = scene.made(scene.exported(ROOT / "configs/scenes/chain.json", ["/time/steps=2"]), Path("chain"))
    assert chain["bodies"][0]["rod"] == {"stretching_N": pytest.approx(5000 / 16), "bending_N_m2": 0} and len(chain["segments"]) == 16
    cable = scene.made(scene.exported(ROOT / "configs/scenes/hanging_cable.json", ["/time/steps=2"]), Path("cable"))
    assert cable["bodies"][0]["rod"] == {"stretching_N": pytest.approx(5000), "bending_N_m2": pytest.approx(1e-6), "straight": True}
    material = scene.about(cable)["materials"]["cable"]
    assert material["line_density_kg_per_m"] == pytest.approx(0.5) and material["rod_rest"] == "straight"


def test_the_page_of_rods_balances_energies_and_names_warnings():
    record = json.loads((ROOT / "results/engines_rods.json").read_text())
    page = report.text_of(record)
    assert page == (ROOT / "results/ENGINES_RODS.md").read_text()
    assert page.count("| exchanged, J |") == len(record["scenes"]) == 3
    cable = next(one for one in record["scenes"] if one["scene"] == "hanging_cable")
    exchanged = [row["exchanged_J"] for row in cable["rows"] if row["engine"] == "mujoco"]
    assert exchanged[0] > 100 * exchanged[1] > 100 * exchanged[2] > 0
    assert "- warnings of mujoco newton at 10 ms: mjWARN_INERTIA" in page
    for one in record["scenes"]:
        for row in one["rows"]:
            row.pop("gained_J", None)
            row.get("notes", {}).pop("warnings", None)
    bare = report.text_of(record)
    assert "exchanged" not in bare and "warnings" not in bare and "## hanging_cable" in bare


# --- what moves

LIFT = {
    "schema": "barrierbench.config/1",
    "scene": {
        "name": "bodies",
        "gravity_m_per_s2": [0, 0, 0],
        "bodies": [{"name": "sheet", "mesh": {"generator": "grid", "n_x": 3, "n_y": 3, "size_x_m": 0.1, "size_y_m": 0.1}, "transform": {"translate_m": [0, 0, 0.02]}}],
        "obstacles": [{"name": "lift", "kind": "plane", "motion": {"velocity_m_per_s": [0, 0, 1.0]}}],
    },
    "formulation": {"name": "log", "d_hat_m": 0.005},
    "strain_limit": {"enabled": False},
    "time": {"dt_s": 0.005, "steps": 10},
}  # fmt: skip


def test_an_obstacle_that_moves_is_exported_and_judged_where_it_is(program, here, tmp_path):
    (tmp_path / "lift.json").write_text(json.dumps(LIFT))
    config = ours.Config(tmp_path / "lift.json")
    data = scene.made(scene.exported(config.file), Path("lift"))
    (lift,) = data["obstacles"]
    assert np.array(lift["points_m"])[:, 2] == pytest.approx(0.005 * np.arange(11)) and len(data["positions_m"]) == 9 and len(data["bodies"]) == 1
    done = ours.run(config, data, tmp_path / "ours")
    assert done["outcome"] == "ok", done
    assert launch.positions(tmp_path / "ours").shape == (11, 9, 3)
    found = judge(tmp_path / "ours", data)
    assert found["verdict"] == "clean" and found["why_not"].startswith("an obstacle moves")
    still = np.repeat(launch.positions(tmp_path / "ours")[:1], 11, axis=0)  # a sheet that the plane would pass through
    (tmp_path / "still").mkdir()
    np.savez(tmp_path / "still/frames.npz", positions=still, triangles=data["triangles"])
    assert judge(tmp_path / "still", data)["verdict"] == "penetrates"
    done = launch.run(cards.read_card("template"), data, tmp_path / "template", "plain", {"obstacle_N_per_m": 1e3})
    assert done["outcome"] == "ok" and launch.positions(tmp_path / "template")[-1, :, 2].mean() > 0.03
    short = data | {"obstacles": [lift | {"points_m": lift["points_m"][:-1]}]}
    with pytest.raises(UserError, match="#/obstacles/0/points_m: found 10"):
        scene.made(short, Path("short"))


def test_cases_that_an_engine_refuses_all_are_not_green(monkeypatch, tmp_path):
    row = {"case": "E2", "engine": "template", "variant": "plain", "numbers": [], "verdict": "", "detail": "friction"}
    monkeypatch.setattr(cases, "rows_of", lambda *_: [row | {"outcome": cases.REFUSED}, row | {"outcome": cases.SKIPPED}])
    assert verb.main(["template", "cases", "--runs", str(tmp_path)]) == verb.NOT_RUN
    monkeypatch.setattr(cases, "rows_of", lambda *_: [row | {"outcome": cases.REFUSED}, row | {"outcome": cases.WITHIN, "numbers": [25.0, 0.0]}])
    assert verb.main(["template", "cases", "--runs", str(tmp_path)]) == verb.OK
