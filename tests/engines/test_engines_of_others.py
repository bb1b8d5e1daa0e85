"""`bench engine`: cards, scenes for engines, the template from a config to a judgement, and every way to fail by its name."""

import json
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

from barrierbench_analysis.io import input_file
from barrierbench_analysis.studies.catalogue.entry import read_entry, write_config
from barrierbench_analysis.studies.kit.study.page import rows_of
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.engines import card as cards
from barrierbench_analysis.studies.engines import compare, environment, figure, launch, level, matching, scene, verb
from barrierbench_analysis.studies.engines.judged import energy_of, error_of, judge
from barrierbench_analysis.studies.engines.report import text_of
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.trajectories.arrays import of_npz
from barrierbench_analysis.io.places import ROOT

HANG = ROOT / "configs/scenes/hang.json"
SMALL = ["/scene/n=5", "/strain_limit/enabled=false", "/time/steps=6"]


def sheet(n=4, height=1.0, steps=10, **keys):
    """n x n vertices, 0.1 m apart, of 0.01 kg each, that falls."""
    i, j = (k.ravel() for k in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    x = np.stack([0.1 * i, 0.1 * j, np.full(n * n, height)], 1)
    corner = [a * n + b for a in range(n - 1) for b in range(n - 1)]
    triangles = [t for p in corner for t in ([p, p + n, p + n + 1], [p, p + n + 1, p + 1])]
    membrane = {"model": "corotational", "lame_mu_N_per_m": 100.0, "lame_lambda_N_per_m": 60.0}
    body = {"name": "sheet", "first_vertex": 0, "vertices": n * n, "half_thickness_m": 0.0, "d_hat_m": 0.005, "membrane": membrane, "hinge_J": 0.0}
    data = {
        "schema": "barrierbench.engine_scene/1", "name": "sheet", "dt_s": 0.01, "steps": steps, "gravity_m_s2": [0, 0, -10],
        "positions_m": x.tolist(), "rest_m": x.tolist(), "velocities_m_s": np.zeros_like(x).tolist(), "mass_kg": [0.01] * (n * n),
        "triangles": triangles, "bodies": [body], "given": {"vertices": [], "positions_m": [[]]}, "obstacles": [],
    }  # fmt: skip
    return scene.made(data | keys, Path("sheet"))


def test_the_scene_that_tries_an_installation_is_whole():
    data = scene.read(scene.SMALLEST)
    assert data["obstacles"] and data["given"]["vertices"] and len(data["bodies"]) == 2 and data["steps"] == 3


def stand_in(tmp_path, body):
    """An engine whose adapter is this code, with the card of the template."""
    folder = tmp_path / "engines" / "template"
    folder.mkdir(parents=True)
    for name in ("card.toml", "requirements.txt"):
        (folder / name).write_text((cards.ENGINES / "template" / name).read_text())
    (folder / "adapter.py").write_text(body)
    return cards.read_card("template", tmp_path / "engines")


def test_frames_of_an_engine_may_be_as_large_as_the_judge_takes_them(tmp_path):
    """More than a mesh may have; the hole in the file takes no place on the disk."""
    x = np.arange(12.0).reshape(2, 2, 3)
    with zipfile.ZipFile(tmp_path / "frames.npz", "w") as file:
        with file.open("positions.npy", "w") as part:
            np.lib.format.write_array(part, x)
        file.start_dir += input_file.LARGE  # where the list of the parts begins
    assert (tmp_path / "frames.npz").stat().st_size > input_file.LARGE
    np.testing.assert_array_equal(launch.positions(tmp_path), x)
    np.testing.assert_array_equal(list(of_npz(tmp_path / "frames.npz").frames()), x)


@pytest.mark.parametrize("name", cards.names())
def test_every_card_is_whole(name):
    card = cards.read_card(name)
    assert card.data["guarantee"]["citation"] and card.data["maps"] and card.data["cannot"]
    assert all("==" in line for line in card.requirements.read_text().split())


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ("[fit]\nstretch = \"stretch_factor\"", "[fit]\nstretch = \"stretch\"", "#/fit: found 'stretch'"),
        ("licence = ", "license = ", "#/licence: is missing"),
        ("words = \"None:", "word = \"None:", "#/guarantee/words: is missing"),
        ("[maps]", "[maps", "not TOML"),
    ],
)
def test_a_broken_card_is_refused_with_its_place(tmp_path, old, new, place):
    stand_in(tmp_path, "")
    path = tmp_path / "engines/template/card.toml"
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(UserError) as refusal:
        cards.read_card("template", tmp_path / "engines")
    assert place in str(refusal.value) and str(path) in str(refusal.value)


