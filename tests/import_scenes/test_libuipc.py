"""Saved scenes of libuipc: constitutions, the table of contacts, what is fixed, and what is refused."""

import json

import numpy as np
import pytest
from tests.import_scenes import sources
from tests.import_scenes.conftest import entry_of

from barrierbench_analysis.program.mesh_arrays import read_body_file

POINTS, FACES = sources.sheet(3)
EDGES = np.unique(np.sort(np.concatenate([FACES[:, [0, 1]], FACES[:, [1, 2]], FACES[:, [0, 2]]]), axis=1), axis=0)
SOLID = {"tetrahedra": {"topo": sources.columns(sources.TETRAHEDRA)}}


def solid(saved, uid=9, name="cube", **more):
    cells = {"tetrahedra": SOLID["tetrahedra"] | {"kappa": [1e5] * 6}}
    saved.body(name, sources.CUBE, uid, **(cells | more))


def shell(saved, uid, half=0.001, meta=None, edges=None, **triangles):
    cells = {"triangles": {"topo": sources.columns(FACES), **triangles}, "edges": {"topo": sources.columns(EDGES), **(edges or {})}}
    saved.body("shell", POINTS, uid, meta=meta, vertices={"thickness": [half] * len(POINTS)}, **cells)


def read(imported, tmp_path, make, **config):
    saved = sources.Saved()
    make(saved)
    return imported(saved.write(tmp_path / "saved.json", **config))


def test_the_whole_scene(imported, tmp_path):
    made = imported(sources.libuipc(tmp_path))
    assert made.scene["gravity_m_per_s2"] == [0, -9.8, 0]
    assert made.config["time"] == {"dt_s": 0.01, "steps": 100} and made.card["defaults"][0]["key"] == "/time/steps"
    assert made.config["formulation"] == {"name": "ipc2020", "d_hat_m": 0.01}
    assert made.config["friction"] == {"mu": 0.2, "eps_v_m_per_s": 0.01}
    assert made.scene["obstacles"] == [{"name": "ground", "kind": "plane", "point_m": [0, 0, 0], "axis": [0, 1, 0]}]
    body = made.scene["bodies"][0]
    assert body["name"] == "cube" and np.allclose(read_body_file(made.path.parent / body["mesh"]["file"]).points, 0.2 * sources.CUBE + [0, 0.12, 0])


def test_stable_neo_hookean_keeps_its_moduli_at_rest(imported, tmp_path):
    material = imported(sources.libuipc(tmp_path)).scene["bodies"][0]["material"]
    young, nu = material["solid_youngs_Pa"], material["solid_poisson"]
    mu, lam = young / (2 * (1 + nu)), young * nu / ((1 + nu) * (1 - 2 * nu))
    assert material["solid_model"] == "stable_neo_hookean"
    assert mu == pytest.approx(0.75 * 4e5) and lam - mu == pytest.approx(1.4e6 - 0.625 * 4e5)


def test_arap(imported, tmp_path):
    made = read(imported, tmp_path, lambda s: solid(s, 9))
    material = made.scene["bodies"][0]["material"]
    assert material["solid_model"] == "arap"
    assert material["solid_youngs_Pa"] / (2 * (1 + material["solid_poisson"])) == pytest.approx(1e5)
    key = next(k for k in made.keys if k.endswith("/constitution_uid/name"))
    assert entry_of(made.card, key)[0] == "mapped"


def test_affine_bodies_are_stiff_solids_or_rigid(imported, tmp_path):
    far = np.eye(4)
    far[0, 3] = 3

    def make(saved):
        two = {"transform": [np.eye(4).tolist(), far.tolist()], "is_fixed": [1, 0], "kappa": [1e8, 1e8]}
        saved.body("abd", sources.CUBE, 1, meta={"self_collision": [0]}, instances=two, tetrahedra=SOLID["tetrahedra"])

    made = read(imported, tmp_path, make)
    still, free = made.scene["bodies"]
    assert still["kind"] == "rigid" and free["material"]["solid_youngs_Pa"] == pytest.approx(8e8) and free["material"]["solid_poisson"] == 0
    assert read_body_file(made.path.parent / free["mesh"]["file"]).points[:, 0].mean() == pytest.approx(3)
    assert {"a": free["name"], "b": free["name"], "kind": "off"} in made.scene["collisions"]
    key = next(k for k in made.keys if k.endswith("/kappa/name"))
    assert entry_of(made.card, key)[0] == "changed"


