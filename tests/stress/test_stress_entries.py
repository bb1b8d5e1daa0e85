"""Tests as data: what is refused, and that nothing runs without an expectation."""

import json

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.stress.verb import main
from barrierbench_analysis.studies.stress.entry import FOLDER, Expected, ids, left_out, read_test
from barrierbench_analysis.studies.stress.relations import check
from barrierbench_analysis.studies.stress.run import known

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
        for k, entry in enumerate(test.data.get("relations", [])):
            check(test, entry, k)


def test_proposed_tests_are_here_or_left_out_with_a_reason():
    proposed = {f"S{k:02d}" for k in range(1, 24)}
    assert proposed == {name for name in (*ids(), *left_out()) if name.startswith("S")}
    assert not set(ids()) & set(left_out())
    assert any("10^5 contacts in one pair region" in why for why in left_out().values())


def test_every_preset_is_compared_or_left_out():
    data = json.loads((FOLDER / "formulations.json").read_text())
    here = {f["label"] for f in data["comparable"]} | set(data["left_out"])
    assert here == {path.stem for path in PRESETS.glob("*.json")}


@pytest.mark.parametrize("change, message", [
    (lambda d: d.update(speed=3), "/speed: unknown"),
    (lambda d: d.update(expect=[{"formulations": ["@fixed"], "outcomes": ["ok"], "reason": "r"}]), "nothing is expected of ipc2020 in case 'd_hat'"),
    (lambda d: d["expect"][0].update(cases=["one ulp *"]), "nothing is expected of log in case 'd_hat'"),
    (lambda d: d["expect"][0].update(outcomes=["fine"]), "'fine'; allowed: invalid_scene"),
    (lambda d: d["expect"][0].update(reason=""), "#/expect/0/reason: found ''; text is needed"),
    (lambda d: d["expect"][0].pop("outcomes"), "#/expect/0/outcomes: is missing"),
    (lambda d: d["expect"][0].update(most=1), "#/expect/0/most: unknown; allowed: formulations, cases, outcomes, reason"),
    (lambda d: d.update(changed=[{"what": "a", "old": "b", "new": "c"}]), "#/changed/0/why: is missing"),
    (lambda d: d.update(formulations={"only": []}), "#/formulations/only: unknown; allowed: base, add, own"),
    (lambda d: d["expect"][0].update(cases=["gone"]), "'gone' is no case"),
    (lambda d: d["expect"][0].update(formulations=["lag"]), "'lag'; allowed: log, log_squared"),
    (lambda d: d.update(base="scenes/none.json"), "#/base: found 'scenes/none.json'; the path of a config"),
    (lambda d: d.update(quick=["gone"]), "/quick: 'gone' is no case"),
    (lambda d: d["axes"][0]["cases"][0].update(sets={}), "/axes/0/cases/0/sets: unknown"),
    (lambda d: d.update(id="M10"), "/id: found 'M10'"),
    (lambda d: d.update(schema="x/1"), "/schema: found 'x/1'"),
    (lambda d: d.pop("title"), "/title: is missing"),
])
def test_a_wrong_test_is_refused(tmp_path, change, message):
    read_test("M09", made(tmp_path))
    with pytest.raises(UserError, match="M09.json") as told:
        read_test("M09", made(tmp_path, change))
    assert message in str(told.value)


def test_an_unknown_id_ends_with_2(capsys):
    assert main(["S99"]) == 2 and "S99" in capsys.readouterr().err


def test_named_covers_failures_that_are_named_and_nothing_else():
    expected = Expected(("named",), "r")
    assert all(expected.holds(word) for word in ("newton_stall", "invalid_scene", "stall_overload"))
    assert not any(expected.holds(word) for word in ("ok", "refused", "penetration", "unproven", "crash", "timeout", "not_valid"))


def test_a_setting_that_the_program_does_not_have_is_told_from_one_that_it_has():
    schema = {"properties": {"precision": {"enum": ["double"]}, "scene": {"$ref": "#/$defs/scene"}}, "$defs": {"scene": {"properties": {"name": {"type": "string"}}}}}
    assert known({"pointer": "/precision", "value": "double"}, schema) and not known({"pointer": "/precision", "value": "float"}, schema)
    assert known({"pointer": "/scene/name", "value": "x"}, schema) and not known({"pointer": "/scene/far", "value": 1}, schema)


@pytest.mark.parametrize("entry, message", [
    ({"kind": "like"}, "/kind: 'like'"), ({"kind": "equal", "metric": "gap", "within": 1, "groups": [["d_hat", "one ulp less"]]}, "/metric: 'gap'"),
    ({"kind": "equal", "metric": "newton", "groups": [["d_hat", "one ulp less"]]}, "within"), ({"kind": "rises", "metric": "newton", "groups": [["d_hat", "x"]]}, "'x' is no case"),
    ({"kind": "rises", "metric": "newton", "groups": [["d_hat"]]}, "two cases"), ({"kind": "rises", "metric": "newton"}, "groups"), ({"kind": "bound", "metric": "newton"}, "below or above")])
def test_a_wrong_relation_is_refused(entry, message):
    with pytest.raises(UserError) as told:
        check(read_test("M09"), {"reason": "r", **entry}, 0)
    assert message in str(told.value)
