"""Scenes of PolyFEM: what each key becomes, and what is refused."""

import json

import numpy as np
import pytest
from tests.import_scenes import sources
from tests.import_scenes.conftest import entry_of

from barrierbench_analysis.program.imports.expressions import NoExpression, compiled
from barrierbench_analysis.program.mesh_arrays import read_body_file


def with_(**changes):
    """The scene with changes at places, as geometry__0__n_refs."""
    data = sources.polyfem_data()
    for place, value in changes.items():
        *way, last = place.split("__")
        here = data
        for part in way:
            here = here[int(part)] if part.isdigit() else here.setdefault(part, {})
        here[int(last) if last.isdigit() else last] = value
    return data


def mesh(made, number):
    return read_body_file(made.path.parent / made.scene["bodies"][number]["mesh"]["file"])


def test_the_whole_scene(imported, tmp_path):
    made = imported(sources.polyfem(tmp_path))
    assert made.scene["gravity_m_per_s2"] == [0, -9.81, 0]
    assert made.config["time"] == {"dt_s": 0.01, "steps": 20}
    assert made.config["integrator"] == {"name": "implicit_euler"}
    assert made.config["formulation"] == {"name": "ipc2020", "d_hat_m": 1e-3}
    assert made.config["friction"] == {"mu": 0.3, "eps_v_m_per_s": 2e-3}
    cube, floor = made.scene["bodies"]
    assert (cube["name"], floor["name"], floor["kind"]) == ("cube", "floor", "rigid")
    assert np.allclose(mesh(made, 0).points, 0.2 * sources.CUBE + [0, 0.105, 0], atol=1e-16)
    assert np.allclose(np.ptp(mesh(made, 1).points, axis=0), [2, 0, 2])


def test_neo_hookean_keeps_its_moduli_at_rest(imported, tmp_path):
    material = imported(sources.polyfem(tmp_path)).scene["bodies"][0]["material"]
    young, nu = material["solid_youngs_Pa"], material["solid_poisson"]
    mu, lam = young / (2 * (1 + nu)), young * nu / ((1 + nu) * (1 - 2 * nu))
    assert material["solid_model"] == "stable_neo_hookean" and material["solid_density_kg_per_m3"] == 1000
    assert mu == pytest.approx(1e6 / 2.8) and lam - mu == pytest.approx(1e6 * 0.4 / (1.4 * 0.2))


@pytest.mark.parametrize(
    "kind, model, listed",
    [("SaintVenant", "stvk", "mapped"), ("LinearElasticity", "corotational", "changed"), ("FixedCorotational", "corotational", "changed")],
)
def test_other_materials(imported, tmp_path, kind, model, listed):
    made = imported(sources.polyfem(tmp_path, with_(materials__0__type=kind)))
    assert made.scene["bodies"][0]["material"] == pytest.approx(
        {"solid_model": model, "solid_youngs_Pa": 1e6, "solid_poisson": 0.4, "solid_density_kg_per_m3": 1000}
    )
    assert entry_of(made.card, "/materials/0/type")[0] == listed


def test_lame_parameters_and_units(imported, tmp_path):
    """Lengths in mm, masses in g: E in g/(mm s^2) = Pa, rho in g/mm^3."""
    data = with_(units={"length": "mm", "mass": "g"}, contact__dhat=1.0, contact__epsv=2.0)
    data["geometry"][0]["transformation"] = {"translation": [0, 105, 0], "scale": 200}
    data["materials"] = [{"type": "SaintVenant", "lambda": 3e5, "mu": 2e5, "rho": 1e-3}]
    data["boundary_conditions"]["rhs"] = [0, 9810, 0]
    made = imported(sources.polyfem(tmp_path, data))
    material = made.scene["bodies"][0]["material"]
    assert material["solid_density_kg_per_m3"] == pytest.approx(1000)
    assert material["solid_youngs_Pa"] == pytest.approx(2e5 * (3 * 3e5 + 2 * 2e5) / 5e5)
    assert made.scene["gravity_m_per_s2"] == pytest.approx([0, -9.81, 0])
    assert made.config["formulation"]["d_hat_m"] == pytest.approx(1e-3)
    assert made.config["friction"]["eps_v_m_per_s"] == pytest.approx(2e-3)
    assert np.allclose(mesh(made, 0).points, 0.2 * sources.CUBE + [0, 0.105, 0], atol=1e-15)


