"""Session folders of the ppf contact solver: arrays, parameters, pins, walls, and what is refused."""

import numpy as np
import pytest
from tests.import_scenes import sources
from tests.import_scenes.conftest import entry_of

from barrierbench_analysis.program.mesh_arrays import read_body_file

POINTS, FACES = sources.sheet()


@pytest.fixture
def session(tmp_path):
    """A session with changes."""
    return lambda **more: sources.ppf(tmp_path / "session", **more)


def test_the_whole_session(imported, session):
    made = imported(session())
    assert made.scene["gravity_m_per_s2"] == [0, -9.8, 0]
    assert made.config["time"] == {"dt_s": 0.01, "steps": 20}  # 12 frames of 1/60 s
    assert made.config["formulation"] == {"name": "cubic_dynamic_lagged", "d_hat_m": pytest.approx(2e-3)}
    assert made.config["friction"] == {"mu": 0.0, "combine": "max"}
    assert made.scene["obstacles"] == [{"name": "wall_0", "kind": "plane", "point_m": [0, 0, 0], "axis": [0, 1, 0], "friction": 0.1}]
    body = made.scene["bodies"][0]
    assert np.allclose(read_body_file(made.path.parent / body["mesh"]["file"]).points, POINTS + [0, 0.02, 0])
    assert body["friction"] == pytest.approx(0.4) and body["d_hat_m"] == pytest.approx(2e-3)
    assert body["limited"] is False and "strain_limit" not in made.config


def test_stiffnesses_are_times_the_density(imported, session):
    material = imported(session()).scene["bodies"][0]["material"]
    mu, lam = 500 / 2.6, 500 * 0.3 / (1.3 * 0.4)
    young, nu = material["youngs_N_per_m"], material["poisson"]
    assert material["model"] == "baraff_witkin" and material["density_kg_per_m2"] == pytest.approx(0.5)
    assert young / (2 * (1 + nu)) == pytest.approx(mu, rel=1e-6) and young * nu / (1 - nu**2) == pytest.approx(lam, rel=1e-6)
    area = 1 / 32  # of each triangle; 40 inner edges, of which 16 are diagonals
    ratio = (24 * 0.25**2 + 16 * 2 * 0.25**2) / 40 / (2 * area)
    assert material["bending_J"] == pytest.approx(1.28e-5 * 1.0 * 0.5 * ratio, rel=1e-6)


@pytest.mark.parametrize("number, model", enumerate(["corotational", "stvk", "baraff_witkin", "stable_neo_hookean"]))
def test_models(imported, session, number, model):
    assert imported(session(model=number)).scene["bodies"][0]["material"]["model"] == model


def test_strain_limit_offset_and_shrinking(imported, session):
    made = imported(session(strain_limit=0.05, contact_offset=1e-3, shrink_x=0.9))
    body = made.scene["bodies"][0]
    assert made.config["strain_limit"] == {"limit": pytest.approx(0.05)} and "limited" not in body
    assert body["offset_m"] == pytest.approx(1e-3) and body["material"]["shrink_warp"] == pytest.approx(0.9)


def test_a_body_has_one_value_of_each_parameter(imported, session):
    made = imported(session(friction=np.linspace(0, 1, len(FACES))))
    assert made.scene["bodies"][0]["friction"] == pytest.approx(0.5)
    assert entry_of(made.card, "bin/param/tri-friction.bin")[0] == "changed"


def test_solids_take_contact_from_their_sides(imported, session):
    folder = session(wall=False)
    points, cells = sources.CUBE, sources.TETRAHEDRA[:, [1, 0, 2, 3]]  # of the other orientation, which is mended
    count = (folder / "info.toml").read_text().replace("tet = 0", "tet = 6").replace("tri = 32", "tri = 2").replace("vert = 25\n", "vert = 8\n").replace("shell_count = 32", "shell_count = 0")
    (folder / "info.toml").write_text(count.replace("static_vert = 8", "static_vert = 0"))
    for name, rows, kind in (("vert", points, "<f8"), ("vel", 0 * points, "<f4"), ("vert_dmap", [0] * 8, "<u4"), ("tet", cells, "<u8"), ("tri", [[0, 1, 3], [0, 3, 2]], "<u8")):
        np.asarray(rows, kind).tofile(folder / "bin" / f"{name}.bin")
    for path in (folder / "bin/param").iterdir():
        path.write_bytes(path.read_bytes()[: 2 if "model" in path.name else 8])
    np.full(6, 3, "u1").tofile(folder / "bin/param/tet-model.bin")
    np.full(6, 100.0, "<f4").tofile(folder / "bin/param/tet-density.bin")
    body = imported(folder).scene["bodies"][0]
    assert body["material"] == {
        "solid_model": "stable_neo_hookean",
        "solid_youngs_Pa": pytest.approx(5e4),
        "solid_poisson": pytest.approx(0.35),
        "solid_density_kg_per_m3": pytest.approx(100),
    }
    assert body["friction"] == pytest.approx(0.4) and body["d_hat_m"] == pytest.approx(2e-3)


