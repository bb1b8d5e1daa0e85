"""The study kit: cells of a spec, rows that are kept, the page of a rule."""

import importlib
import json
import shutil
from dataclasses import replace
from pathlib import Path
from datetime import datetime, timezone
from types import SimpleNamespace

import pytest

from barrierbench_analysis.io.cases import read_cases
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.studies.kit import alone
from barrierbench_analysis.studies.kit.study import collect, cost, page, store, verb
from barrierbench_analysis.studies.kit.study.spec import Case, Study, known, read_study

BASE = json.loads((ROOT / "configs/scenes/drape2d.json").read_text())
SPEC = {
    "schema": "barrierbench.study/1",
    "name": "small",
    "question": "Does it work?",
    "base": "base.json",
    "set": {"/threads": 1, "/time/steps": 2},
    "axes": [
        {
            "names": ["scene", "level"],
            "cases": [{"label": "strip a", "set": {}}, {"label": "strip b", "set": {"/time/dt_s": 0.005}}],
        },
        {
            "names": ["formulation"],
            "cases": [
                {"label": "one", "set": {"/formulation": "log"}},
                {"label": "two", "set": {"/formulation": "cubic"}},
            ],
        },
    ],
    "seeds": [1, 2],
    "metrics": {"newton": "newton", "steps": "/summary/steps"},
    "page": "results/SMALL.md",
}


RULE = SimpleNamespace(rule=lambda study, rows: {"number": len(rows)})


@pytest.fixture(autouse=True)
def rule_of_small(monkeypatch):
    """The rule of the studies here, which need no file in studies/rules; tests give it more functions."""
    real, rule = importlib.import_module, SimpleNamespace(**vars(RULE))
    monkeypatch.setattr(importlib, "import_module", lambda name: rule if name.endswith("rules.small") else real(name))
    return rule


def written(folder, **changes) -> Study:
    (folder / "base.json").write_text(json.dumps(BASE))
    (folder / "small.json").write_text(json.dumps({**SPEC, **changes}))
    return read_study(str(folder / "small.json"))


def row(cell, outcome="ok", **values) -> store.Row:
    origin = {"date": "2026-01-01", "machine": "m", "commit": "c", "build": "b"}
    return store.Row(
        cell.key, cell.place, outcome, {"newton": 3.0, "steps": 2.0, **values}, SPEC["metrics"], 12, 0.5, "r", origin
    )


# --- cells


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


# --- rows


def test_rows_that_are_added_change_no_other_row(tmp_path):
    cells, file = written(tmp_path).cells, tmp_path / "small.jsonl"
    rows = store.added({}, [row(cell, newton=float(k)) for k, cell in enumerate(cells[:3])])
    store.write_rows(file, rows)
    before = file.read_bytes()
    store.write_rows(file, store.added(store.read_rows(file), [row(cell) for cell in cells[3:]]))
    assert file.read_bytes().startswith(before) and len(store.read_rows(file)) == len(cells)
    assert [r.values["newton"] for r in store.read_rows(file).values()][:3] == [0.0, 1.0, 2.0]


def test_a_kept_row_is_not_written_over(tmp_path):
    cell = written(tmp_path).cells[0]
    kept = {cell.key: row(cell)}
    assert store.added(kept, [row(cell)]) == kept
    with pytest.raises(UserError, match="found a row with another values than the kept one"):
        store.added(kept, [row(cell, newton=4.0)])
    assert store.added(kept, [row(cell, newton=4.0)], replace=True)[cell.key].values["newton"] == 4.0


@pytest.mark.parametrize("bad", ["{", '{"key": "a"}', "[]", '["k", "ok"]'])
def test_a_line_that_is_no_row_is_named(tmp_path, bad):
    file = tmp_path / "small.jsonl"
    store.write_rows(file, {})
    file.write_text(file.read_text() + bad + "\n")
    with pytest.raises(UserError, match="small.jsonl: line 2: "):
        store.read_rows(file)


def test_a_key_that_is_there_twice_is_refused(tmp_path):
    file, cell = tmp_path / "small.jsonl", written(tmp_path).cells[0]
    store.write_rows(file, {cell.key: row(cell)})
    file.write_text(file.read_text() + file.read_text().splitlines()[2] + "\n")
    with pytest.raises(UserError, match="line 4: the key .* is there twice"):
        store.read_rows(file)