def test_the_scene_of_a_config_is_that_of_the_program(program):
    found = scene.made(scene.exported(HANG, SMALL), Path("hang"))
    x, mass = np.array(found["positions_m"]), np.array(found["mass_kg"])
    assert x.shape == (25, 3) and len(found["triangles"]) == 32 and found["given"]["vertices"] == [20, 24]
    assert np.isclose(mass.sum(), 0.15 * (1 - (1 + 2) / 3 / 32))  # all of it but that of two corners, one with two triangles
    membrane = found["bodies"][0]["membrane"]
    mu, lam = membrane["lame_mu_N_per_m"], membrane["lame_lambda_N_per_m"]
    assert np.isclose(4 * mu * (lam + mu) / (lam + 2 * mu), 8e5 * 3.18e-4) and np.isclose(lam / (lam + 2 * mu), 0.243)
    assert found["gravity_m_s2"] == [0, 0, -9.81] and found["steps"] == 6
    twist = scene.made(scene.exported(ROOT / "configs/scenes/twist_cloth.json", ["/time/steps=3"]), Path("twist"))
    given = np.array(twist["given"]["positions_m"])
    assert given.shape[0] == 4 and np.abs(given[1] - given[0]).max() > 1e-3 and np.allclose(given[0], np.array(twist["positions_m"])[twist["given"]["vertices"]])


def test_what_engines_do_not_share_is_refused_by_name(program):
    with pytest.raises(UserError, match="strain_limit"):
        scene.exported(HANG, ["/strain_limit/enabled=true"])


@pytest.mark.parametrize("name, term", [("trapped", "tetrahedra"), ("domino", "tetrahedra"), ("codim", "tetrahedra")])
def test_scenes_that_peers_cannot_run_are_refused_by_name_and_the_page_says_so(program, tmp_path, name, term):
    """The table of docs/results/engines.md has the times of ours that are kept."""
    entry = read_entry(name)
    write_config(entry, tmp_path / "scene.json")
    with pytest.raises(UserError, match=f"found {term} .*engines share no other term"):
        scene.exported(tmp_path / "scene.json")
    assert_times_of_the_page(name)


def test_rods_with_friction_are_exported_and_no_adapter_takes_both(program, here, tmp_path):
    write_config(read_entry("noodle"), tmp_path / "scene.json")
    found = scene.made(scene.exported(tmp_path / "scene.json"), Path("noodle"))
    rod = found["bodies"][0]["rod"]
    assert rod["stretching_N"] == pytest.approx(1e4) and rod["bending_N_m2"] > 0 and found["friction"] == 0.05
    assert len(found["segments"]) == 9 * 60
    done = launch.run(cards.read_card("template"), found, tmp_path / "out", "plain")
    assert done["outcome"] == "refused" and "friction is not mapped" in done["detail"]
    assert_times_of_the_page("noodle")


def assert_times_of_the_page(name):
    kept = {row.place["formulation"]: row for row in rows_of(read_study("catalogue")) if row.place["scene"] == name}
    log, dynamic = kept["log"], kept["cubic_dynamic_consistent"]
    cells = f"| `{name}` | {log.seconds:g} s, {log.values['newton']} | {dynamic.seconds:g} s, {dynamic.values['newton']} |"
    assert cells in (ROOT / "docs/results/engines.md").read_text()


