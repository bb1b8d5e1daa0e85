"""Elastic energies of frames of any program, their balance, and obstacles that move: against closed forms."""

import json
import subprocess

import numpy as np
import pytest

from barrierbench_analysis.studies.judge import energy, verb

ROD = {"rod_stretching_N": 50.0, "line_density_kg_per_m": 2.0}  # of 1 m: a spring of 50 N/m between two masses of 1 kg
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
TRIANGLES = [[0, 1, 2], [0, 2, 3]]


def judge(tmp_path, x, about, **arrays):
    """Exit code and record of frames [n, vertices, 3]."""
    np.savez(tmp_path / "frames.npz", positions=np.array(x, float), **arrays)
    (tmp_path / "about.json").write_text(json.dumps({"schema": "barrierbench.judge/1", **about}))
    code = verb.main([str(tmp_path / "frames.npz"), "--about", str(tmp_path / "about.json"), "--out", str(tmp_path / "judgement")])
    return code, json.loads((tmp_path / "judgement/judgement.json").read_text()) if code < 2 else {}


def oscillator(steps: int, growth: float = 0.0):
    """Two masses of 1 kg at a spring of 50 N/m and 1 m, stretched by 0.1 m and let go: exact positions, of a period of 0.628 s."""
    dt = 0.628 / 60
    t = dt * np.arange(steps)
    stretch = 0.1 * np.cos(10.0 * t) * np.exp(growth * t)
    x = np.zeros((steps, 2, 3))
    x[:, 0, 0], x[:, 1, 0] = -stretch / 2, 1 + stretch / 2
    return x, {"dt_s": dt, "materials": {"surface": ROD}, "bodies": [{"name": "surface", "vertices": 2}], "segments": [[0, 1]], "rest_m": [[0, 0, 0], [1, 0, 0]]}


def test_elastic_energy_of_a_spring_is_that_of_hooke(program, tmp_path):
    x, about = oscillator(20)
    code, record = judge(tmp_path, x, about)
    assert code == 0
    stretch = x[:, 1, 0] - x[:, 0, 0] - 1
    found = np.array([frame["elastic_J"] for frame in record["frames"]])
    assert found == pytest.approx(25 * stretch**2, rel=1e-12) and found[0] == pytest.approx(0.25)
    assert list(record["frames"][3]["elastic_parts_J"]) == ["springs"]


def test_a_spring_that_swings_gains_nothing_and_one_that_grows_gains_what_it_grows_by(program, tmp_path):
    x, about = oscillator(121)
    _, record = judge(tmp_path, x, about)
    free = record["energy"]
    assert free["gained_J"] < 0.005 * 0.25 and free["exchanged_J"] == pytest.approx(0.25, rel=0.01)
    assert abs(free["lost_J"]) < 0.005 * 0.25
    rate = 0.3
    x, about = oscillator(121, rate)
    (tmp_path / "grows").mkdir()
    _, record = judge(tmp_path / "grows", x, about)
    end = 0.25 * np.exp(2 * rate * about["dt_s"] * 120)
    assert record["energy"]["gained_J"] == pytest.approx(end - 0.25, rel=0.05)
    assert record["energy"]["gained_J"] > 0.2 and record["energy"]["gained_of_every_second_frame_J"] == pytest.approx(record["energy"]["gained_J"], rel=0.1)


def test_what_given_vertices_pull_is_no_gain(program, tmp_path):
    """One end is pulled slowly while the other is held: all of the elastic energy is their work."""
    x = np.zeros((11, 2, 3))
    x[:, 1, 0] = 1 + 0.02 * np.arange(11)
    _, about = oscillator(2)
    _, record = judge(tmp_path, x, about | {"given_vertices": [0, 1]})
    assert record["frames"][-1]["elastic_J"] == pytest.approx(25 * 0.2**2)
    assert record["energy"]["work_of_given_J"] == pytest.approx(25 * 0.2**2) and record["energy"]["gained_J"] < 1e-12
    assert any("prescribed vertices move" in line for line in record["energy"]["conditions"])
    (tmp_path / "free").mkdir()
    _, record = judge(tmp_path / "free", x, about)  # the same motion of free vertices comes from nowhere
    assert record["energy"]["gained_J"] > 0.9 * 25 * 0.19**2