def test_a_number_that_is_not_finite_is_not_kept(tmp_path):
    with pytest.raises(ValueError, match="JSON"):
        store.write_rows(tmp_path / "small.jsonl", {"a": row(written(tmp_path).cells[0], newton=float("nan"))})


def test_a_row_without_a_metric_of_today_is_missing(tmp_path):
    study = written(tmp_path)
    rows = {cell.key: row(cell) for cell in study.cells}
    assert collect.missing(study, rows) == []
    first = study.cells[0].key
    rows[first] = replace(rows[first], sources={"newton": "newton"})
    assert [cell.key for cell in collect.missing(study, rows)] == [first]


def test_a_row_whose_metric_is_read_elsewhere_today_is_missing(tmp_path):
    study = written(tmp_path)
    rows = {cell.key: row(cell) for cell in study.cells}
    now = written(tmp_path, metrics={"newton": "/summary/newton_iterations", "steps": "/summary/steps"})
    assert collect.missing(study, rows) == [] and len(collect.missing(now, rows)) == len(study.cells)


def test_a_row_has_the_labels_of_today(tmp_path):
    study = written(tmp_path)
    store.write_rows(store.file_of(study), {cell.key: row(cell) for cell in study.cells})
    axes = json.loads(json.dumps(SPEC["axes"]).replace("strip b", "strip large"))
    assert {r.place["level"] for r in page.rows_of(written(tmp_path, axes=axes))} == {"a", "large"}


# --- pages


def test_a_page_of_a_part_of_the_cells_is_refused(tmp_path, monkeypatch):
    study = written(tmp_path)
    store.write_rows(store.file_of(study), {cell.key: row(cell) for cell in study.cells[1:]})
    with pytest.raises(UserError, match="1 cell of 8 without a row, the first 'strip a one 1'"):
        page.rows_of(study)


def test_a_page_of_a_rule_that_says_what_is_not_run_has_the_rows_there_are(tmp_path, rule_of_small):
    study = written(tmp_path)
    store.write_rows(store.file_of(study), {cell.key: row(cell) for cell in study.cells[1:]})
    rule_of_small.PARTIAL = True
    assert len(page.rows_of(study)) == 7
    store.write_rows(store.file_of(study), {})
    with pytest.raises(UserError, match="small.rows.jsonl: found no row"):
        page.write_page(study)


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


def test_values_that_the_rule_measures_are_missing_once_they_are_measured_otherwise(tmp_path, rule_of_small):
    study = written(tmp_path)
    rule_of_small.MEASURED = {"error": "distance to the closed form"}
    rule_of_small.measure = lambda study, cell, record: {"error": 0.5}
    record = {
        "labels": {},
        "summary": {"newton_iterations": 3, "steps": 2},
        "scene": {"free_dofs": 12},
        "ids": {"run_id": "r" * 40, "build_id": "b" * 40},
        "status": {
            "outcome": "ok",
            "valid": True,
            "started_utc": "2026-01-01T00:00:00Z",
            "ended_utc": "2026-01-01T00:00:01Z",
        },
        "machine": {"cpu_model": "m", "cores": 2},
        "provenance": {},
        "schema": {"version": "3.7.0"},
    }
    made = collect.row_of(study, study.cells[0], record)
    assert made.values == {"newton": 3, "steps": 2, "error": 0.5} and made.origin["version"]
    with pytest.raises(UserError, match="small.json: found 13 unknowns for 'strip a one 1'; allowed: 12, those of its run"):
        collect.row_of(study, replace(study.cells[0], unknowns=13), record)
    rows = {cell.key: replace(made, key=cell.key) for cell in study.cells}
    assert collect.missing(study, rows) == []
    rule_of_small.MEASURED = {"error": "distance to a refined run"}
    assert len(collect.missing(study, rows)) == len(study.cells)


def test_what_values_depend_on_beside_the_run_makes_another_cell(tmp_path, rule_of_small):
    def key(**against):
        rule_of_small.cells = lambda study: [Case({"dt": "1"}, {"/time/dt_s": 0.01}, **against)]
        return written(tmp_path).cells[0].key

    assert key() == key(against={}) != key(against={"closed_form": "a"}) != key(against={"closed_form": "b"})