def test_a_scene_file_is_checked(tmp_path):
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(sheet() | {"mass_kg": [1.0]}))
    with pytest.raises(UserError, match=r"#/mass_kg: found 1; one for each of 16 vertices is needed"):
        scene.read(path)
    path.write_text(json.dumps(sheet() | {"gravity_m_s2": [0, -9.81]}))
    with pytest.raises(UserError, match="#/gravity_m_s2"):
        scene.read(path)


def test_the_template_falls_freely_and_is_judged_clean(program, here, tmp_path):
    data = sheet()
    done = launch.run(cards.read_card("template"), data, tmp_path, "plain", {"damping_per_s": 0.0})
    assert (done["outcome"], done["detail"]) == ("ok", "")
    x = np.load(tmp_path / "frames.npz")["positions"]
    assert np.allclose(x[-1, :, 2], 1 - 0.5 * 10 * 0.1**2, atol=10 * 0.1 * 2e-4)
    found = judge(tmp_path, data)
    assert found["verdict"] == "clean" and found["frames_crossing"] == 0
    assert 0 < found["energy_most_J"] < 1e-3 * 16 * 0.01 * 10 or abs(found["energy_most_J"]) < 1e-3
    assert error_of(x, x + [0, 0, 0.03], data)["error_last"] == pytest.approx(0.1)


def test_a_penalty_that_gives_way_is_seen_in_the_obstacle(program, here, tmp_path):
    ball = {"name": "ball", "kind": "sphere", "point_m": [0.15, 0.15, -0.2], "radius_m": 0.2, "inside": False}
    data = sheet(height=0.02, steps=20, obstacles=[ball])
    done = launch.run(cards.read_card("template"), data, tmp_path, "plain", {"obstacle_N_per_m": 1.0})
    assert done["outcome"] == "ok"
    found = judge(tmp_path, data)
    assert found["verdict"] == "penetrates" and found["frames_in_obstacles"] > 0 and found["depth_obstacles_m"] > 1e-3


def test_given_vertices_are_where_they_are_given(program, here, tmp_path):
    corner = [0.0, 0.0, 1.0]
    way = [[[0.0, 0.0, 1.0 + 0.01 * k]] for k in range(11)]
    data = sheet(given={"vertices": [0], "positions_m": way}, mass_kg=[0.0] + [0.01] * 15)
    launch.run(cards.read_card("template"), data, tmp_path, "plain")
    x = np.load(tmp_path / "frames.npz")["positions"]
    assert np.allclose(x[:, 0], corner + 0.01 * np.arange(11)[:, None] * [0, 0, 1]) and not np.allclose(x[-1, 15], x[0, 15])


@pytest.mark.parametrize(
    ("body", "outcome", "detail"),
    [
        ("raise SystemError('lost its bearings')", "crashed", "exit code 1: SystemError: lost its bearings"),
        ("import sys\nprint('no words for a torus', file=sys.stderr)\nsys.exit(3)", "refused", "no words for a torus"),
        ("import time\ntime.sleep(60)", "timed_out", "after 1 s"),
        ("", "no_frames", "lacks frames.npz or engine.json"),
    ],
)
def test_every_failure_has_its_name_and_its_log(here, tmp_path, body, outcome, detail):
    card = stand_in(tmp_path, body)
    done = launch.run(card, sheet(), tmp_path / "out", "plain", limit_s=1 if outcome == "timed_out" else 60)
    assert done["outcome"] == outcome and detail in done["detail"] and outcome in launch.OUTCOMES
    assert done["log"].endswith("log.txt") and (tmp_path / "out/log.txt").exists()


def test_a_state_that_is_not_finite_is_named(here, tmp_path):
    held = sheet(given={"vertices": [0], "positions_m": [[[0, 0, 1]]]}, steps=40)
    done = launch.run(cards.read_card("template"), held, tmp_path, "plain", {"dt_s": 0.01, "stretch_factor": 1e9})
    assert done["outcome"] == "not_finite" and done["detail"].startswith("frame ")