@pytest.mark.parametrize(
    "how, matrix",
    [
        ({"rotation": [90, 0, 90]}, [[0, 0, 1], [1, 0, 0], [0, 1, 0]]),  # about x, then about z
        ({"rotation": [90, 0, 90], "rotation_mode": "zyx"}, [[0, -1, 0], [0, 0, -1], [1, 0, 0]]),
        ({"rotation": [90, 0, 0, 2], "rotation_mode": "axis_angle"}, [[0, -1, 0], [1, 0, 0], [0, 0, 1]]),
        ({"rotation": [0, 0, 90], "rotation_mode": "rotation_vector"}, [[0, -1, 0], [1, 0, 0], [0, 0, 1]]),
        ({"scale": [1, 2, 3], "rotation": 90, "rotation_mode": "z"}, [[0, -2, 0], [1, 0, 0], [0, 0, 3]]),
    ],
)
def test_rotations(imported, tmp_path, how, matrix):
    made = imported(sources.polyfem(tmp_path, with_(geometry__0__transformation={**how, "translation": [0, 5, 0]})))
    assert np.allclose(mesh(made, 0).points, sources.CUBE @ np.array(matrix, float).T + [0, 5, 0], atol=1e-15)


TOP = [2, 3, 6, 7]  # vertices of CUBE with y = 0.5


@pytest.mark.parametrize(
    "selection",
    [
        {"id": 4, "axis": "y", "position": 0.99, "relative": True},
        [{"id": 4, "axis": 2, "position": 0.2}],
        [{"id": 4, "box": [[-1, 0.2049, -1], [1, 1, 1]]}],
        [{"id": 4, "normal": [0, 1, 0], "point": [0, 0.2049, 0]}],
        [{"id": 4, "p1": [0, 0.2049, 0], "p2": [0, 1, 0], "radius": 0.5}],
        [{"id": 4, "center": [0, 0.205, 0], "radius": 0.05}],
        {"threshold": 1e-3},
    ],
)
def test_selected_sides_are_held(imported, tmp_path, selection):
    data = with_(geometry__0__surface_selection=selection)
    data["boundary_conditions"]["dirichlet_boundary"] = [{"id": 4, "value": [0, 0, 0]}]
    made = imported(sources.polyfem(tmp_path, data))
    assert made.scene["bodies"][0]["pins"] == [{"indices": TOP}]
    assert entry_of(made.card, "/boundary_conditions/dirichlet_boundary/0/value")[0] == "mapped"


def pinned(imported, tmp_path, value, **more):
    data = with_(geometry__0__surface_selection={"id": 4, "axis": "y", "position": 0.2})
    data["boundary_conditions"]["dirichlet_boundary"] = {"id": 4, "value": value, **more}
    return imported(sources.polyfem(tmp_path, data))


def test_a_value_that_grows_with_the_time_is_a_velocity(imported, tmp_path):
    motion = pinned(imported, tmp_path, [0, "-t/4", 0.0]).scene["bodies"][0]["pins"][0]["motion"]
    assert motion["velocity_m_per_s"] == pytest.approx([0, -0.25, 0])


def test_a_value_that_bends_is_keyframes(imported, tmp_path):
    motion = pinned(imported, tmp_path, [0, "min(t, 0.1)", 0]).scene["bodies"][0]["pins"][0]["motion"]
    assert [key["time_s"] for key in motion["keyframes"]] == pytest.approx([0, 0.1, 0.2])
    assert motion["keyframes"][1]["translate_m"] == pytest.approx([0, 0.1, 0])


def test_a_turn_is_a_rotation(imported, tmp_path):
    value = ["rotate_2D_x(x - 1, z, t * pi) - (x - 1)", 0, "rotate_2D_y(x - 1, z, t * pi) - z"]
    motion = pinned(imported, tmp_path, value).scene["bodies"][0]["pins"][0]["motion"]
    turn = np.array(motion["axis"]) * motion["angular_velocity_rad_per_s"]
    assert turn == pytest.approx([0, -np.pi, 0])
    assert motion["center_m"][0] == pytest.approx(1) and motion["center_m"][2] == pytest.approx(0, abs=1e-9)