@pytest.fixture
def decided(rule_of_small):
    """The first cell, once it has a row, decides how the three after it end."""
    rule_of_small.decided = lambda study, rows: (
        {cell.key: "stalled" for cell in study.cells[1:4]} if study.cells[0].key in rows else {}
    )


def test_cells_that_others_decide_are_not_run(tmp_path, decided):
    study = written(tmp_path)
    assert len(collect.missing(study, {})) == 8
    rows = {study.cells[0].key: row(study.cells[0])}
    assert collect.missing(study, rows) == study.cells[4:] and len(collect.missing(study, rows, every=True)) == 7
    assert cost.plan(study, rows, study.cells)[:2] == [
        "small: 8 cells, 1 with a row in small.rows.jsonl, 4 to run",
        "3 more cells need no run, since others decide the outcome",
    ]
    assert cost.plan(study, rows, study.cells, every=True)[0].endswith("7 to run")
    outdated = {key: replace(one, sources={}) for key, one in rows.items()}
    assert len(collect.missing(study, outdated)) == 8  # a row that has to be made again decides nothing


def test_a_page_counts_the_decided_cells_that_were_run_all_the_same(tmp_path, decided):
    study = written(tmp_path)
    rows = [row(study.cells[0]), row(study.cells[1], "stalled"), row(study.cells[2], "ok")]
    assert page.checks_of(study, rows) == {"left_out": 1, "run": 2, "held": 1}
    assert page.checks_of(study, rows[1:]) == {"left_out": 0, "run": 0, "held": 0}
    study.file.with_suffix(".md").write_text("{{ checks.held }} of {{ checks.run }}")
    assert page.text_of(study, rows, {}) == "1 of 2"


def test_a_spot_check_runs_a_seeded_sample_of_the_decided_cells(tmp_path, decided, monkeypatch, capsys):
    study, asked = written(tmp_path), []
    monkeypatch.setattr(
        verb, "run_cells", lambda study, cells, *_: asked.append(cells) or [row(cell, "stalled") for cell in cells]
    )

    def sample(most, seed, cells=study.cells):
        store.write_rows(store.file_of(study), {study.cells[0].key: row(study.cells[0])})
        asked.clear()
        return verb.spot_check(study, cells, most, seed), [cell.key for of in asked for cell in of]

    made, keys = sample(2, 1)
    assert made == 2 and set(keys) < {cell.key for cell in study.cells[1:4]} and sample(2, 1) == (made, keys)
    assert len({tuple(sample(2, seed)[1]) for seed in range(8)}) > 1
    assert sample(9, 1)[0] == 3 and sample(9, 1, study.cells[2:]) [0] == 2
    assert "spot check of 3 cells that others decide" in capsys.readouterr().err
    assert page.checks_of(study, page_rows(study)) == {"left_out": 1, "run": 2, "held": 2}


def page_rows(study):
    return list(collect.current(study, store.read_rows(store.file_of(study))).values())


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--plan", "--spot-check", "2"], "--spot-check: found beside plan, which runs nothing; allowed: with run"),
        (["--no-run", "--spot-check", "2"], "--spot-check: found beside page"),
        (["--no-run", "--again"], "--again: found beside page"),
        (["--plan", "--jobs", "2"], "--jobs: found beside plan"),
        (["--plan", "--no-run"], "--plan: found beside --no-run"),
        (["--spot-check", "-1"], "--spot-check"),
        (["--plugin", "none.so", "--out", "x"], "--plugin: found 'none.so', which is no file"),
        (["--plugin", __file__], "--plugin: found without --out"),
        (["--quick"], "--quick: found an option of before; allowed: --part quick"),
        (["--runs=there"], "--runs=there: found an option of before; allowed: --out DIR"),
    ],
)
def test_options_that_do_not_go_together_are_refused(tmp_path, words, text):
    with pytest.raises(UserError, match=text):
        verb.arguments([str(written(tmp_path).file), *words])


