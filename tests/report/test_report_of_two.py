"""The page of two folders: pairs of one config, what differs in outcome, physics and cost, what only one has."""

import json
import shutil

import pytest

from barrierbench_analysis.pages.report import diff_page, verb
from barrierbench_analysis.pages.report.diff import changes, diff_of
from barrierbench_analysis.pages.report.gather import gathered
from report_runs import changed, conditions

A_B = {"ids": {"build_id": "b" * 64}}


@pytest.fixture
def both(runs):
    """Two folders that are the same."""
    for folder in runs.iterdir():
        changed(folder, summary={"state_hash": "e" * 64}, **A_B)
    other = runs.with_name("other")
    shutil.copytree(runs, other)
    return runs, other


def diff(both):
    return diff_of(*map(gathered, both))


def texts(found) -> str:
    return "\n".join(one.text for one in diff_page.verdict(found))


def test_the_same_records_differ_in_nothing(both):
    found = diff(both)
    assert len(found.pairs) == 4 and found.only_a == found.only_b == []
    assert all(pair.findings and pair.values for pair in found.pairs)  # something was compared
    assert texts(found).splitlines()[:3] == [
        "Nothing regressed in 4 pairs of one config each.", "Every run ends with the outcome that it had.",
        "4 of 4 final states of one build are equal bit for bit."]
    assert all(change.same == change.pairs for change in changes(found))
    assert any(pair.as_before for pair in found.pairs)  # records that break an invariant on both sides


def test_a_dearer_run_and_another_gap_regress_each_by_its_kind(both):
    changed(both[1] / "cubic", summary={"newton_iterations": 60, "gap_min_rel": {"n": 1, "min": 0.05, "p05": 1, "median": 1, "p95": 1, "max": 1, "sum": 1}})
    lines = (both[1] / "cubic/trace.jsonl").read_text()
    (both[1] / "cubic/trace.jsonl").write_text(lines)
    found = diff(both)
    table, left = diff_page.regressed(found)
    rows = {row[2].text: row[1].text for row in table.rows}
    assert left == 0 and rows["newton_iterations"] == "cost" and rows["gap_min"] == "physics"
    assert texts(found).startswith("In 1 of 4 pairs something regressed.")
    change = next(one for one in changes(found) if one.metric == "newton_iterations")
    assert (change.pairs, change.same, change.higher, change.lower) == (4, 3, 1, 0)
    assert change.factor == pytest.approx(10**0.25) and change.farthest.new.run == "cubic" and change.farthest_factor == 10


def test_a_cheaper_run_is_no_regression_and_its_factor_is_said(both):
    changed(both[1] / "cubic", summary={"cond": conditions(25.0)})
    found = diff(both)
    assert texts(found).startswith("Nothing regressed") and "log10_cond full/none" in texts(found)
    change = next(one for one in changes(found) if one.metric == "log10_cond full/none median")
    assert change.farthest_factor == pytest.approx(0.1) and change.lower == 1


def test_outcomes_that_differ_are_counted(both):
    changed(both[1] / "quadratic", status={"outcome": "ok", "valid": True, "detail": ""})
    changed(both[1] / "cubic", status={"outcome": "penetration", "valid": False})
    said = diff_page.verdict(diff(both))[1]
    assert said.text == "Outcomes differ: ok to penetration (1) and newton_stall to ok (1)." and said.tone == diff_page.BAD


def test_other_bits_of_one_build_regress_and_of_another_build_are_not_asked_for(both):
    changed(both[1] / "cubic", summary={"state_hash": "f" * 64})
    assert "3 of 4 final states of one build are equal bit for bit." in texts(diff(both))
    for folder in both[1].iterdir():
        changed(folder, ids={"build_id": "a" * 64})
    found = diff(both)
    assert "equal bits are not asked for" in texts(found)
    assert any("The build of the two folders" in text for text in diff_page.limits(found))


def test_what_only_one_side_has_is_listed(both):
    shutil.rmtree(both[1] / "cubic")
    changed(both[1] / "log", ids={"config_id": "9" * 64})
    found = diff(both)
    assert sorted(entry.run for entry in found.only_a) == ["cubic", "log"] and [entry.run for entry in found.only_b] == ["log"]
    assert "2 runs are only in runs." in texts(found) and "1 run is only in other." in texts(found)
    assert len(diff_page.lonely(found, both[1] / "a.html").rows) == 3


def test_a_trace_that_is_not_the_records_is_named_and_judged_by_nothing(both):
    (both[1] / "cubic/trace.jsonl").write_text("{}\n")
    found = diff(both)
    assert texts(found).startswith("Nothing regressed where it could be judged; 1 of 4 pairs could not.")
    table, _ = diff_page.regressed(found)
    assert [row[1].text for row in table.rows] == ["not compared"] and "sha256" in table.rows[0][6].text


def test_folders_without_a_common_config_are_refused(both, capsys):
    for folder in both[1].iterdir():
        record = json.loads((folder / "run.json").read_text())
        changed(folder, ids={"config_id": record["ids"]["config_id"][::-1]})
    assert verb.main([str(both[0]), str(both[1])]) == 2
    assert "have no config in common (4 and 4 records); allowed: folders with runs of the same config_id" in capsys.readouterr().err
    assert not list(both[1].glob("*.html"))


def test_the_page_stands_in_the_second_folder(both, capsys):
    assert verb.main([str(both[0]), str(both[1])]) == 0
    page = both[1] / "report_against_runs.html"
    assert f"{page} (" in capsys.readouterr().out
    text = page.read_text()
    assert "other against runs" in text and text.count("<h1>") == 1 and "default-src 'none'" in text