def moduli(material):
    young, nu = material["youngs_N_per_m"], material["poisson"]
    return young / (2 * (1 + nu)), young * nu / (1 - nu**2)


def test_shells_count_twice_their_thickness(imported, tmp_path):
    made = read(imported, tmp_path, lambda s: shell(s, 11, mu=[3e5] * 8, **{"lambda": [5e5] * 8}))
    body = made.scene["bodies"][0]
    assert moduli(body["material"]) == pytest.approx((0.002 * 3e5, 0.002 * 5e5))
    assert body["material"]["density_kg_per_m2"] == pytest.approx(2) and body["offset_m"] == pytest.approx(0.001)


def test_baraff_witkin_and_bending(imported, tmp_path):
    bend = {"bending_stiffness": [10.0] * len(EDGES)}
    meta = {"extra_constitution_uids": [[[17]]]}
    made = read(imported, tmp_path, lambda s: shell(s, 819, meta=meta, edges=bend, mu=[2e4] * 8, **{"lambda": [7e4] * 8}))
    material = made.scene["bodies"][0]["material"]
    assert material["model"] == "baraff_witkin"
    assert moduli(material) == pytest.approx((0.004 * 7e4, 0.004 * 2e4))
    area, half = 2 * 0.125, 0.001  # of both triangles of a hinge; inner edges: 8, of which 4 are diagonals
    straight, diagonal = (2 * 10 * area * half * length / (area / 3 / length) for length in (0.5, np.sqrt(0.5)))
    assert material["bending_J"] == pytest.approx((straight + diagonal) / 2)


def test_springs_and_rods(imported, tmp_path):
    line = np.array([[0.1 * k, 0, 0] for k in range(5)])
    edges = {"topo": sources.columns([[k, k + 1] for k in range(4)]), "kappa": [4e7] * 4}
    vertices = {"thickness": [0.01] * 5, "bending_stiffness": [1e6] * 5}

    def make(saved):
        saved.body("rod", line, 12, meta={"extra_constitution_uids": [[[15]]]}, vertices=vertices, edges=edges)

    material = read(imported, tmp_path, make).scene["bodies"][0]["material"]
    section = np.pi * 1e-4
    assert material["rod_stretching_N"] == pytest.approx(4e7 * section)
    assert material["line_density_kg_per_m"] == pytest.approx(1000 * section)
    assert material["rod_bending_N_m2"] == pytest.approx(1e6 * np.pi * 1e-8 / 4)


def test_fixed_vertices_velocities_and_a_rest_shape(imported, tmp_path):
    fixed = {"is_fixed": [1, 0, 0, 0, 0, 0, 0, 1], "velocity": sources.columns([[0, 0, 2.0]] * 8)}
    saved = sources.Saved()
    solid(saved, vertices=fixed)
    solid(saved, name="rest", vertices={"position": sources.columns(2 * sources.CUBE)})
    path = saved.write(tmp_path / "saved.json")
    data = json.loads(path.read_text())
    data["__data__"]["geometry_slots"] = [{"id": 0, "index": 0}]
    data["__data__"]["rest_geometry_slots"] = [{"id": 0, "index": 1}]
    path.write_text(json.dumps(data))
    made = imported(path)
    body = made.scene["bodies"][0]
    assert body["pins"] == [{"indices": [0, 7]}] and body["velocity_m_per_s"] == [0, 0, 2]
    assert np.allclose(read_body_file(made.path.parent / body["rest_mesh"]["file"]).points, 2 * sources.CUBE)


def test_the_table_of_contacts(imported, tmp_path):
    def make(saved):
        solid(saved, meta={"contact_element_id": [1]})
        saved.body("other", sources.CUBE + [0, 3, 0], 9, tetrahedra=SOLID["tetrahedra"] | {"kappa": [1e5] * 6})

    made = read(imported, tmp_path, make, friction=((0, 0, 0.5, 1), (0, 1, 0.2, 0)))
    assert made.config["friction"]["mu"] == 0.5
    assert [body.get("friction") for body in made.scene["bodies"]] == [None, None]
    assert made.scene["collisions"] == [{"a": "cube", "b": "other", "kind": "off"}]
    key = next(k for k in made.keys if k.endswith("/friction_rate/name"))
    assert entry_of(made.card, key)[0] == "mapped"


