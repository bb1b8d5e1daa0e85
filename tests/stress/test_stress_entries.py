"""Tests as data: what is refused, and that nothing runs without an expectation."""

import json

import pytest

from barrierbench_analysis.io import fields
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.rules import stress
from barrierbench_analysis.studies.rules.stress.entry import FOLDER, OUTCOMES, Expected, Variant, ids, left_out, read_test

PRESETS = FOLDER.parent / "formulations"


def made(tmp_path, change=lambda data: data, name="M09"):
    """A copy of a test in a folder of its own, with a change."""
    (tmp_path / "scenes").mkdir(exist_ok=True)
    for file in ("formulations.json", "scenes/floor.json"):
        (tmp_path / file).write_text((FOLDER / file).read_text())
    data = json.loads((FOLDER / f"{name}.json").read_text())
    change(data)
    (tmp_path / f"{name}.json").write_text(json.dumps(data))
    return tmp_path


def test_every_test_of_the_suite_is_whole():
    assert len(ids()) >= 30
    for name in ids():
        test, full = read_test(name), read_test(name, full=True)
        assert test.data["title"] and (full.cases or "geometry" in full.data)


def test_the_larger_sizes_are_a_spec_of_their_own():
    study, full = read_study("stress"), read_study(str(FOLDER / "stress_full.json"))
    assert full.data["metrics"] == study.data["metrics"] and full.data["set"] == study.data["set"]
    assert full.about["limit_s"] == 10 * study.about["limit_s"] and not full.is_ours
    of = {name: {cell.place["case"] for cell in each.cells if cell.place["test"] == "S18"} for name, each in (("", study), ("full", full))}
    assert of[""] == {"n=4", "n=8", "n=16"} and of["full"] == of[""] | {"n=32", "n=64"}


def test_proposed_tests_are_here_or_left_out_with_a_reason():
    proposed = {f"S{k:02d}" for k in range(1, 24)}
    assert proposed == {name for name in (*ids(), *left_out()) if name.startswith("S")}
    assert not set(ids()) & set(left_out())
    assert any("10^5 contacts in one pair region" in why for why in left_out().values())


def test_every_preset_is_compared_or_left_out():
    data = json.loads((FOLDER / "formulations.json").read_text())
    here = {f["label"] for f in data["comparable"]} | set(data["left_out"])
    assert here == {path.stem for path in PRESETS.glob("*.json")}


def relation(**more):
    return lambda d: d.update(relations=[{"reason": "r", **more}])


