"""A study that has to be registered makes no row before it is, nor of a spec or rule that differs from it."""

import json
import sys
import types
from dataclasses import replace

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.kit.study import page, registration, store, verb
from barrierbench_analysis.studies.kit.study.spec import RULES, known, read_study

from small_study import row, written


@pytest.fixture
def rule(monkeypatch):
    """A rule whose code a test may change: name -> a module of this source."""

    def made(source="def rule(study, rows):\n    return {'n': len(rows)}\n", folder=None):
        module = types.ModuleType(f"{RULES}.small")
        file = folder / "small_rule.py"
        file.write_text(source)
        module.__file__ = str(file)
        exec(compile(source, str(file), "exec"), module.__dict__)
        monkeypatch.setitem(sys.modules, module.__name__, module)
        return module

    return made


def test_a_study_that_is_not_registered_makes_no_run(tmp_path, rule):
    rule(folder=tmp_path)
    study = written(tmp_path, registered=True)
    with pytest.raises(UserError, match=r"registered/small.json: found no registration; allowed: one before the first run"):
        registration.require(study)
    assert verb.main([str(study.file), "--minutes", "1"]) == 2
    assert not store.file_of(study).exists()


def test_a_study_without_the_key_needs_none(tmp_path, rule):
    rule(folder=tmp_path)
    registration.require(written(tmp_path))


def test_what_was_registered_may_run_and_what_was_changed_may_not(tmp_path, rule, monkeypatch):
    rule(folder=tmp_path)
    study = written(tmp_path, registered=True)
    assert verb.main([str(study.file), "--register", "before the first run"]) == 0
    registration.require(study)
    other = written(tmp_path, registered=True, set={"/threads": 1, "/time/steps": 3})
    with pytest.raises(UserError, match="found the spec .*allowed: .*registered on"):
        registration.require(other)
    registration.register(other, "three steps instead of two, since two end before contact")
    registration.require(other)
    assert [e.why for e in registration.entries(other)] == ["before the first run", "three steps instead of two, since two end before contact"]
    assert len(registration.sentences(other)) == 2


def test_a_change_of_the_rule_is_found_and_one_of_its_words_is_not(tmp_path, rule):
    rule(folder=tmp_path)
    study = written(tmp_path, registered=True)
    registration.register(study, "first")
    before = registration.now(study)
    rule('"""Words."""\n# more words\ndef rule(study, rows):\n    """And words."""\n    return {"n": len(rows)}\n', tmp_path)
    assert registration.now(written(tmp_path, registered=True)) == before
    rule("def rule(study, rows):\n    return {'n': 1 + len(rows)}\n", tmp_path)
    with pytest.raises(UserError, match="found the rule"):
        registration.require(written(tmp_path, registered=True))


def test_the_page_and_parts_of_a_spec_may_change(tmp_path, rule):
    rule(folder=tmp_path)
    registration.register(written(tmp_path, registered=True), "first")
    registration.require(written(tmp_path, registered=True, question="Does it still work?", parts={"a": {"level": ["a"]}}))


def test_the_same_is_not_registered_twice(tmp_path, rule):
    rule(folder=tmp_path)
    study = written(tmp_path, registered=True)
    registration.register(study, "first")
    with pytest.raises(UserError, match="found these hashes already"):
        registration.register(study, "again")


def test_a_row_of_another_registration_is_refused(tmp_path, rule):
    rule(folder=tmp_path)
    study = written(tmp_path, registered=True)
    registration.register(study, "first")
    made = {cell.key: row(cell) for cell in study.cells}
    store.write_rows(store.file_of(study), made)
    with pytest.raises(UserError, match="found a row of the registration 'none' .*allowed: "):
        page.rows_of(study)
    marked = {key: replace(one, origin=one.origin | registration.mark(study)) for key, one in made.items()}
    store.write_rows(store.file_of(study), marked)
    assert len(page.rows_of(study)) == len(made)
    assert len(page.rows_of(written(tmp_path))) == len(made)  # without the key all rows count


def test_a_page_of_a_changed_rule_is_refused(tmp_path, rule):
    rule(folder=tmp_path)
    study = written(tmp_path, registered=True)
    registration.register(study, "first")
    one = {cell.key: replace(row(cell), origin=row(cell).origin | registration.mark(study)) for cell in study.cells}
    store.write_rows(store.file_of(study), one)
    rule("def rule(study, rows):\n    return {'n': 1 + len(rows)}\n", tmp_path)
    with pytest.raises(UserError, match="found the rule"):
        page.numbers_of(written(tmp_path, registered=True))


def test_code_that_a_rule_uses_is_registered_too(tmp_path, rule):
    module = rule(folder=tmp_path)
    study = written(tmp_path, registered=True)
    before = registration.now(study)
    module.USES = (store,)
    assert registration.now(study)[1] != before[1] and registration.now(study)[0] == before[0]


def test_a_registration_of_another_form_is_refused(tmp_path, rule):
    rule(folder=tmp_path)
    study = written(tmp_path, registered=True)
    file = registration.file_of(study)
    file.parent.mkdir()
    for data, fault in (({"schema": "x"}, "schema: found 'x'"), ({"schema": registration.SCHEMA, "entries": [{"date": "d"}]}, "entries")):
        file.write_text(json.dumps(data))
        with pytest.raises(UserError, match=fault):
            registration.entries(study)


REGISTERED = [name for name in known() if read_study(name).data.get("registered")]


@pytest.mark.parametrize("name", REGISTERED)
def test_every_study_of_this_tree_that_asks_for_it_is_what_was_registered(name):
    assert {"at_size", "least_price"} <= {*REGISTERED}
    registration.require(read_study(name))


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (["--register", " "], "found an empty reason; allowed: a text"),
        (["--register", "why", "--plan"], "--register: found beside plan"),
        (["--register", "why", "--no-run"], "--register: found beside page"),
    ],
)
def test_a_registration_without_reason_or_beside_another_mode_is_refused(tmp_path, rule, capsys, options, text):
    rule(folder=tmp_path)
    study = written(tmp_path, registered=True)
    assert verb.main([str(study.file), *options]) == 2 and text in capsys.readouterr().err
    assert registration.entries(study) == [] and not store.file_of(study).exists()


def test_a_study_that_asks_for_none_is_not_registered(tmp_path, rule):
    rule(folder=tmp_path)
    with pytest.raises(UserError, match='registered: found none; allowed: "registered": true'):
        registration.register(written(tmp_path), "why")