def test_what_a_contact_gives_back_is_no_gain(program, tmp_path):
    """A sheet falls on a floor of springs, which are not in the frames, and comes back as high: exact positions."""
    dt, omega, g = 0.005, 40.0, 10.0
    fall = np.sqrt(2 * 0.2 / g)  # from 0.2 m
    # in contact z = -g/omega^2 (1 - cos) - v/omega sin, until z = 0 again
    speed = g * fall
    phase = 2 * (np.pi - np.arctan2(speed * omega, g))
    def height(t):
        if t < fall:
            return 0.2 - g / 2 * t**2
        s = t - fall
        if s < phase / omega:
            return -g / omega**2 * (1 - np.cos(omega * s)) - speed / omega * np.sin(omega * s)
        s -= phase / omega
        return speed * s - g / 2 * s**2
    z = np.array([height(dt * k) for k in range(100)])
    assert z.min() < -0.03 and z[-40:].max() > 0.19  # it bounced
    about = {"dt_s": dt, "gravity_m_s2": [0, 0, -g], "materials": {"surface": {"youngs_N_per_m": 100, "density_kg_per_m2": 0.5}}, "triangles": TRIANGLES}
    x = SQUARE + np.array([0, 0, 1.0]) * z[:, None, None]
    _, record = judge(tmp_path, x, about | {"bodies": [{"name": "surface", "vertices": 4}]})
    found = record["energy"]
    assert min(found["balance_J"]) < found["balance_J"][0] - 0.5  # the floor holds most of it meanwhile
    assert found["gained_J"] < 1e-3 * found["exchanged_J"] and abs(found["lost_J"]) < 1e-3 * found["exchanged_J"]


def test_free_fall_gains_nothing(program, tmp_path):
    dt, n = 0.01, 41
    x = SQUARE + np.array([0, 0, 1.0]) * (1 - 5 * (dt * np.arange(n)) ** 2)[:, None, None]
    about = {"dt_s": dt, "gravity_m_s2": [0, 0, -10], "materials": {"surface": {"youngs_N_per_m": 100, "density_kg_per_m2": 0.5}}, "triangles": TRIANGLES}
    _, record = judge(tmp_path, x, about | {"bodies": [{"name": "surface", "vertices": 4}]})
    assert record["energy"]["gained_J"] < 1e-12 and record["energy"]["exchanged_J"] == pytest.approx(0.5 * 10 * 0.8, rel=0.05)
    assert record["frames"][-1]["kinetic_J"] == pytest.approx(0.5 * 0.5 * (10 * dt * 39.5) ** 2)


def test_the_membrane_is_that_of_the_program(program, tmp_path):
    """Of every triangle, what `eval` says of the same element."""
    x = np.stack([SQUARE, SQUARE * [1.1, 0.95, 1] + [0, 0, 0.3] * SQUARE[:, [0]]])
    material = {"model": "stvk", "youngs_N_per_m": 100.0, "poisson": 0.25, "density_kg_per_m2": 1.0, "bending_J": 0.02}
    _, record = judge(tmp_path, x, {"dt_s": 1.0, "materials": {"surface": material}, "bodies": [{"name": "surface", "vertices": 4}], "triangles": TRIANGLES})
    mu, lam = 100 / 2.5, 100 * 0.25 / (1 - 0.25**2)
    queries = [
        {"kind": "energy", "model": "stvk", "rest": SQUARE[t].tolist(), "x": x[1][t].tolist(), "lame_mu": mu, "lame_lambda": lam} for t in TRIANGLES
    ]
    done = subprocess.run([program, "eval"], input="\n".join(map(json.dumps, queries)), capture_output=True, text=True, check=True)
    expected = sum(json.loads(line)["energy"] for line in done.stdout.splitlines())
    parts = record["frames"][1]["elastic_parts_J"]
    assert expected > 0.1 and parts["membrane"] == pytest.approx(expected, rel=1e-12)
    assert "hinges" in parts and record["frames"][0]["elastic_J"] == pytest.approx(0, abs=1e-15)