def pinned(imported, session, text, rows, **more):
    return imported(session(pins=[([0, 5, 7], text, rows)], **more)).scene["bodies"][0]["pins"][0]


def test_a_pin_holds(imported, session):
    assert pinned(imported, session, "unpin_time = 0.5\n", []) == {"indices": [0, 5, 7], "release_s": 0.5}


def test_a_pin_moves(imported, session):
    text = '[pin-0-op-0]\ntype = "move_by"\nt_start = 0.0\nt_end = 1.0\ntransition = "linear"\n'
    motion = pinned(imported, session, text, [[[0.5, 0, 0]] * 3])["motion"]
    assert motion["velocity_m_per_s"] == pytest.approx([0.5, 0, 0])


def test_a_pin_turns(imported, session):
    text = '[pin-0-op-0]\ntype = "spin"\ncenter_x = 0.0\ncenter_y = 0.02\ncenter_z = 0.0\naxis_x = 0.0\naxis_y = 2.0\naxis_z = 0.0\nangular_velocity = 90.0\nt_start = 0.0\nt_end = 9.0\n'
    motion = pinned(imported, session, text, [None])["motion"]
    assert np.array(motion["axis"]) * motion["angular_velocity_rad_per_s"] == pytest.approx([0, np.pi / 2, 0], abs=1e-6)


def test_operations_one_after_the_other_are_a_film(imported, session, tmp_path):
    text = '[pin-0-op-0]\ntype = "scale"\ncenter_x = 0.0\ncenter_y = 0.0\ncenter_z = 0.0\nfactor = 0.5\nt_start = 0.0\nt_end = 0.1\ntransition = "smooth"\n'
    text += '[pin-0-op-1]\ntype = "move_to"\nt_start = 0.1\nt_end = 0.2\ntransition = "linear"\n'
    film = pinned(imported, session, text, [None, POINTS[[0, 5, 7]] + [0, 1, 0]])["motion"]["film"]
    frames = [read_body_file(tmp_path / "made" / film["file"].replace("000000", f"{k:06d}")).points for k in (5, 15)]
    part = 1 - 0.5 * (3 * 0.25 - 2 * 0.125)
    assert np.allclose(frames[0][[0, 5, 7]], part * POINTS[[0, 5, 7]] + [0, 0.02, 0], atol=1e-12)
    assert np.allclose(frames[1][[0, 5, 7]], 0.75 * POINTS[[0, 5, 7]] + [0, 0.52, 0], atol=1e-12)


def test_an_operation_that_is_not_read_is_listed(imported, session):
    text = '[pin-0-op-0]\ntype = "torque"\naxis_component = 0\nmagnitude = 1.0\nhint_vertex = 0\nt_start = 0.0\nt_end = 1.0\n'
    made = imported(session(pins=[([0], text, [None])]))
    assert entry_of(made.card, "info.toml#/pin-0-op-0/magnitude")[0] == "not_mapped"
    assert "pins" not in made.scene["bodies"][0]  # the source leaves such vertices free


MOVE = 'type = "move_by"\nt_start = 0.0\nt_end = 1.0\ntransition = "linear"\n'
SPIN = 'type = "spin"\ncenter_x = 0.0\ncenter_y = 0.0\ncenter_z = 0.0\naxis_x = 0.0\naxis_y = 2.0\naxis_z = 0.0\nangular_velocity = 90.0\nt_start = 0.0\nt_end = 9.0\n'
SCALE = 'type = "scale"\ncenter_x = 0.0\ncenter_y = 0.0\ncenter_z = 0.0\nfactor = 0.5\nt_start = 0.0\nt_end = 0.1\n'