def test_cells_of_one_sweep_have_the_labels_alike_that_the_rule_names(tmp_path, rule_of_small):
    study = written(tmp_path)
    assert [len(part) for part in collect.parts(study, study.cells)] == [8]
    rule_of_small.ALIKE = ("level", "formulation")
    parts = list(collect.parts(study, study.cells))
    assert [[cell.label for cell in part] for part in parts][0] == ["strip a one 1", "strip a one 2"] and len(parts) == 4


def test_rows_that_another_call_adds_meanwhile_stay(tmp_path, monkeypatch):
    """The other call ends while the runs of this one are made."""
    study = written(tmp_path)

    def made(study, cells, jobs, again):
        if cells[0] is study.cells[0]:
            store.write_rows(store.file_of(study), {study.cells[1].key: row(study.cells[1], newton=9.0)})
        return [row(cell) for cell in cells]

    monkeypatch.setattr(verb, "run_cells", made)
    assert verb.make_rows(study, study.cells[:1]) == 1
    rows = store.read_rows(store.file_of(study))
    assert len(rows) == 2 and rows[study.cells[1].key].values["newton"] == 9.0


def test_what_takes_the_place_of_an_option_is_no_option_of_before():
    words = {word.split()[0] for word in verb.BEFORE.values() if word.startswith("--")}
    text = Path(verb.__file__).read_text()
    assert len(words) > 3 and all(f'"{word}"' in text for word in words) and not words & set(verb.BEFORE)


def test_a_run_that_was_cut_short_is_missing_under_a_higher_limit(tmp_path):
    study = written(tmp_path, run_s=1.0)
    rows = {cell.key: replace(row(cell, "timeout"), seconds=1.0) for cell in study.cells}
    assert collect.missing(study, rows) == [] and len(collect.missing(written(tmp_path, run_s=100.0), rows)) == 8


def test_a_pointer_may_name_a_key_with_a_slash():
    record = {"summary": {"cond": {"full/block_jacobi": {"log10_cond": {"p95": 3.0}}}}}
    assert collect._at(record, "/summary/cond/full~1block_jacobi/log10_cond/p95") == 3.0


def test_again_leaves_cells_that_others_decide(tmp_path, rule_of_small):
    study = written(tmp_path)
    rule_of_small.decided = lambda study, rows: {study.cells[1].key: "ok"}
    rows = {study.cells[0].key: row(study.cells[0])}
    wanted = collect.wanted(study, rows, again=True)
    assert study.cells[0] in wanted and study.cells[1] not in wanted and len(wanted) == 7
    assert study.cells[1] in collect.wanted(study, rows, every=True, again=True)


def test_a_call_that_judges_no_row_is_refused(tmp_path, rule_of_small):
    study = written(tmp_path)
    store.write_rows(store.file_of(study), {study.cells[0].key: row(study.cells[0])})
    study.file.with_suffix(".md").write_text("{{ number }}")
    rule_of_small.PARTIAL, rule_of_small.judged = True, lambda study, rows: ([], True)
    with pytest.raises(UserError, match="small.rows.jsonl: found no row of 4 cells of the call"):
        verb._main([str(study.file), "--no-run", "--only", "level=b"])
    assert verb._main([str(study.file), "--no-run"]) == 0


def test_a_call_of_some_cells_ends_well_without_a_page(tmp_path, monkeypatch, capsys):
    """Of a study whose page needs every cell."""
    study = written(tmp_path)
    monkeypatch.setattr(verb, "run_cells", lambda study, cells, jobs, again: [row(cell) for cell in cells])
    monkeypatch.setattr(verb, "built_program", lambda: None)
    assert verb._main([str(study.file), "--only", "level=a"]) == 0 and not study.page.exists()
    assert f"no page yet: 4 cells without a row; ./bench study {study.file} run goes on" in capsys.readouterr().out


# --- what a call may run, and what it is expected to take


def test_a_call_runs_the_cells_of_its_labels_alone(tmp_path):
    study = written(tmp_path, parts={"quick": {"level": ["a"], "formulation": ["one"]}})
    assert [cell.label for cell in verb.chosen(study, ["level=a", "seed=1"], None)] == [
        "strip a one 1",
        "strip a two 1",
    ]
    assert verb.chosen(study, ["level=a", "level=b"], None) == study.cells
    assert [cell.label for cell in verb.chosen(study, [], "quick")] == ["strip a one 1", "strip a one 2"]
    assert verb.chosen(study, [], None) == study.cells