def test_an_engine_that_is_not_there_says_how_to_get_it(monkeypatch, tmp_path):
    monkeypatch.setattr(environment, "ENVIRONMENTS", tmp_path / "none")
    done = launch.run(cards.read_card("mujoco"), sheet(), tmp_path / "out", "cg")
    assert done["outcome"] == "not_installed" and "./bench engine mujoco setup" in done["detail"]
    assert "not installed" in (tmp_path / "out/log.txt").read_text()


def test_setup_tries_every_variant_and_says_what_does_not_run(monkeypatch, tmp_path, capsys):
    """Without a network: the environment is made of this Python, and nothing is installed."""
    monkeypatch.setattr(environment, "ENVIRONMENTS", tmp_path)
    monkeypatch.setattr(environment, "python", lambda card: Path(sys.executable))
    commands = []

    def said(command, log):
        commands.append(command)
        (tmp_path / "template").mkdir(exist_ok=True)

    monkeypatch.setattr(environment, "_said", said)
    assert verb.main(["template", "setup"]) == 0
    assert "template plain: ok" in capsys.readouterr().out and any("-r" in c for c in commands)
    n = len(commands)
    assert verb.main(["template", "setup"]) == 0 and len(commands) == n and "is there" in capsys.readouterr().out


def test_the_verb_runs_judges_and_says_the_promise(program, here, tmp_path, capsys):
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(sheet()))
    assert verb.main(["template", "run", str(path), "--out", str(tmp_path / "out")]) == verb.OK
    said = capsys.readouterr().out
    assert "verdict clean" in said and "promised: None" in said
    assert json.loads((tmp_path / "out/run.json").read_text())["judged"]["verdict"] == "clean"
    assert verb.main(["mujoco", "run", str(path), "--out", str(tmp_path / "other")]) == verb.NOT_RUN
    assert "log.txt" in capsys.readouterr().out
    assert verb.main(["template", "run", str(path), "--out", str(tmp_path / "o"), "--engine-set", "dt=1"]) == 2
    assert "allowed: dt_s" in capsys.readouterr().err
    assert verb.main(["template", "fly"]) == 2
    assert verb.main(["list"]) == 0 and "template" in capsys.readouterr().out


def test_the_fit_finds_the_stiffness_that_ours_has(program, here, tmp_path):
    """Springs cannot be a sheet: the mean of three tensile tests is met, their differences are left and reported."""
    tests = matching.Tests(matching.Material(254.4, 0.243, 0.15, 0.0), tmp_path)
    assert set(tests.scenes) == set(matching.TENSILE)
    card = cards.read_card("template")

    def simulate(scenes, factors):
        return launch.run_all(card, scenes, tmp_path / "engine", "plain", {"dt_s": 5e-5, **factors})

    strain = matching.measured("warp", tests.ours["warp"]) / (0.2 - 0.0125)
    assert 0.012 < strain < 0.025  # 2 % without clamped ends and with a mesh of eight cells
    fit = tests.fit(simulate, card.data["fit"])
    left = [np.log1p(fit["left"][name]) for name in matching.TENSILE]
    assert 0.5 < fit["factors"]["stretch_factor"] < 2 and abs(np.mean(left)) < 0.1
    assert np.ptp(left) > 1e-3


def test_levels_are_read_between_and_never_beyond():
    line = [{"seconds": s, "error_mean": 0.1 / s, "outcome": "ok"} for s in (1.0, 10.0)]
    assert level.at(line, "seconds", 10**0.5, "error_mean") == pytest.approx(0.1 / 10**0.5)
    assert level.at(line, "seconds", 11.0, "error_mean") is None
    assert level.at(line, "error_mean", 0.05, "seconds") == pytest.approx(2.0)
    bent = [*line, {"seconds": 20.0, "error_mean": 0.05, "outcome": "ok"}]
    assert level.at(bent, "error_mean", 0.05, "seconds") is None


def test_energy_is_that_of_the_middle_of_a_frame():
    dt, g, m = 0.01, 10.0, 2.0
    z = [-0.5 * g * (k * dt) ** 2 for k in range(5)]
    rows = [{"gravity_J": m * g * z[0]}]
    rows += [{"gravity_J": m * g * z[k], "kinetic_J": 0.5 * m * ((z[k] - z[k - 1]) / dt) ** 2} for k in range(1, 5)]
    found = energy_of(rows)
    assert abs(found["energy_last_J"]) < m * (g * dt) ** 2 and abs(found["energy_most_J"]) < m * (g * dt) ** 2