def three(saved):
    for number in (1, 2):
        cells = {"tetrahedra": SOLID["tetrahedra"] | {"kappa": [1e5] * 6}}
        saved.body(f"cube_{number}", sources.CUBE + [0, 3 * number, 0], 9, meta={"contact_element_id": [number]}, **cells)
    saved.ground(-2.0, element=3)


def combined(made, *names):
    """The coefficient of a pair in the config."""
    friction = made.config["friction"]
    sides = {one["name"]: one.get("friction", friction["mu"]) for one in (*made.scene["bodies"], *made.scene["obstacles"])}
    rule = {"min": min, "max": max, "mean": lambda a, b: (a + b) / 2}[friction.get("combine", "min")]
    return rule(*(sides[name] for name in names))


def test_pairs_with_a_ground_that_are_off(imported, tmp_path):
    made = read(imported, tmp_path, three, friction=((0, 0, 0.5, 1), (1, 3, 0.2, 0)))
    assert made.scene["collisions"] == [{"a": "cube_1", "b": "ground", "kind": "off"}]


def test_pairs_that_the_table_lacks_are_as_the_first_one(imported, tmp_path):
    made = read(imported, tmp_path, three, friction=((0, 0, 0.5, 0), (1, 2, 0.2, 1)))
    off = {(pair["a"], pair["b"]) for pair in made.scene["collisions"]}
    assert off == {("cube_1", "cube_1"), ("cube_2", "cube_2"), ("cube_1", "ground"), ("cube_2", "ground")}


@pytest.mark.parametrize("rates, rule", [((0.5, 0.2, 0.2), "min"), ((0.6, 0.6, 0.1), "max"), ((0.1, 0.3, 0.2), "mean")])
def test_friction_of_pairs_comes_out_right(imported, tmp_path, rates, rule):
    between, first, second = rates
    rows = ((0, 0, 0.9, 1), (1, 2, between, 1), (1, 3, first, 1), (2, 3, second, 1), (1, 1, 0.0, 0), (2, 2, 0.0, 0))
    made = read(imported, tmp_path, three, friction=rows)
    assert made.config["friction"].get("combine", "min") == rule
    for pair, rate in zip((("cube_1", "cube_2"), ("cube_1", "ground"), ("cube_2", "ground")), rates):
        assert combined(made, *pair) == pytest.approx(rate)
    key = next(k for k in made.keys if k.endswith("/friction_rate/name"))
    assert entry_of(made.card, key)[0] == "mapped"


def test_friction_that_no_coefficients_give_is_listed(imported, tmp_path):
    rows = ((0, 0, 0.9, 1), (1, 2, 0.1, 1), (1, 3, 0.3, 1), (2, 3, 0.2, 1), (1, 1, 0.7, 1), (2, 2, 0.5, 1))
    made = read(imported, tmp_path, three, friction=rows)
    kind, entry = entry_of(made.card, next(k for k in made.keys if k.endswith("/friction_rate/name")))
    assert kind == "changed" and len(entry["was"]) == len(entry["became"]) > 0
    names = {1: "cube_1", 2: "cube_2", 3: "ground"}
    for was, became in zip(entry["was"], entry["became"]):
        (pair, before), (same, after) = was.split(": "), became.split(": ")
        a, b = map(int, pair.removeprefix("elements ").split(", "))
        assert pair == same and next(rate for c, d, rate, _ in rows if (c, d) == (a, b)) == float(before)
        assert combined(made, names[a], names[b]) == pytest.approx(float(after)) != float(before)
    wrong = {one.split(": ")[0] for one in entry["was"]}
    right = [(a, b, rate) for a, b, rate, _ in rows[1:] if f"elements {a}, {b}" not in wrong]
    assert right and all(combined(made, names[a], names[b]) == pytest.approx(rate) for a, b, rate in right)


@pytest.mark.parametrize("uid, shear", [(1, 4.0), (2, 1.0)])
def test_instances_have_their_own_stiffness_and_velocity(imported, tmp_path, uid, shear):
    far, speed = np.eye(4), np.zeros((2, 4, 4))
    far[0, 3] = 3
    speed[0, 0, 3], speed[1, 1, 3] = 2.0, -5.0

    def make(saved):
        two = {"transform": [np.eye(4).tolist(), far.tolist()], "kappa": [1e6, 3e6], "velocity": speed.tolist()}
        saved.body("abd", sources.CUBE, uid, instances=two, tetrahedra=SOLID["tetrahedra"])

    bodies = read(imported, tmp_path, make).scene["bodies"]
    assert [body["velocity_m_per_s"] for body in bodies] == [[2, 0, 0], [0, -5, 0]]
    for body, kappa in zip(bodies, (1e6, 3e6)):
        material = body["material"]
        assert material["solid_poisson"] == 0 and material["solid_youngs_Pa"] == pytest.approx(2 * shear * kappa)


