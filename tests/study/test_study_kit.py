"""The study kit: specs, and the cells that they and their rules make."""

import json

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.kit.study import collect
from barrierbench_analysis.studies.kit.study.spec import Case, Study, read_study

from small_study import BASE, SPEC, written

pytestmark = pytest.mark.usefixtures("rule_of_small")


def test_cells_are_the_product_of_axes_and_seeds(tmp_path):
    cells = written(tmp_path).cells
    assert [cell.label for cell in cells][:3] == ["strip a one 1", "strip a one 2", "strip a two 1"]
    assert len(cells) == len({cell.key for cell in cells}) == 8
    assert cells[-1].settings == {"/time/dt_s": 0.005, "/formulation": "cubic", "/seeds/main": 2}


def test_the_key_of_a_cell_is_of_all_that_its_run_is_made_of(tmp_path):
    before = [cell.key for cell in written(tmp_path).cells]
    assert before == [cell.key for cell in written(tmp_path, question="Another one?").cells]
    assert not set(before) & {cell.key for cell in written(tmp_path, set={"/threads": 1, "/time/steps": 3}).cells}
    study = written(tmp_path)
    (tmp_path / "base.json").write_text(json.dumps({**BASE, "doc": "another file"}))
    assert not set(before) & {cell.key for cell in Study(study.file, study.data).cells}


def test_a_plugin_is_a_part_of_the_key(tmp_path):
    plain = written(tmp_path).cells[0].key
    (tmp_path / "mine.so").write_bytes(b"one")
    study = written(tmp_path, plugins=["mine.so"])
    assert study.plugins == [str(tmp_path / "mine.so")] and study.cells[0].key != plain
    (tmp_path / "mine.so").write_bytes(b"another")
    assert written(tmp_path, plugins=["mine.so"]).cells[0].key != study.cells[0].key


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"axes": [{"names": ["scene"], "cases": SPEC["axes"][0]["cases"]}]},
            "axes/0/cases/label: found 'strip a'; a word for each of scene",
        ),
        ({"axes": [{"names": ["scene"], "cases": []}]}, "axes/0/cases: found"),
        ({"axes": [SPEC["axes"][1], SPEC["axes"][1]]}, "axes: found .*; another name for each axis"),
        (
            {"axes": [{"names": ["a"], "cases": [{"label": k, "set": {}} for k in "ab"]}]},
            "axes: found 'b 1'|axes: found 'a 1'",
        ),
        ({"metrics": {"x": "newtons"}}, "metrics/x: found 'newtons'; a pointer, or one of"),
        ({"metrics": {"x": "/steps/-1/kinetic_Joule"}}, "metrics/x: found '/steps/-1/kinetic_Joule'; the pointer of a field of records"),
        ({"metrics": {"x": "/sumary/steps"}}, "metrics/x: found '/sumary/steps'; the pointer of a field"),
        ({"base": "none.json"}, "base: found 'none.json'"),
        ({"name": "other"}, "name: found 'other'; 'small', as its file is called"),
        ({"page": "docs/x.md"}, "page: found 'docs/x.md'; results/NAME.md"),
        ({"seeds": [1, 1]}, "seeds: found"),
        ({"run_s": 0}, "run_s: found 0; a number of seconds > 0 after which a run ends as timeout"),
    ],
)
def test_a_spec_that_says_too_little_is_refused_with_its_place(tmp_path, changes, words):
    with pytest.raises(UserError, match=words):
        _ = written(tmp_path, **changes).cells


def test_a_study_that_is_not_there_names_those_that_are():
    with pytest.raises(UserError, match="found 'none'; allowed: .*answer, .*drift.*, or the path of a spec"):
        read_study("none")


def test_a_rule_that_is_not_there_is_named(tmp_path):
    with pytest.raises(UserError, match="rule: found 'none'; allowed: a study whose rule is .*/rules/none.py"):
        written(tmp_path, rule="none")


def test_what_the_rule_does_not_read_is_refused(tmp_path):
    with pytest.raises(UserError, match="small.json#/about: found .*; nothing, since the rule 'small' reads none"):
        written(tmp_path, about={"names": {}})
    with pytest.raises(UserError, match="small.json#/about/names: is missing"):
        written(tmp_path, rule="drift", about={})
    with pytest.raises(UserError, match=r"small.json#/about/names: found \[\]; {label: name} of the formulations"):
        written(tmp_path, rule="drift", about={"names": []})


def test_a_spec_without_axes_needs_a_rule_that_makes_cells(tmp_path, rule_of_small):
    without = {key: value for key, value in SPEC.items() if key not in ("axes", "seeds")}
    (tmp_path / "base.json").write_text(json.dumps(BASE))
    (tmp_path / "small.json").write_text(json.dumps(without))
    with pytest.raises(UserError, match="axes: found None; axes and seeds, since the rule makes no cells"):
        read_study(str(tmp_path / "small.json"))
    rule_of_small.cells = lambda study: [Case({"dt": f"{dt:g}"}, {"/time/dt_s": dt}, unknowns=9) for dt in (0.01, 0.02)]
    cells = read_study(str(tmp_path / "small.json")).cells
    assert [(cell.label, cell.base, cell.unknowns) for cell in cells] == [
        (dt, tmp_path / "base.json", 9) for dt in ("0.01", "0.02")
    ]


def test_what_values_depend_on_beside_the_run_makes_another_cell(tmp_path, rule_of_small):
    def key(**against):
        rule_of_small.cells = lambda study: [Case({"dt": "1"}, {"/time/dt_s": 0.01}, **against)]
        return written(tmp_path).cells[0].key

    assert key() == key(against={}) != key(against={"closed_form": "a"}) != key(against={"closed_form": "b"})


def test_cells_of_one_sweep_have_the_labels_alike_that_the_rule_names(tmp_path, rule_of_small):
    study = written(tmp_path)
    assert [len(part) for part in collect.parts(study, study.cells)] == [8]
    rule_of_small.ALIKE = ("level", "formulation")
    parts = list(collect.parts(study, study.cells))
    assert [[cell.label for cell in part] for part in parts][0] == ["strip a one 1", "strip a one 2"] and len(parts) == 4