def test_a_comparison_goes_on_where_an_engine_is_missing(program, here, tmp_path):
    spec = {
        "schema": "barrierbench.engines/1",
        "scenes": [{"name": "hang", "base": str(HANG), "set": {"/scene/n": 4, "/strain_limit/enabled": False, "/matching/rule": "as_given", "/time/steps": 4}}],
        "material": {"youngs_N_per_m": 254.4, "poisson": 0.243, "density_kg_per_m2": 0.15, "hinge_J": 0.0},
        "ours": {"parts": [1]}, "reference": {"parts": 2, "integrator": "bdf2"},
        "engines": [{"engine": "mujoco", "variant": "cg", "levels": [{}]}, {"engine": "template", "variant": "plain", "levels": [{"dt_s": 0.001}]}],
        "limit_s": 60,
    }  # fmt: skip
    path = tmp_path / "spec.json"
    path.write_text(json.dumps(spec))
    said = []
    study = compare.read_study(path, tmp_path / "runs", [], said.append)
    record = compare.compared(study)
    ours, missing, template = record["scenes"][0]["rows"]
    assert ours["outcome"] == "ok" and ours["error_mean"] > 0 and ours["verdict"] == "clean"
    assert missing["outcome"] == "not_installed" and "setup" in missing["detail"]
    assert template["outcome"] == "ok" and template["error_mean"] > 0
    n = len(said)
    assert n > 3 and compare.compared(study) == record and said[n:] == ["hang: mujoco cg, level 0"]  # what was run is not run again
    page = text_of(record)
    assert "mujoco cg: not_installed" in page and "template plain: stretch_factor" in page
    assert ours["notes"]["contacts_most"] == 0 and "Nothing touches in our runs" in page
    ours["notes"]["contacts_most"] = 7
    assert "Contacts at a step end in our runs: up to 7." in text_of(record)
    figure.paint(record, tmp_path / "engines.png")
    assert (tmp_path / "engines.png").stat().st_size > 5000


@pytest.mark.parametrize(("name", "variant"), [("mujoco", "cg"), ("mujoco", "newton"), ("newton", "vbd"), ("newton", "xpbd")])
def test_an_engine_of_others_falls_and_holds_what_is_given(program, tmp_path, name, variant):
    card = cards.read_card(name)
    if why := environment.why_not(card):
        pytest.skip(f"{name} is {why}")
    done = launch.run(card, sheet(steps=5), tmp_path / "fall", variant)
    assert done["outcome"] == "ok", done
    x = np.load(tmp_path / "fall/frames.npz")["positions"]
    assert x[-1, :, 2].mean() == pytest.approx(1 - 10 * 0.01**2 * 15, abs=2e-4)  # implicit Euler: h^2 g k (k + 1)/2
    held = sheet(steps=5, given={"vertices": [0, 3], "positions_m": [[[0, 0, 1], [0, 0.3, 1]]]}, mass_kg=[0.0, 0.01, 0.01, 0.0] + [0.01] * 12)
    launch.run(card, held, tmp_path / "held", variant)
    x = np.load(tmp_path / "held/frames.npz")["positions"]
    assert np.abs(x[:, [0, 3]] - x[0, [0, 3]]).max() < 1e-6 and x[-1, 15, 2] < 0.999
    assert judge(tmp_path / "held", held)["verdict"] == "clean"


def test_an_energy_that_overflowed_is_none():
    frames = [{"gravity_J": 1.0}, {"gravity_J": 0.5, "kinetic_J": 0.25}]
    assert energy_of(frames)["energy_last_J"] == 0.0
    assert energy_of([frames[0], {"gravity_J": 0.5, "kinetic_J": None}]) == {}
    assert energy_of([{"gravity_J": None}, frames[1]]) == {}