@pytest.mark.parametrize("change, message", [
    (lambda d: d.update(speed=3), "/speed: unknown"),
    (lambda d: d.update(expect=[{"formulations": ["@fixed"], "outcomes": ["ok"], "reason": "r"}]), "nothing is expected of ipc2020 in case 'd_hat'"),
    (lambda d: d["expect"][0].update(cases=["one ulp *"]), "nothing is expected of log in case 'd_hat'"),
    (lambda d: d["expect"][0].update(outcomes=["fine"]), "#/expect/0/outcomes: found 'fine'; one of invalid_scene"),
    (lambda d: d["expect"][0].update(reason=""), "#/expect/0/reason: found ''; text is needed"),
    (lambda d: d["expect"][0].pop("outcomes"), "#/expect/0/outcomes: is missing"),
    (lambda d: d["expect"][0].update(most=1), "#/expect/0/most: unknown; allowed: formulations, cases, outcomes, reason"),
    (lambda d: d.update(changed=[{"what": "a", "old": "b", "new": "c"}]), "#/changed/0/why: is missing"),
    (lambda d: d.update(formulations={"only": []}), "#/formulations/only: unknown; allowed: base, add, own"),
    (lambda d: d.update(formulations={"add": {"lag": {}}}), "#/formulations/add: found 'lag'; one of log, log_squared"),
    (lambda d: d["expect"][0].update(cases=["gone"]), "#/expect/0/cases: found 'gone'; one of d_hat, one ulp less"),
    (lambda d: d["expect"][0].update(formulations=["lag"]), "#/expect/0/formulations: found 'lag'; one of log, log_squared"),
    (lambda d: d.update(base="scenes/none.json"), "#/base: found 'scenes/none.json'; the path of a config"),
    (lambda d: d["axes"][0]["cases"][0].update(sets={}), "/axes/0/cases/0/sets: unknown"),
    (lambda d: d["axes"][0]["cases"].append(d["axes"][0]["cases"][0]), "#/axes: found ['d_hat', "),
    (lambda d: d.update(id="M10"), "/id: found 'M10'"),
    (lambda d: d.update(schema="x/1"), "/schema: found 'x/1'"),
    (lambda d: d.pop("title"), "/title: is missing"),
    (lambda d: d.update(geometry="ccd"), "#/expect/0/"),
    (relation(kind="like"), "#/relations/0/kind: found 'like'; one of equal, differs, ratio, rises, bound is needed"),
    (relation(kind="equal", metric="gap", within=1, groups=[["d_hat", "one ulp less"]]), "#/relations/0/metric: found 'gap'; one of newton"),
    (relation(kind="equal", metric="newton", groups=[["d_hat", "one ulp less"]]), "#/relations/0/within: is missing"),
    (relation(kind="rises", metric="newton", groups=[["d_hat", "x"]]), "#/relations/0/groups: found 'x'; one of d_hat, one ulp less"),
    (relation(kind="rises", metric="newton", groups=[["d_hat"]]), "#/relations/0/groups/0: found ['d_hat']; a list of labels of cases, two at least, is needed"),
    (relation(kind="rises", metric="newton"), "#/relations/0/groups: is missing"),
    (relation(kind="bound", metric="newton"), "an object with `below` or `above` is needed"),
    (relation(kind="bound", metric="newton", below=1, within=2), "#/relations/0/within: unknown; allowed: kind, metric, formulations, reason, groups, above, below"),
])  # fmt: skip
def test_a_wrong_test_is_refused(tmp_path, change, message):
    read_test("M09", made(tmp_path))
    with pytest.raises(UserError, match="M09.json") as told:
        read_test("M09", made(tmp_path, change))
    assert message in str(told.value)


@pytest.mark.parametrize("change, message", [
    (lambda d: d.update(geometry="area"), "#/geometry: found 'area'; one of ccd, obtuse, parallel, shapes is needed"),
    (lambda d: d.update(base="x"), "#/base: a test of geometry runs no scene"),
    (lambda d: d["expect"][0].update(outcomes=["ok"]), "#/expect/0/outcomes: unknown; allowed: precisions, cases, most, reason"),
])  # fmt: skip
def test_a_wrong_test_of_geometry_is_refused(tmp_path, change, message):
    with pytest.raises(UserError, match="S02.json") as told:
        read_test("S02", made(tmp_path, change, "S02"))
    assert message in str(told.value)


def test_an_unknown_id_names_those_that_are():
    with pytest.raises(UserError, match="found 'S99'; allowed: S01, S02"):
        read_test("S99")


def test_named_covers_failures_that_are_named_and_nothing_else():
    expected = Expected(("named",), "r")
    assert all(expected.holds(word) for word in ("newton_stall", "invalid_scene", "stall_overload"))
    assert not any(expected.holds(word) for word in ("ok", "refused", "penetration", "unproven", "crash", "timeout", "not_valid"))
    assert {"refused", "crash", "timeout", "not_valid"} <= set(OUTCOMES)


def test_a_case_waits_for_a_setting_that_configs_do_not_have(monkeypatch):
    schema = {"properties": {"precision": {"enum": ["double"]}, "scene": {"$ref": "#/$defs/scene"}}, "$defs": {"scene": {"properties": {"name": {"type": "string"}}}}}
    monkeypatch.setattr(fields, "schema", lambda kind: schema)
    need = lambda pointer, value: Variant("x", {}, ({"pointer": pointer, "value": value},))
    assert not stress.waits(need("/precision", "double")) and stress.waits(need("/precision", "float"))
    assert not stress.waits(need("/scene/name", "x")) and stress.waits(need("/scene/far", 1)) and not stress.waits(Variant("x", {}))


def test_a_case_that_waits_is_no_cell(monkeypatch):
    monkeypatch.setattr(stress, "is_known", lambda need: False)
    study = read_study("stress")
    assert not [case for case in stress.cells(study) if case.place["test"] == "S19" and "float" in case.place["case"]]
    assert stress.rule(study, [])["waiting"] == 55
    assert ROOT in study.page.parents
