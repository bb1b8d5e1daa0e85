"""A scene of a confirmation sweep is none that a tuning sweep used, whatever it is called."""

import copy
import json
from dataclasses import replace

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.claims import fresh
from barrierbench_analysis.studies.claims.entry import ROOT, read_sweep

SWEEP = read_sweep("shells_contact")


def scene(n=4, **more):
    return {"name": "bodies", "gravity_m_per_s2": [0, 0, -9.81], "obstacles": [{"kind": "plane"}],
            "bodies": [{"name": "a", "mesh": {"generator": "grid", "n_x": n, "n_y": n, "size_x_m": 0.5}, "material": {"youngs_N_per_m": 20}, **more}]}


def changed(way, value):
    made = scene()
    at = made
    for word in way[:-1]:
        at = at[word]
    at[way[-1]] = value
    return made


def identity(made):
    return fresh.identity(made, ROOT)


@pytest.mark.parametrize("same", [
    scene(9), changed(("bodies", 0, "name"), "b"), changed(("obstacles", 0, "name"), "floor"), changed(("bodies", 0, "material", "youngs_N_per_m"), 20.0),
    changed(("bodies", 0, "material", "poisson"), 0.3), changed(("bodies", 0, "velocity_m_per_s"), [0.0, 0.0, 0.0]), changed(("obstacles", 0, "inside"), False)])
def test_names_resolution_and_defaults_make_no_other_scene(same):
    assert identity(same) == identity(scene())


def test_the_order_of_bodies_and_the_sign_of_a_zero_make_no_other_scene():
    two, swapped = scene(), scene()
    two["bodies"].append({**two["bodies"][0], "material": {"youngs_N_per_m": 5}})
    swapped["bodies"] = two["bodies"][::-1]
    assert identity(two) == identity(swapped) != identity(scene())
    assert identity(changed(("gravity_m_per_s2",), [-0.0, 0, -9.81])) == identity(scene())


@pytest.mark.parametrize("other", [
    changed(("bodies", 0, "material", "youngs_N_per_m"), 21), changed(("obstacles", 0, "kind"), "sphere"), changed(("bodies", 0, "mesh", "size_x_m"), 0.6),
    changed(("gravity_m_per_s2",), [0, 0, -1.62]), changed(("bodies", 0, "velocity_m_per_s"), [0, 0, -1]), changed(("bodies", 0, "mesh", "generator"), "box"),
    changed(("obstacles", 0, "inside"), True)])
def test_materials_meshes_and_obstacles_do(other):
    assert identity(other) != identity(scene())


def of_mesh(generator, **numbers):
    return identity({"name": "bodies", "bodies": [{"mesh": {"generator": generator, **numbers}}]})


@pytest.mark.parametrize("generator, key", [
    ("solid_box", "n_z"), ("solid_torus", "n_radial"), ("cone", "n_rings"), ("knotted_strip", "n_across"), ("knit", "n_per_loop"), ("icosphere", "level")])
def test_a_finer_mesh_is_no_other_scene(generator, key):
    assert of_mesh(generator, **{key: 2}) == of_mesh(generator, **{key: 3})


@pytest.mark.parametrize("generator, key", [(generator, key) for generator, keys in fresh.SHAPE.items() for key in sorted(keys)])
def test_what_a_mesh_has_of_a_thing_is_its_shape(generator, key):
    assert of_mesh(generator, **{key: 2}) != of_mesh(generator, **{key: 3})


def test_a_mesh_file_is_its_contents(tmp_path):
    for name, text in (("a.obj", "v 0 0 0"), ("b.obj", "v 0 0 0"), ("c.obj", "v 1 0 0")):
        (tmp_path / name).write_text(text)
    a, b, c = (fresh.identity({"name": "bodies", "bodies": [{"mesh": {"file": name}}]}, tmp_path) for name in ("a.obj", "b.obj", "c.obj"))
    assert a == b != c


def tuning(tmp_path, place, data):
    file = tmp_path / place.replace("*", "x")
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(data))
    fresh.used.cache_clear()
    return fresh.used(tmp_path)


@pytest.mark.parametrize("place", fresh.TUNING)
def test_all_places_of_tuning_are_looked_into(tmp_path, place):
    assert any(ROOT.glob(place)) and identity(scene()) in tuning(tmp_path, place, {"axes": [{"cases": [{"set": {"/scene": scene()}}]}]})


