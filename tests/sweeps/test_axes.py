"""Ranges, zips, exclusions, repetitions and seeds of sweep files."""

import json

import pytest
from sweep_files import SHAPES, STEPS, bench, planned, records, refused, write_sweep

JITTER = {"/seeds/jitter_m": 1e-6}


def labels(program, file) -> list[str]:
    return [name.rsplit("-", 1)[0] for name in planned(program, file)]


@pytest.mark.parametrize("ends, values", [
    ({"from": 0.001, "to": 0.1, "count": 3, "scale": "log"}, ["0.001", "0.01", "0.1"]),
    ({"from": 100, "to": 1, "count": 3, "scale": "log"}, ["100", "10", "1"]),
    ({"from": 0.1, "to": 0.4, "count": 4}, ["0.1", "0.2", "0.3", "0.4"]),
])
def test_a_range_is_its_values(program, tmp_path, ends, values):
    file = write_sweep(tmp_path, {"pointer": "/seeds/jitter_m", "range": ends})
    found = labels(program, file)
    assert found == [f"jitter_m={value}" for value in values]
    listed = write_sweep(tmp_path, {"pointer": "/seeds/jitter_m", "values": [json.loads(value) for value in values]})
    assert planned(program, listed) == planned(program, file) or values[0] == "0.1" and labels(program, listed) == found


def test_whole_numbers_of_a_range_are_integers(program, tmp_path):
    assert labels(program, write_sweep(tmp_path, {"pointer": "/time/steps", "range": {"from": 2, "to": 8, "count": 3}})) == ["steps=2", "steps=5", "steps=8"]
    refused(bench(program, "sweep", write_sweep(tmp_path, {"pointer": "/time/steps", "range": {"from": 2, "to": 3, "count": 3}}), "--dry-run"),
            "steps=2.5", "/time/steps")


def test_zipped_axes_go_along_with_one_another(program, tmp_path):
    zipped = {"zip": [STEPS, {"pointer": "/time/dt_s", "range": {"from": 0.01, "to": 0.005, "count": 2}}]}
    assert bench(program, "sweep", write_sweep(tmp_path, zipped, {"pointer": "/formulation", "values": ["log", "cubic"]}), "--out", tmp_path / "out").returncode == 0
    found = {label: (record["config"]["time"]["steps"], record["config"]["time"]["dt_s"], record["labels"]["swept"]["/time/dt_s"])
             for label, record in records(tmp_path / "out").items()}
    assert found == {f"steps={steps} dt_s={dt} formulation={name}": (steps, float(dt), dt)
                     for steps, dt in ((2, "0.01"), (3, "0.005")) for name in ("log", "cubic")}


@pytest.mark.parametrize("rule, left", [
    ({"where": {"/time/steps": 2}, "labels": ["formulation=cubic"]}, 5),
    ({"where": {"/time/steps": 2, "/formulation": ["log", "cubic"]}}, 4),
    ({"labels": ["formulation=cubic"]}, 4),
])
def test_what_has_all_of_an_exclusion_is_left_out(program, tmp_path, rule, left):
    found = labels(program, write_sweep(tmp_path, STEPS, SHAPES, exclude=[rule]))
    assert len(found) == left and "steps=2_formulation=cubic" not in found and "steps=3_formulation=log" in found


def test_the_reference_of_others_is_not_left_out(program, tmp_path):
    cases = {"cases": [{"label": name, "reference": name == "log", "set": {"/formulation": name}} for name in ("log", "cubic")]}
    file = write_sweep(tmp_path, STEPS, cases, exclude=[{"where": {"/time/steps": 2}, "labels": ["log"]}])
    refused(bench(program, "sweep", file, "--dry-run"), "#/exclude", "the reference of \"steps=2 cubic\" is left out")


def test_an_unknown_key_is_refused_with_those_that_there_are(program, tmp_path):
    file = write_sweep(tmp_path, STEPS, exlude=[{}])
    refused(bench(program, "sweep", file, "--dry-run"), "exlude", "did you mean exclude?", "repeat", "budget", "seed")