def test_operations_beside_one_that_is_not_read_are_listed(imported, session):
    text = f'[pin-0-op-0]\n{MOVE}[pin-0-op-1]\ntype = "torque"\nmagnitude = 1.0\n'
    made = imported(session(pins=[([0], text, [[[0.5, 0, 0]], None])]))
    kind, entry = entry_of(made.card, "info.toml#/pin-0-op-0/t_start")
    assert kind == "not_mapped" and "another one" in entry["consequence"]
    assert made.scene["bodies"][0]["pins"] == [{"indices": [0]}]


def test_a_spin_backwards_does_nothing(imported, session):
    text = "[pin-0-op-0]\n" + SPIN.replace("= 90.0", "= -90.0")
    assert pinned(imported, session, text, [None]) == {"indices": [0, 5, 7]}


def test_the_stiffness_of_a_rod_is_times_the_length_of_its_edges(imported, session):
    folder = session(wall=False)
    points = np.array([[0, 0, 0], [0.1, 0, 0], [0.3, 0, 0], [0.4, 0, 0]])
    text = (folder / "info.toml").read_text().replace("vert = 25\n", "vert = 4\n", 1).replace("\ntri = 32", "\ntri = 0").replace("rod = 0", "rod = 3").replace("shell_count = 32", "shell_count = 0")
    (folder / "info.toml").write_text(text)
    for path in (folder / "bin/param").iterdir():
        path.unlink()
    (folder / "bin/tri.bin").unlink()
    for name, rows, kind in (("vert", points, "<f8"), ("vel", 0 * points, "<f4"), ("vert_dmap", [0] * 4, "<u4"), ("rod", [[0, 1], [1, 2], [2, 3]], "<u8"), ("param/rod-young-mod", [1e4] * 3, "<f4"), ("param/rod-density", [0.02] * 3, "<f4")):
        np.asarray(rows, kind).tofile(folder / "bin" / f"{name}.bin")
    made = imported(folder)
    material = made.scene["bodies"][0]["material"]
    assert material["rod_stretching_N"] == pytest.approx(1e4 * 0.02 * 0.4 / 3, rel=1e-6)
    assert material["line_density_kg_per_m"] == pytest.approx(0.02)
    assert entry_of(made.card, "bin/param/rod-young-mod.bin")[0] == "changed"


def test_gravity_over_time_and_scaling(imported, session):
    folder = session(more_param="")
    (folder / "param.toml").write_text((folder / "param.toml").read_text().replace("world_scaling = 1.0", "world_scaling = 0.5"))
    (folder / "dyn_param.txt").write_text("[gravity]\n0.0 0.0 -9.8 0.0\n1.0 0.0 9.8 0.0\n[playback]\n0.0 1.0\n")
    made = imported(folder)
    assert made.scene["gravity_schedule"] == [{"time_s": 0.0, "gravity_m_per_s2": [0, -9.8, 0]}, {"time_s": 1.0, "gravity_m_per_s2": [0, 9.8, 0]}]
    assert "gravity_m_per_s2" not in made.scene
    assert entry_of(made.card, "dyn_param.txt#/playback")[0] == "not_mapped"
    assert np.allclose(read_body_file(made.path.parent / made.scene["bodies"][0]["mesh"]["file"]).points, 0.5 * (POINTS + [0, 0.02, 0]))


def test_unknown_keys_and_files_are_listed(imported, session):
    folder = session(more_param="magnet = 2.0\n", more_info="[portal]\nwidth = 1.0\n", pins=[([0], "colour = 3\n", [])])
    np.zeros(3, "<f4").tofile(folder / "bin/param/tri-charge.bin")
    assert sorted(imported(folder).unknown) == ["bin/param/tri-charge.bin", "info.toml#/pin-0/colour", "info.toml#/portal/width", "param.toml#/param/magnet"]


