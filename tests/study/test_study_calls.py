"""The study kit: calls that run, plan, judge and write pages."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from barrierbench_analysis.io.cases import read_cases
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.kit.study import collect, cost, page, store, verb
from barrierbench_analysis.studies.kit.study.spec import Case, known, read_study

from small_study import SPEC, row, without_record, written

pytestmark = pytest.mark.usefixtures("rule_of_small")


def page_rows(study):
    return list(collect.current(study, store.read_rows(store.file_of(study))).values())


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


def test_rows_and_page_of_a_call_with_a_folder_lie_in_it(tmp_path):
    study = written(tmp_path)
    there = read_study(str(study.file), tmp_path / "out")
    assert store.file_of(there) == tmp_path / "out/small.rows.jsonl" and there.page == tmp_path / "out/small.page.md"
    drift = read_study("drift", tmp_path)
    assert not drift.is_ours and drift.figures == tmp_path and drift.template == read_study("drift").template


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


def test_a_call_goes_on_with_the_cells_that_its_rows_bring(tmp_path, monkeypatch, rule_of_small, capsys):
    """Each level has its runs once those of the level before are kept; a plan says what the rule adds."""
    study = written(tmp_path, metrics={"newton": "newton"})
    study.file.with_suffix(".md").write_text("{{ number }}")

    def cells(of):
        there = len(store.read_rows(store.file_of(of)))
        for k in range(min(there + 1, 4)):
            yield Case({"level": str(k)}, {"/time/steps": k + 1})

    def made(of, cells, *_):
        return [replace(row(cell), values={"newton": 3.0}, sources=of.data["metrics"]) for cell in cells]

    rule_of_small.cells, rule_of_small.PARTIAL = cells, True
    rule_of_small.planned = lambda of, rows: [f"{4 - len(rows)} levels left"]
    monkeypatch.setattr(verb, "run_cells", made)
    monkeypatch.setattr(verb, "built_program", lambda: None)
    assert verb._main([str(study.file)]) == 0 and study.page.read_text() == "1"  # one round without GROWS
    rule_of_small.GROWS = True
    assert verb._main([str(study.file), "--minutes", "1e-9"]) == 0 and study.page.read_text() == "1"
    assert verb._main([str(study.file)]) == 0 and study.page.read_text() == "4"
    assert verb._main([str(study.file), "--again"]) == 0  # chosen rows once, and not for ever
    capsys.readouterr()
    assert verb._main([str(study.file), "--plan"]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "0 levels left"


@pytest.mark.parametrize("name", known())
def test_the_page_of_a_study_is_that_of_its_kept_rows(name):
    """One that has made no run has no page."""
    study = read_study(name)
    if not store.file_of(study).is_file():
        assert not study.page.is_file()
        return
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