@pytest.mark.parametrize(
    ("only", "part", "words"),
    [
        (["levels=a"], None, "--only levels: found 'levels'; allowed: scene, level, formulation, seed"),
        (["level=c"], None, "--only level: found 'c'; allowed: a, b"),
        (["level"], None, "--only: found 'level'; allowed: AXIS=LABEL"),
        ([], "slow", "--part: found 'slow'; allowed: quick"),
    ],
)
def test_a_part_that_no_cell_has_is_refused(tmp_path, only, part, words):
    study = written(tmp_path, parts={"quick": {"level": ["a"]}})
    with pytest.raises(UserError, match=words):
        verb.chosen(study, only, part)


def test_seconds_are_expected_from_the_nearest_rows(tmp_path):
    study = written(tmp_path)
    kept = [replace(row(cell), seconds=1.0 + k) for k, cell in enumerate(study.cells[:4])]  # of level a
    assert cost.expected(study.cells[0], kept, 2.0) == 1.0
    assert cost.expected(study.cells[4], kept, 2.0) is None  # level b stands in no row
    sized = replace(study.cells[4], unknowns=24)
    assert cost.expected(sized, kept, 2.0) == 4 * 1.0  # twice the unknowns of the row with one other label
    assert cost.growth(kept) == cost.GROWTH
    far = [replace(one, unknowns=n, seconds=0.01 * n**2.5) for one, n in zip(kept, (10, 20, 40, 80))]
    assert cost.growth(far) == pytest.approx(2.5)


def test_rows_and_page_of_a_call_with_a_folder_lie_in_it(tmp_path):
    study = written(tmp_path)
    there = read_study(str(study.file), tmp_path / "out")
    assert store.file_of(there) == tmp_path / "out/small.rows.jsonl" and there.page == tmp_path / "out/small.page.md"
    drift = read_study("drift", tmp_path)
    assert not drift.is_ours and drift.figures == tmp_path and drift.template == read_study("drift").template


def test_a_row_whose_seconds_were_not_kept_is_no_estimate(tmp_path):
    study = written(tmp_path)
    rows = {cell.key: replace(row(cell), seconds=None) for cell in study.cells[:4]}
    assert cost.plan(study, rows, study.cells)[1:] == [
        "4 runs without a kept row whose labels are alike: not estimated"
    ]
    rows[study.cells[0].key] = replace(rows[study.cells[0].key], seconds=2.0)
    assert cost.plan(study, rows, study.cells[4:])[1] == "4 runs without a kept row whose labels are alike: not estimated"


def test_a_call_whose_runs_do_not_pass_ends_with_1(tmp_path, rule_of_small, capsys):
    """The rule judges the cells of the call alone."""
    study = written(tmp_path)
    rows = [row(cell, "ok" if cell.place["level"] == "a" else "nan") for cell in study.cells]
    store.write_rows(store.file_of(study), {one.key: one for one in rows})
    study.file.with_suffix(".md").write_text("{{ number }}")
    call = [str(study.file), "--no-run"]
    assert verb.main(call) == 0
    rule_of_small.judged = lambda study, rows: ([f"{len(rows)} runs"], all(one.outcome == "ok" for one in rows))
    capsys.readouterr()
    assert verb.main(call) == 1 and capsys.readouterr().out.splitlines()[-1] == "8 runs"
    assert verb.main([*call, "--only", "level=a"]) == 0 and capsys.readouterr().out.splitlines()[-1] == "4 runs"


def test_a_template_that_asks_for_more_is_refused(tmp_path):
    study = written(tmp_path)
    rows = [row(cell) for cell in study.cells]
    study.file.with_suffix(".md").write_text("{{ question }} {{ number }}")
    assert page.text_of(study, rows, {"number": 4}) == "Does it work? 4"
    with pytest.raises(UserError, match="small.md: 'number' is undefined; allowed: .*question"):
        page.text_of(study, rows, {})


@pytest.mark.parametrize("name", known())
def test_the_page_of_a_study_is_that_of_its_kept_rows(name):
    study = read_study(name)
    rows = page.rows_of(study)
    whole = not getattr(study.module, "PARTIAL", False)
    assert 0 < len(rows) <= len(study.cells) and (len(rows) == len(study.cells) or not whole)
    assert study.page.read_text() == page.text_of(study, rows, study.module.rule(study, rows))