def test_without_a_material_there_is_no_balance_and_the_record_says_why(program, tmp_path):
    x = np.stack([SQUARE, SQUARE])
    _, record = judge(tmp_path, x, {"dt_s": 1.0, "density": {"surface": 1.0}, "bodies": [{"name": "surface", "vertices": 4}], "triangles": TRIANGLES})
    assert record["energy"] == {"gained_J": None, "why_not": "no material is given of surface"}
    assert energy.words(record["energy"]) == ["energy: no balance: no material is given of surface"]


def test_a_wrong_material_is_refused_with_its_place(program, tmp_path, capsys):
    x, about = oscillator(3)
    code, _ = judge(tmp_path, x, about | {"materials": {"surface": {"rod_streching_N": 5}}})
    assert code == 2
    said = capsys.readouterr().err
    assert "rod_streching_N" in said and "materials of --about" in said and "barrierbench-judge-" not in said
    code, _ = judge(tmp_path, x, about | {"materials": {"rope": ROD}})
    assert code == 2 and "#/materials/rope" in capsys.readouterr().err


PLANE = {"name": "lift", "kind": "plane", "axis": [0, 0, 1]}


def still_square(frames):
    return np.repeat((SQUARE + [0, 0, 0.1])[None], frames, axis=0)


def test_an_obstacle_is_where_it_is_at_the_time_of_the_frame(program, tmp_path):
    """A plane rises by 40 mm a frame below a sheet at 100 mm: gaps of 100, 60, 20 and then 20 mm of depth."""
    points = [[0, 0, 0.04 * k] for k in range(4)]
    code, record = judge(tmp_path, still_square(4), {"obstacles": [PLANE | {"points_m": points}]}, triangles=TRIANGLES)
    gaps = [frame["gap_obstacles_m"] for frame in record["frames"]]
    assert gaps[1:] == pytest.approx([0.06, 0.02, -0.02], abs=1e-12)
    assert code == 1 and record["verdict"] == "penetrates"
    assert [frame["obstacle_violations"] > 0 for frame in record["frames"]] == [False, False, False, True]
    (tmp_path / "rests").mkdir()
    code, record = judge(tmp_path / "rests", still_square(4), {"obstacles": [PLANE | {"point_m": [0, 0, 0]}]}, triangles=TRIANGLES)
    assert code == 0 and record["verdict"] == "clean"


def test_an_obstacle_that_passes_between_frames_is_seen(program, tmp_path):
    """A ball goes from one side of a sheet to the other in one frame: no frame shows it in the sheet."""
    ball = {"name": "ball", "kind": "sphere", "radius_m": 0.05, "points_m": [[0.5, 0.4, -0.2], [0.5, 0.4, 0.4]]}
    code, record = judge(tmp_path, still_square(2), {"obstacles": [ball]}, triangles=TRIANGLES)
    assert [frame["obstacle_violations"] for frame in record["frames"]] == [0, 0]
    assert code == 1 and record["verdict"] == "passes_between_frames"
    moved = ball | {"points_m": [[0.5, 0.4, -0.2], [0.5, 0.4, -0.1]]}
    (tmp_path / "near").mkdir()
    assert judge(tmp_path / "near", still_square(2), {"obstacles": [moved]}, triangles=TRIANGLES)[0] == 0


def test_points_of_an_obstacle_are_one_for_each_frame(program, tmp_path, capsys):
    code, _ = judge(tmp_path, still_square(3), {"obstacles": [PLANE | {"points_m": [[0, 0, 0]]}]}, triangles=TRIANGLES)
    assert code == 2 and "#/obstacles/lift/points_m: found 1; a list of 3 points" in capsys.readouterr().err
    both = PLANE | {"points_m": [[0, 0, 0]] * 3, "point_m": [0, 0, 0]}
    code, _ = judge(tmp_path, still_square(3), {"obstacles": [both]}, triangles=TRIANGLES)
    assert code == 2 and "point_m or points_m" in capsys.readouterr().err
