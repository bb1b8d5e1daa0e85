"""The study kit: rows that are kept, what is missing, what others decide, and what the rest takes."""

import json
from dataclasses import replace

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.kit.study import collect, cost, page, store

from small_study import SPEC, row, without_record, written

pytestmark = pytest.mark.usefixtures("rule_of_small")


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


def test_a_row_whose_seconds_were_not_kept_is_no_estimate(tmp_path):
    study = written(tmp_path)
    rows = {cell.key: replace(row(cell), seconds=None) for cell in study.cells[:4]}
    assert cost.plan(study, rows, study.cells)[1:] == [
        "4 runs without a kept row whose labels are alike: not estimated"
    ]
    rows[study.cells[0].key] = replace(rows[study.cells[0].key], seconds=2.0)
    assert cost.plan(study, rows, study.cells[4:])[1] == "4 runs without a kept row whose labels are alike: not estimated"


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
