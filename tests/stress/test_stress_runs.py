"""The study from end to end: its quick part, and what a refusal, a hang, a crash and an outcome that was not expected become."""

import json
from dataclasses import replace

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.kit import alone
from barrierbench_analysis.studies.kit.study import collect, page, store, verb
from barrierbench_analysis.studies.kit.study.spec import FOLDER, Study, read_study

SPEC = str(FOLDER / "stress.json")


@pytest.fixture
def built(program, monkeypatch):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)


def cells(test, formulation="log", study=None):
    return [cell for cell in (study or read_study("stress")).cells if (cell.place["test"], cell.place["formulation"]) == (test, formulation)]


def run(place, number=0, limit=60.0, folder=None):
    """The row of one cell of a test."""
    study = read_study("stress")
    return collect.run_each(study, [cells(place, study=study)[number]], folder, 1, limit)[0]


def test_the_quick_part_ends_as_expected(built, tmp_path, capsys):
    code = verb.main([SPEC, "--part", "quick", "--out", str(tmp_path), "--jobs", "2"])
    out = capsys.readouterr().out
    assert code == 0 and "everything is as expected" in out, out
    assert len(list(tmp_path.rglob("run.json"))) >= 60
    text = (tmp_path / "stress.page.md").read_text()
    assert "not made, and no sentence or table is of them" in text and "| M16 | log_squared | float | 30 |" in text


def test_another_outcome_than_expected_ends_with_1(built, tmp_path, monkeypatch, capsys):
    from barrierbench_analysis.studies.rules import stress

    def other(name, *more):
        test = stress.entry.read_test(name, *more)
        test.data["expect"][0]["outcomes"] = ["stall_overload"]
        return test

    monkeypatch.setattr(stress, "ids", lambda folder: ["M09"])
    monkeypatch.setattr(stress, "read_test", other)
    assert verb.main([SPEC, "--only", "case=d_hat", "--only", "formulation=log", "--out", str(tmp_path)]) == 1
    assert "M09 log, d_hat: ok, expected stall_overload" in capsys.readouterr().out


def test_a_record_that_is_there_is_not_made_again(built, tmp_path):
    first = run("M09", folder=tmp_path)
    time = next(tmp_path.rglob("run.json")).stat().st_mtime_ns
    assert run("M09", folder=tmp_path) == first and next(tmp_path.rglob("run.json")).stat().st_mtime_ns == time


def test_a_refusal_is_one(built, tmp_path):
    row = run("M17", folder=tmp_path)
    assert row.outcome == "refused" and "zero area" in row.values["detail"] and "spec.json" not in row.values["detail"]
    assert row.unknowns == 0 and row.run == "" and {value for name, value in row.values.items() if name != "detail"} == {None}


@pytest.mark.parametrize(
    "body, outcome, detail",
    [
        ("exec sleep 20", "timeout", "not over after 2 s"),
        ("echo oh >&2; kill -SEGV $$", "crash", "the program ended with -11: oh"),
        ("exit 0", "crash", "run.json"),
        ("exit 70", "crash", "the program ended with 70: "),
    ],
)
def test_a_hang_and_a_crash_are_outcomes(tmp_path, monkeypatch, body, outcome, detail):
    fake = tmp_path / "fake"
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", str(fake))
    fake.write_text(f"#!/bin/sh\n{body}\n")
    fake.chmod(0o755)
    row = run("M09", folder=tmp_path, limit=0.5)
    assert (row.outcome, row.unknowns) == (outcome, 0) and detail in row.values["detail"]


def test_a_fault_of_the_machine_is_no_outcome(tmp_path, monkeypatch):
    fake = tmp_path / "fake"
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", str(fake))
    fake.write_text("#!/bin/sh\necho no space left >&2\nexit 75\n")
    fake.chmod(0o755)
    with pytest.raises(UserError, match="no space left") as found:
        run("M09", folder=tmp_path)
    assert found.value.code == 75


def test_a_run_has_its_own_time_whatever_the_others_took(tmp_path, monkeypatch):
    """The first two burn their time; a third is refused at once, as it is when the first two are not run at all."""
    fake, study = tmp_path / "fake", read_study("stress")
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", str(fake))
    of = cells("M09", study=study)
    fake.write_text(f'#!/bin/sh\ncase "$2" in *{of[2].key[:10]}*) exit 2;; esac\nwhile :; do :; done\n')
    fake.chmod(0o755)
    rows = collect.run_each(study, of, tmp_path, 1, 1.0)
    assert [row.outcome for row in rows] == ["timeout", "timeout", "refused"], rows
    assert rows[0].values["detail"] in ("not over after 1 s of processor time", "not over after 4 s")  # a busy machine
    (alone_,) = collect.run_each(study, of[2:], tmp_path, 1, 1.0)
    assert alone_.outcome == "refused"


def test_a_record_of_another_config_does_not_stand_in(built, tmp_path):
    """Two configs in one folder, as an earlier program leaves them where it settles a default otherwise."""
    study = read_study("stress")
    cell = cells("M10", study=study)[0]
    other = replace(cell, settings={**cell.settings, "/scene/mass_kg": 1.0})
    made = [alone.run(collect.sweep_of(study, [one]), tmp_path, 60.0)["ids"]["run_id"] for one in (cell, other, cell)]
    assert made[0] == made[2] != made[1]


def test_rows_without_a_record_are_kept_and_the_page_is_of_them(tmp_path, monkeypatch):
    study = read_study("stress", tmp_path)
    of = cells("M17", study=study)
    record = alone.without_record("crash", "the program ended with -11: oh", alone.datetime.now(alone.timezone.utc))
    rows = [collect.row_of(study, cell, record) for cell in of]
    store.write_rows(store.file_of(study), {row.key: row for row in rows})
    assert page.rows_of(study) == rows
    text = page.write_page(study).read_text()
    assert "| M17 | log | - | crash | refused | the program ended with -11: oh |" in text and "0 of 1 runs ended as" in text
    lines, passed = study.module.judged(study, rows)
    assert not passed and lines == ["M17 log, -: crash, expected refused: the program ended with -11: oh"]


def test_the_larger_sizes_lie_beside_their_spec_or_in_a_folder(tmp_path):
    full = FOLDER.parent / "stress" / "stress_full.json"
    study = Study(full, json.loads(full.read_text()), tmp_path)
    assert study.page == tmp_path / "stress_full.page.md" and store.file_of(study) == tmp_path / "stress_full.rows.jsonl"
    assert study.template == FOLDER / "stress.md"