def test_a_study_in_a_folder_begins_with_no_row(tmp_path):
    study = written(tmp_path)
    store.write_rows(store.file_of(study), {cell.key: row(cell) for cell in study.cells})
    mine = read_study(str(study.file), tmp_path / "mine")
    assert store.read_rows(store.file_of(mine)) == {} and mine.page.parent == mine.figures == tmp_path / "mine"
    ours = read_study("drift", tmp_path)
    assert not ours.is_ours and ours.page == tmp_path / "drift.page.md" and ours.template == read_study("drift").template


# --- runs that leave no record, and rules that judge


def without_record(**more) -> dict:
    return alone.without_record("crash", "the program ended with -11: oh", datetime(2026, 1, 1, tzinfo=timezone.utc), **more)


def test_a_run_without_a_record_is_a_row_without_numbers(tmp_path, rule_of_small):
    study = written(tmp_path, metrics={**SPEC["metrics"], "detail": "/status/detail"})
    made = collect.row_of(study, study.cells[0], without_record())
    assert (made.outcome, made.unknowns, made.run) == ("crash", 0, "") and made.seconds > 0 and made.origin["date"] == "2026-01-01"
    assert made.values == {"newton": None, "steps": None, "detail": "the program ended with -11: oh"}
    rows = [made, *(replace(row(cell), values={**row(cell).values, "detail": ""}) for cell in study.cells[1:])]
    assert "8 runs of 12 unknowns were made on 2026-01-01 on m" in page.made_of(rows) and "1 run of " in page.made_of([made])
    assert cost.growth(rows) == cost.GROWTH
    store.write_rows(store.file_of(study), {one.key: replace(one, sources=made.sources) for one in rows})
    assert collect.missing(study, store.read_rows(store.file_of(study))) == []


def test_a_rule_may_run_its_cells_itself(tmp_path, rule_of_small):
    study = written(tmp_path)
    asked = []

    def run(of, cells, folder, jobs):
        asked.append((len(cells), folder, jobs))
        return [collect.row_of(of, cell, without_record()) for cell in cells]

    rule_of_small.run = run
    assert verb.make_rows(study, jobs=2) == 8 and asked == [(8, collect.RUNS / "small", 2)]
    assert {one.outcome for one in page.rows_of(study)} == {"crash"}
    assert verb.make_rows(read_study(str(study.file), tmp_path / "mine")) == 8 and asked[-1][1] == tmp_path / "mine" / "runs"


def test_a_rule_that_judges_gives_the_exit_code(tmp_path, rule_of_small, capsys):
    study = written(tmp_path)
    store.write_rows(store.file_of(study), {cell.key: row(cell, newton=float(k)) for k, cell in enumerate(study.cells)})
    study.file.with_suffix(".md").write_text("{{ number }}")
    assert verb.main([str(study.file), "--no-run"]) == 0
    rule_of_small.judged = lambda study, rows: ([f"{len(rows)} judged"], all(r.values["newton"] < 7 for r in rows))
    assert verb.main([str(study.file), "--no-run"]) == 1 and "8 judged" in capsys.readouterr().out
    assert verb.main([str(study.file), "--no-run", "--only", "seed=1"]) == 0 and "4 judged" in capsys.readouterr().out


# --- the whole of it