def test_affine_shells_that_can_move_are_left_out(imported, tmp_path):
    def make(saved):
        solid(saved)
        instances = {"kappa": [1e8], "is_fixed": [0]}
        saved.body("free", POINTS + [0, 5, 0], 1, instances=instances, triangles={"topo": sources.columns(FACES)})
        instances = {"kappa": [1e8], "is_fixed": [1]}
        saved.body("still", POINTS - [0, 5, 0], 1, instances=instances, triangles={"topo": sources.columns(FACES)})

    made = read(imported, tmp_path, make)
    assert [body["name"] for body in made.scene["bodies"]] == ["cube", "still"]
    found = [entry for entry in made.card["not_mapped"] if "without tetrahedra" in entry["consequence"]]
    assert len(found) == 1 and all("/geometries/1/" in f"{key}/" for key in found[0]["keys"])


@pytest.mark.parametrize("topology", [[[0, 4]], [[[0], [4], [6], ["seven"]]], [[[0], [4], [6], [99]]]])
def test_damaged_cells_are_refused_at_their_geometry(refused, tmp_path, topology):
    saved = sources.Saved()
    saved.body("cube", sources.CUBE, 9, tetrahedra={"topo": topology, "kappa": [1e5]})
    assert "saved.json#/__data__/geometry_atlas/__data__/geometries/0: found values" in refused(saved.write(tmp_path / "saved.json"))


def test_settings(imported, tmp_path):
    made = imported(sources.libuipc(tmp_path, integrator__type=["bdf2"], contact__enable=[0], contact__friction__enable=[0]))
    assert made.config["integrator"]["name"] == "bdf2" and "friction" not in made.config
    assert {"a": "cube", "b": "ground", "kind": "off"} in made.scene["collisions"]


def test_what_is_no_body_is_listed(imported, tmp_path):
    def make(saved):
        solid(saved)
        saved.body("grains", sources.CUBE, 13)
        saved.body("joint", POINTS, 18, edges={"topo": sources.columns(EDGES)})

    made = read(imported, tmp_path, make)
    assert [body["name"] for body in made.scene["bodies"]] == ["cube"]
    words = [entry["consequence"] for entry in made.card["not_mapped"]]
    assert "a particle has no cells: the geometry is left out" in words
    assert "the constitution 18 is not read: the geometry is left out" in words


def test_unknown_keys_are_listed(imported, tmp_path):
    def make(saved):
        solid(saved, vertices={"charge": [1.0] * 8})

    made = read(imported, tmp_path, make, contact__colour=["red"])
    assert sorted(key.rpartition("/")[2] for key in made.unknown) == ["charge", "contact~1colour"]


def test_bad_input(refused, tmp_path):
    path = sources.libuipc(tmp_path)
    data = json.loads(path.read_text())
    path.write_text(json.dumps(data | {"__meta__": {"type": "SceneSnapshotCommit"}}))
    assert "#/__meta__/type: found 'SceneSnapshotCommit'; allowed: SceneSnapshot" in refused(path)
    del data["__data__"]["geometry_atlas"]["__data__"]["attribute_collections"]["config"]["__data__"]["dt"]
    path.write_text(json.dumps(data))
    assert "#/__data__: found a scene without" in refused(path)
    assert "integrator~1type: found 'bdf7'; allowed: bdf1, bdf2" in refused(sources.libuipc(tmp_path, integrator__type=["bdf7"]))


def test_it_falls_and_rests(imported, ran, tmp_path):
    run = ran(imported(sources.libuipc(tmp_path), "--steps", "40").path)
    audit = run.record["audit"]
    assert run.record["status"]["outcome"] == "ok" and run.record["summary"]["contacts"]["max"] > 0
    assert audit["judged"] > 0 and audit["crossings"] == audit["unproven"] == audit["violations"] == audit["obstacle_violations"] == 0
    heights = [points[:, 1].mean() for points in run.points]
    assert heights[0] == pytest.approx(0.12 - 9.8e-4, rel=1e-9)
    assert 0.09 < heights[-1] < 0.112 and abs(heights[-1] - heights[-2]) < 2e-4