def test_another_motion_is_a_film(imported, tmp_path):
    made = pinned(imported, tmp_path, ["x*t", 0, 0])
    film = made.scene["bodies"][0]["pins"][0]["motion"]["film"]
    assert film["frame_s"] == 0.01
    last = made.path.parent / film["file"].replace("000000", "000020")
    start = mesh(made, 0).points
    assert np.allclose(read_body_file(last).points[TOP] - start[TOP], start[TOP] * [0.2, 0, 0], atol=1e-15)


def test_interpolation_of_a_value(imported, tmp_path):
    made = pinned(imported, tmp_path, [0, 0.5, 0], interpolation={"type": "linear"})
    assert made.scene["bodies"][0]["pins"][0]["motion"]["velocity_m_per_s"] == pytest.approx([0, 0.5, 0])


@pytest.mark.parametrize(
    "value, more",
    [([0, 0.1, 0], {}), ([0, 0, 0], {"dimension": [True, False, True]}), ([0, "t", 0], {"interpolation": {"type": "piecewise_cubic", "points": [0], "values": [1]}})],
)
def test_what_no_pin_can_be_is_listed(imported, tmp_path, value, more):
    made = pinned(imported, tmp_path, value, **more)
    assert "pins" not in made.scene["bodies"][0]
    assert entry_of(made.card, "/boundary_conditions/dirichlet_boundary/value")[0] == "not_mapped"


def test_obstacles_that_move_and_planes(imported, tmp_path):
    data = with_(boundary_conditions__obstacle_displacements=[{"id": 9, "value": [0, "t", 0]}])
    data["geometry"] += [{"type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "is_obstacle": True}]
    data["geometry"] += [{"type": "ground", "height": -2, "is_obstacle": True}, {"mesh": "cube.msh", "enabled": False}]
    made = imported(sources.polyfem(tmp_path, data))
    assert made.scene["bodies"][1]["motion"] == {"velocity_m_per_s": pytest.approx([0, 1, 0])}
    assert [(o["point_m"], o["axis"]) for o in made.scene["obstacles"]] == [([0, -1, 0], [0, 1, 0]), ([0, -2, 0], [0, 1, 0])]
    assert len(made.scene["bodies"]) == 2


def test_start_velocity_integrator_and_lagging(imported, tmp_path):
    data = with_(
        initial_conditions__velocity=[{"id": 1, "value": [1, 2, 3]}],
        time__integrator={"type": "BDF", "steps": 2},
        solver__contact={"friction_iterations": 3},
    )
    made = imported(sources.polyfem(tmp_path, data))
    assert made.scene["bodies"][0]["velocity_m_per_s"] == [1, 2, 3]
    assert made.config["integrator"]["name"] == "bdf2"
    assert made.config["friction"]["lag_iterations"] == 3
    data["solver"]["contact"]["friction_iterations"] = -1
    data["time"] |= {"integrator": "BDF4"}
    made = imported(sources.polyfem(tmp_path, data))
    assert made.config["friction"]["lag_iterations"] == 20
    assert entry_of(made.card, "/solver/contact/friction_iterations")[0] == "changed"
    assert entry_of(made.card, "/time/integrator")[1]["became"] == "bdf2"


def test_contact_that_is_off(imported, tmp_path):
    pairs = imported(sources.polyfem(tmp_path, with_(contact__enabled=False))).scene["collisions"]
    assert [(p["a"], p["b"], p["kind"]) for p in pairs] == [("cube", "cube", "off"), ("cube", "floor", "off")]


def test_a_common_file_lies_underneath(imported, tmp_path):
    data = sources.polyfem_data()
    (tmp_path / "common.json").write_text(json.dumps({"contact": data.pop("contact") | {"dhat": 7e-3}, "output": {"json": "a"}}))
    made = imported(sources.polyfem(tmp_path, data | {"common": "common.json", "contact": {"dhat": 2e-3}}))
    assert made.config["formulation"]["d_hat_m"] == 2e-3 and made.config["friction"]["mu"] == 0.3
    assert entry_of(made.card, "/output/json")[0] == "not_mapped"


@pytest.mark.parametrize("place", ["dhatt", "contact__dhatt", "solver__speed", "output__colour", "geometry__0__transformation__shear", "geometry__0__mesh_scale", "materials__0__yield", "time__speed", "units__charge"])
def test_unknown_keys_are_listed(imported, tmp_path, place):
    made = imported(sources.polyfem(tmp_path, with_(**{place: 1})))
    assert made.unknown == ["/" + place.replace("__", "/")]


def test_unknown_keys_of_conditions_and_selections_are_listed(imported, tmp_path):
    data = with_(geometry__0__surface_selection=[{"id": 4, "axis": 2, "position": 0.2, "side": 1}])
    data["boundary_conditions"]["dirichlet_boundary"] = [{"id": 4, "value": [0, 0, 0], "friction": 1}, {"id": 7, "value": [0, 0, 0], "mass": 1}]
    data["initial_conditions"] = {"velocity": [{"id": 1, "value": [0, 0, 1], "spin": 1}]}
    unknown = imported(sources.polyfem(tmp_path, data)).unknown
    assert sorted(key.rpartition("/")[2] for key in unknown) == ["friction", "mass", "side", "spin"]


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"materials__0__type": "Stokes"}, "#/materials/0/type: found 'Stokes'; allowed: NeoHookean, SaintVenant"),
        ({"materials__0__nu": 0.5}, "#/materials/0/nu: found 0.5; allowed: a number > -1 and < 0.5"),
        ({"geometry__0__mesh": "floor.obj"}, "#/geometry/0/mesh: found 'floor.obj'; allowed: a mesh of tetrahedra (no 2D"),
        ({"geometry__0__mesh": "none.msh"}, "#/geometry/0/mesh: "),
        ({"geometry__0__type": "mesh_sequence"}, "#/geometry/0/type: found 'mesh_sequence'; allowed: mesh, plane, ground"),
        ({"boundary_conditions__rhs": [0, 9.81]}, "#/boundary_conditions/rhs: found [0, 9.81]; allowed: three numbers"),
        ({"time": {"dt": 0.1}}, "#/time: found ['dt']; allowed: two of dt, tend and time_steps"),
        ({"time__integrator": "Leapfrog"}, "#/time/integrator: found 'Leapfrog'; allowed: ImplicitEuler"),
        ({"units": {"length": "ell"}}, "#/units/length: found 'ell'; allowed: m, dm"),
        ({"contact__dhat": 0}, "#/contact/dhat: found 0; allowed: a length above 0"),
        ({"common": "scene.json"}, "#/common: found a file that names itself; allowed: another file"),
        ({"geometry__0__transformation": {"rotation": [1, 2, 3], "rotation_mode": "abc"}}, "/rotation_mode: found 'abc'; allowed: letters"),
    ],
)
def test_bad_input(refused, tmp_path, changes, message):
    assert message in refused(sources.polyfem(tmp_path, with_(**changes)))