def test_settings_of_a_base_make_its_scenes(tmp_path):
    (tmp_path / "claims/sweeps").mkdir(parents=True)
    (tmp_path / "claims/sweeps/base.cfg.json").write_text(json.dumps({"scene": scene()}))
    softer, faster = {"/scene/bodies/0/material/youngs_N_per_m": 2}, {"/scene/bodies/0/velocity_m_per_s": [0, 0, -1]}
    found = tuning(tmp_path, "claims/sweeps/*.json", {"base": "base.cfg.json", "axes": [{"cases": [{"set": softer}]}, {"cases": [{"set": faster}, {"set": {"/scene/n": 3}}]}]})
    both = changed(("bodies", 0, "material", "youngs_N_per_m"), 2)
    both["bodies"][0]["velocity_m_per_s"] = [0, 0, -1]
    assert {identity(scene()), identity(changed(("bodies", 0, "material", "youngs_N_per_m"), 2)), identity(both)} <= set(found)


def edited(tmp_path, edit):
    data = json.loads(SWEEP.path.read_text())
    edit(data["axes"][0]["cases"])
    (tmp_path / "configs/scenes").mkdir(parents=True)
    (tmp_path / "configs/scenes/hang.json").write_bytes((ROOT / "configs/scenes/hang.json").read_bytes())
    path = tmp_path / "claims/confirmation/shells_contact.json"
    path.parent.mkdir(parents=True)
    path.write_text(json.dumps(data))
    return replace(SWEEP, path=path)


def of_pile(cases):
    """Scene of the tuning sweep contact_shapes, under another name, finer, with its bodies renamed."""
    tuned = json.loads((ROOT / "claims/sweeps/contact_shapes.json").read_text())["axes"][0]["cases"]
    made = copy.deepcopy(next(case["set"]["/scene"] for case in tuned if case["label"].startswith("pile")))
    for body in made["bodies"]:
        body["name"] += "_new"
        body["mesh"] |= {"n_x": 11, "n_y": 11}
    cases[0]["set"]["/scene"] = made


def test_a_scene_that_a_tuning_sweep_used_is_refused(tmp_path):
    fresh.used.cache_clear()
    fresh.check(SWEEP)
    with pytest.raises(UserError, match="claims/confirmation/shells_contact.json: bar 6: its scene is one of claims/sweeps/contact_shapes.json"):
        fresh.check(edited(tmp_path, of_pile))


def test_a_scene_with_defaults_is_refused(tmp_path):
    with pytest.raises(UserError, match="bar 6: the scene is 'hang'; a confirmation scene is of bodies, all written out"):
        fresh.check(edited(tmp_path, lambda cases: cases[0]["set"].update({"/scene": {"name": "hang", "n": 7}})))


def test_too_few_scenes_are_refused(tmp_path):
    with pytest.raises(UserError, match="7 scenes; a confirmation has at least 8"):
        fresh.check(edited(tmp_path, lambda cases: cases.__delitem__(slice(21, None))))


def test_what_a_claim_was_made_from_does_not_confirm_it():
    """A sweep that confirmed another claim is no tuning sweep; for the claim that was made of its numbers it is one."""
    first, second = read_sweep("solids_let_go"), read_sweep("solids_both_ways")
    fresh.check(first)
    fresh.check(second, own=[first])
    with pytest.raises(UserError, match="its scene is one of claims/confirmation/solids_let_go.json, where rules were tuned"):
        fresh.check(first, own=[first])


def test_a_scene_counts_once(tmp_path):
    def twice(cases):
        for case in cases:
            if case["label"].startswith("trough "):
                case["set"]["/scene"] = next(one["set"]["/scene"] for one in cases if one["label"] == "bar 6")

    with pytest.raises(UserError, match="trough 6: its scene is that of bar: a scene counts once"):
        fresh.check(edited(tmp_path, twice))


def test_scenes_of_another_confirmation_are_found():
    shells, solids = read_sweep("shells_contact"), read_sweep("solids_let_go")
    assert fresh.shared(read_sweep("shells_shapes"), [solids, shells]) == "claims/confirmation/shells_contact.json"
    assert fresh.shared(solids, [shells, read_sweep("solids_both_ways")]) == ""