def test_formulations_share_seeds_and_nothing_else_does(program, tmp_path):
    file = write_sweep(tmp_path, STEPS, SHAPES, settings=JITTER, seed=7, repeat=2)
    out = tmp_path / "out"
    assert bench(program, "sweep", file, "--out", out).returncode == 0
    seeds: dict[tuple, set] = {}
    for record in records(out).values():
        swept = record["labels"]["swept"]
        assert record["config"]["seeds"]["main"] == int(swept["/seeds/main"]) > 1000
        seeds.setdefault((swept["/time/steps"], swept["repetition"]), set()).add(swept["/seeds/main"])
    assert len(records(out)) == 12 and len(seeds) == 4
    assert all(len(shared) == 1 for shared in seeds.values()), seeds
    assert len(set.union(*seeds.values())) == 4
    other = write_sweep(tmp_path, STEPS, SHAPES, settings=JITTER, seed=8, repeat=2)
    assert not set(planned(program, other)) & {path.name for path in out.iterdir()}


def test_another_value_on_an_axis_leaves_the_seeds_of_the_others(program, tmp_path):
    few = planned(program, write_sweep(tmp_path, STEPS, settings=JITTER, seed=7))
    more = planned(program, write_sweep(tmp_path, {"pointer": "/time/steps", "values": [1, 2, 3]}, settings=JITTER, seed=7))
    assert set(few) < set(more)


def test_repetitions_without_a_seed_are_the_same_run_in_folders_of_their_own(program, tmp_path):
    out = tmp_path / "out"
    assert bench(program, "sweep", write_sweep(tmp_path, STEPS, repeat=2), "--out", out).returncode == 0
    found = records(out)
    assert list(sorted(found)) == ["steps=2 r1", "steps=2 r2", "steps=3 r1", "steps=3 r2"]
    assert found["steps=2 r1"]["summary"]["state_hash"] == found["steps=2 r2"]["summary"]["state_hash"] != found["steps=3 r1"]["summary"]["state_hash"]
    assert found["steps=2 r2"]["labels"]["swept"] == {"/time/steps": "2", "repetition": "2"}
    assert found["steps=2 r2"]["comparability"]["reference_run"].startswith("steps=2_r2-")


def test_a_run_longer_than_its_budget_ends_as_timeout_and_a_spent_budget_begins_no_other(program, tmp_path):
    file = write_sweep(tmp_path, {"pointer": "/time/steps", "values": [10**6, 10**6 + 1]}, budget={"run_s": 0.2, "core_s": 0.1})
    done = bench(program, "sweep", file, "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert [record["status"]["outcome"] for record in records(tmp_path / "out").values()] == ["timeout"]
    assert "1 of 2 runs were not begun: the budget of 0.1 core s is spent" in done.stdout


def test_plan_names_every_case_whose_scene_cannot_be_built(program, tmp_path):
    """Such a scene is found when its size is computed, after the config was read."""
    pins = {"box_m": [[-9, -9, -9], [9, 0, 9]]}
    body = {"name": "cloth", "mesh": {"generator": "grid", "n_x": 3, "n_y": 3}, "material": {"youngs_N_per_m": 100}, "pins": [pins]}
    base = tmp_path / "base.json"
    base.write_text(json.dumps({"schema": "barrierbench.config/1", "scene": {"name": "bodies", "bodies": [body]},
                                "formulation": {"name": "log", "d_hat_m": 0.01}, "time": {"dt_s": 0.01, "steps": 2}}))
    nowhere = [{"label": f"at {x}", "set": {"/scene/bodies/0/pins/0/box_m": [[x, x, x], [x + 1, x + 1, x + 1]]}} for x in (50, 60)]
    file = tmp_path / "pins.json"
    axis = {"cases": [{"label": "some", "set": {"/time/steps": 3}}, *nowhere]}
    file.write_text(json.dumps({"schema": "barrierbench.sweep/1", "name": "pins", "base": str(base), "axes": [axis]}))
    done = bench(program, "plan", file)
    refused(done, "[at 50]", "[at 60]", "no vertex selected")
    assert "[some]" not in done.stderr and done.stdout == ""