def test_a_text_that_is_no_expression(refused, tmp_path):
    data = with_(geometry__0__surface_selection=4)
    data["boundary_conditions"]["dirichlet_boundary"] = [{"id": 4, "value": [0, "t*(x", 0]}]
    assert "#/boundary_conditions/dirichlet_boundary/0/value: found 'its end' in 't*(x'" in refused(sources.polyfem(tmp_path, data))


@pytest.mark.parametrize(
    "text, value",
    [("1 - 2 - 3", -4), ("2^3^2", 64), ("-2^2", 4), ("7 % 4", 3), ("log(100) + ln(e)", 3), ("if(x - 3, 1, 2)", 2), ("smoothstep(0.5)*t", 2), ("compare(x, y) + 1e-1", 1.1), ("2*-x", -2)],
)
def test_expressions(text, value):
    """As tinyexpr reads them: powers from the left, the sign of a number before its power, log of base 10."""
    assert compiled(text)(np.array([[1.0, 2.0, 3.0]]), 4.0) == pytest.approx([value])


@pytest.mark.parametrize("text", ["", "x +", "w", "sin x", "min(1)", "1 2", "__import__('os')", "x.real", True, [1]])
def test_no_expressions(text):
    with pytest.raises(NoExpression):
        compiled(text)


def test_it_falls_and_rests(imported, ran, tmp_path):
    made = imported(sources.polyfem(tmp_path))
    run = ran(made.path)
    audit, contacts = run.record["audit"], run.record["summary"]["contacts"]
    assert run.record["status"]["outcome"] == "ok" and contacts["max"] > 0
    assert audit["judged"] > 0 and audit["crossings"] == audit["unproven"] == audit["violations"] == 0
    first, last, before = (run.points[k][:8, 1].mean() for k in (0, -1, -2))
    assert first == pytest.approx(0.105 - 9.81e-4, rel=1e-9)  # the first step is a free fall of g h^2
    assert 0.099 < last < 0.1011 and abs(last - before) < 1e-4
