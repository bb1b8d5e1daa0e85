"""The verb from end to end: its quick cases, and what a refusal, a hang, a crash and an outcome that was not expected become."""

import json

import pytest

from barrierbench_analysis.studies.stress.verb import main
from barrierbench_analysis.studies.stress.entry import read_test
from barrierbench_analysis.studies.stress.run import run_case, run_test


@pytest.fixture
def built(program, monkeypatch):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)


def test_the_quick_cases_end_as_expected(built, tmp_path, capsys):
    code = main(["--quick", "--runs", str(tmp_path)])
    told = capsys.readouterr().out
    assert code == 0, told
    assert told.count("as expected") >= 20 and len(list(tmp_path.rglob("run.json"))) >= 60


def test_another_outcome_than_expected_ends_with_1(built, tmp_path, monkeypatch, capsys):
    from barrierbench_analysis.studies.stress import verb
    def other(name, **more):
        test = read_test(name, **more)
        test.data["expect"][0]["outcomes"] = ["stall_overload"]
        return test
    monkeypatch.setattr(verb, "read_test", other)
    assert main(["M09", "--quick", "--runs", str(tmp_path)]) == 1
    assert "log, d_hat: ok, expected stall_overload" in capsys.readouterr().out


def one(name, tmp_path, limit=60.0):
    test = read_test(name)
    return run_case(test, test.formulations[0], test.cases[0], tmp_path, limit)


def test_a_record_that_is_there_is_not_made_again(built, tmp_path):
    first = one("M09", tmp_path)
    time = next(tmp_path.rglob("run.json")).stat().st_mtime_ns
    assert one("M09", tmp_path) == first and next(tmp_path.rglob("run.json")).stat().st_mtime_ns == time


def test_a_refusal_is_one(built, tmp_path):
    row = one("M17", tmp_path)
    assert row.outcome == "refused" and "zero area" in row.detail and "spec.json" not in row.detail


def test_a_hang_and_a_crash_are_told(tmp_path, monkeypatch):
    fake = tmp_path / "fake"
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", str(fake))
    for body, outcome in (("exec sleep 20", "timeout"), ("echo oh >&2; kill -SEGV $$", "crash"), ("exit 0", "crash"), ("exit 70", "crash")):
        fake.write_text(f"#!/bin/sh\n{body}\n")
        fake.chmod(0o755)
        assert one("M09", tmp_path, 0.5).outcome == outcome


def test_a_run_has_its_own_time_whatever_the_others_took(tmp_path, monkeypatch):
    """The first two burn their time; a third is refused at once, as it is when the first two are not run at all."""
    fake, test = tmp_path / "fake", read_test("M09")
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", str(fake))
    fake.write_text('#!/bin/sh\ncase "$2" in *ulp_more*) exit 2;; esac\nwhile :; do :; done\n')
    fake.chmod(0o755)
    all_of_them = run_test(test, tmp_path, {}, ["log"], limit_s=1.0)
    assert [row.outcome for row in all_of_them] == ["timeout", "timeout", "refused"], all_of_them
    assert "1 s of processor time" in all_of_them[0].detail
    assert run_test(test, tmp_path, {}, ["log"], ["one ulp more"], limit_s=1.0) == all_of_them[2:]


def test_a_record_of_another_config_does_not_stand_in(built, tmp_path):
    test = read_test("M10")
    case = test.cases[0]
    first = run_case(test, test.formulations[0], case, tmp_path, 60.0)
    case.set["/scene/mass_kg"] = 1.0
    assert run_case(test, test.formulations[0], case, tmp_path, 60.0).run != first.run
    case.set["/scene/mass_kg"] = json.loads((test.path).read_text())["axes"][0]["cases"][0]["set"]["/scene/mass_kg"]
    assert run_case(test, test.formulations[0], case, tmp_path, 60.0).run == first.run