@pytest.mark.parametrize(
    "change, message",
    [
        (("info.toml", "vert = 25", "vert = 24"), "bin/vert.bin: found 25; allowed: 24 rows, which info.toml has"),
        (("info.toml", "tri = 32", "tri = -1"), "info.toml#/count/tri: found -1; allowed: a whole number from 0"),
        (("info.toml", "[count]", "[count"), "info.toml: found no TOML"),
        (("param.toml", '"cubic"', '"quartic"'), "param.toml#/param/barrier: found 'quartic'; allowed: cubic, quad, log"),
        (("param.toml", "dt = 0.01", "dt = 0.0"), "param.toml#/param/dt: found 0.0; allowed: a number above 0"),
        (("param.toml", "[0.0, -9.8, 0.0]", '"down"'), "param.toml#/param/gravity: found 'down'; allowed: three numbers"),
        (("param.toml", "fps = 60.0", 'fps = "60"'), "param.toml#/param/fps: found '60'; allowed: a number above 0"),
        (("param.toml", '"max"', '"sum"'), "param.toml#/param/friction_mode: found 'sum'; allowed: min, max, mean"),
    ],
)
def test_bad_input(refused, session, change, message):
    folder, (name, old, new) = session(), change
    text = (folder / name).read_text()
    assert old in text
    (folder / name).write_text(text.replace(old, new, 1))
    assert message in refused(folder)


@pytest.mark.parametrize(
    "text, rows, change, message",
    [
        (MOVE, [[0.5, 0, 0]], None, "bin/pin-0-op-0.bin: found 1; allowed: 3 rows"),
        (SPIN, None, ("t_end = 9.0\n", ""), "info.toml#/pin-0-op-0/t_end: found None; allowed: a number"),
        (SCALE, None, ("t_end = 0.1\n", ""), "info.toml#/pin-0-op-0/t_end: found None; allowed: a number"),
        (SPIN, None, ("axis_y = 2.0", "axis_y = 0.0"), "info.toml#/pin-0-op-0/axis_x: found 0.0; allowed: an axis"),
        (SCALE, None, ("factor = 0.5", 'factor = "half"'), "info.toml#/pin-0-op-0/factor: found 'half'; allowed: a number"),
        (SPIN, None, ("center_x = 0.0", "center_x = [1]"), "info.toml#/pin-0-op-0/center_x: found [1]; allowed: a number"),
        (MOVE, [[0.5, 0, 0]] * 3, ("nx = 0.0\n", ""), "info.toml#/wall-0/nx: found None; allowed: a number"),
        (MOVE, [[0.5, 0, 0]] * 3, ("friction = 0.1", 'friction = "much"'), "info.toml#/wall-0/friction: found 'much'"),
        (MOVE, [[0.5, 0, 0]] * 3, ("pull = 0.0", "pull = []"), "info.toml#/pin-0/pull: found []; allowed: a number"),
        (MOVE, [[0.5, 0, 0]] * 3, ("operation_count = 1", "operation_count = 1.5"), "operation_count: found 1.5; allowed: a whole"),
        (MOVE, [[0.5, 0, 0]] * 3, ("shell_count = 32", 'shell_count = "all"'), "info.toml#/count/shell_count: found 'all'"),
    ],
)
def test_damaged_tables(refused, session, text, rows, change, message):
    folder = session(pins=[([0, 5, 7], "[pin-0-op-0]\n" + text, [rows])])
    if change:
        whole = (folder / "info.toml").read_text()
        assert change[0] in whole
        (folder / "info.toml").write_text(whole.replace(*change, 1))
    assert message in refused(folder)


def test_vertices_that_no_array_has(refused, session):
    folder = session(pins=[([99], "", [])])
    np.asarray([3] * 25, "<u4").tofile(folder / "bin/vert_dmap.bin")
    assert "info.toml: found tables and arrays that do not fit together" in refused(folder)


def test_an_array_that_is_cut_off(refused, session):
    folder = session()
    path = folder / "bin/vert.bin"
    path.write_bytes(path.read_bytes()[:-1])
    assert "bin/vert.bin: found 599; allowed: a multiple of 24 bytes" in refused(folder)
    path = folder / "bin/param/tri-bend.bin"
    path.write_bytes(path.read_bytes()[:-4])
    assert "bin/vert.bin" in refused(folder)


def test_it_falls_and_rests(imported, ran, session):
    run = ran(imported(session(), "--steps", "20").path)
    audit = run.record["audit"]
    assert run.record["status"]["outcome"] == "ok" and run.record["summary"]["contacts"]["max"] > 0
    assert audit["judged"] > 0 and audit["crossings"] == audit["unproven"] == audit["violations"] == audit["obstacle_violations"] == 0
    heights = [points[:, 1].mean() for points in run.points]
    assert heights[0] == pytest.approx(0.02 - 9.8e-4, rel=1e-9)
    assert 0 < heights[-1] < 2.5e-3