def test_a_study_runs_what_is_missing_and_nothing_twice(tmp_path, monkeypatch, program, capsys):
    study = written(tmp_path, seeds=[1])
    monkeypatch.setattr(collect, "RUNS", tmp_path / "runs")
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    assert cost.plan(study, store.read_rows(store.file_of(study)), study.cells) == [
        "small: 4 cells, 0 with a row in small.rows.jsonl, 4 to run",
        "4 runs without a kept row whose labels are alike: not estimated",
    ]
    assert verb.make_rows(study) == 4 and verb.make_rows(study) == 0
    rows = page.rows_of(study)
    assert {r.outcome for r in rows} == {"ok"} and all(r.values["steps"] == 2 and r.values["newton"] > 0 for r in rows)
    assert cost.plan(study, store.read_rows(store.file_of(study)), study.cells) == [
        "small: 4 cells, 4 with a row in small.rows.jsonl, 0 to run"
    ]
    more = written(tmp_path, axes=[SPEC["axes"][0], SPEC["axes"][1]])
    before = {r.key: r for r in rows}
    assert (
        cost.plan(more, store.read_rows(store.file_of(more)), more.cells)[0]
        == "small: 8 cells, 4 with a row in small.rows.jsonl, 4 to run"
        and len(cost.plan(more, store.read_rows(store.file_of(more)), more.cells)) == 2
    )
    assert verb.make_rows(more) == 4
    assert {r.key: r for r in page.rows_of(more) if r.key in before} == before
    traced = written(tmp_path, seeds=[1], metrics={**SPEC["metrics"], "bound": "bound_share"})  # a metric of the trace
    assert verb.make_rows(traced) == 4 and all(r.values["bound"] is not None for r in page.rows_of(traced))
    cell = study.cells[0]
    (folder,) = collect.folders(study, [cell]).values()
    assert json.loads((folder / "run.json").read_text())["ids"]["run_id"].startswith(before[cell.key].run)
    store.write_rows(store.file_of(study), {cell.key: row(cell)})
    assert verb.make_rows(study, [cell]) == 0 and verb.make_rows(study, [cell], again=True) == 1
    again = store.read_rows(store.file_of(study))[cell.key]
    assert again.values == before[cell.key].values and again.run == before[cell.key].run
    (alone,) = collect.folders(study, [cell]).values()
    assert alone != folder and len(read_cases(alone.parent)) == 1  # --again ran it as a sweep of its own
    first = (alone / "run.json").stat().st_mtime_ns
    store.write_rows(store.file_of(study), {})
    assert verb.make_rows(study, [cell]) == 1 and (alone / "run.json").stat().st_mtime_ns == first  # its record is read
    assert verb.make_rows(study, [cell], again=True) == 1 and (alone / "run.json").stat().st_mtime_ns > first
    for sweep in {path.parents[1] for path in (tmp_path / "runs").rglob("run.json")}:  # each by itself is whole
        assert len(read_cases(sweep)) == len(list(sweep.glob("*/run.json")))
    brief = written(tmp_path, seeds=[1], run_s=1e-9, set={"/threads": 1, "/time/steps": 4})
    assert collect.folders(brief, brief.cells) == {}
    assert verb.make_rows(brief, brief.cells[:1]) == 1
    assert store.read_rows(store.file_of(brief))[brief.cells[0].key].outcome == "timeout"
    longer = written(tmp_path, seeds=[1], run_s=100.0, set={"/threads": 1, "/time/steps": 4})
    assert verb.make_rows(longer, longer.cells[:1]) == 1  # the record of the run that was cut short is not read
    assert store.read_rows(store.file_of(longer))[longer.cells[0].key].outcome == "ok"
    longer = written(tmp_path, seeds=[1], set={"/threads": 1, "/time/steps": 3})  # the same labels, other runs
    assert verb.make_rows(longer) == 4 and {r.values["steps"] for r in page.rows_of(longer)} == {3}


def test_a_cell_is_measured_with_the_runs_that_it_needs(tmp_path, monkeypatch, program, rule_of_small):
    """The row of a needed cell may be there already, its run or not."""
    monkeypatch.setattr(collect, "RUNS", tmp_path / "runs")
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    rule_of_small.MEASURED = {"over": "Newton iterations over those of the log"}
    rule_of_small.needs = lambda study, cell: [other for other in study.cells[:1] if cell is not other]
    rule_of_small.measure = lambda study, cell, record, *others: {
        "over": record["summary"]["newton_iterations"] / others[0]["summary"]["newton_iterations"] if others else 1.0
    }
    study = written(tmp_path, seeds=[1], axes=SPEC["axes"][1:])
    assert verb.make_rows(study, study.cells[:1]) == 1
    first, = store.read_rows(store.file_of(study)).values()
    for left in (True, False):
        store.write_rows(store.file_of(study), {first.key: first})
        if not left:
            shutil.rmtree(tmp_path / "runs")
        assert verb.make_rows(study) == 1
        log, cubic = page.rows_of(study)
        assert log == first and cubic.values["over"] == pytest.approx(cubic.values["newton"] / log.values["newton"])
