"""Numbers made of fields that mean something else in the other version are compared with nothing: made-up records, no program."""

import json
from pathlib import Path

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.gate import accept, baseline, calibrate, compare, gate, meanings
from barrierbench_analysis.studies.gate.finding import failures
from barrierbench_analysis.studies.gate.records import Run
from barrierbench_analysis.io.record_file import CHANGED


def run(version: str, number: int, iterations: int = 20, last: str = "bound") -> Run:
    """Of ten estimates of the error so many are numbers; in the old version all of them are."""
    trace = [{"error_estimate_m": 1e-9} if k < number else {"error_estimate_m": None, "error_estimate_m_status": last} for k in range(10)]
    record = {"schema": {"name": "barrierbench.run", "version": version}, "config": {"x": 1}, "scene": {"free_dofs": 3}, "status": {"outcome": "ok", "valid": True},
              "summary": {"newton_iterations": iterations, "factorizations": 30}, "steps": [{"status": "converged"}], "ids": {}}
    return Run(Path("made/run.json"), record, trace, 0, True)


def kept_of(version: str, tmp_path, **more) -> baseline.Baseline:
    made = calibrate.propose("made", [run(version, 10)], "a reason")
    made.calibrated_at |= more
    baseline.write(made, tmp_path / "made.json")
    return baseline.read(tmp_path / "made.json")


@pytest.fixture(autouse=True)
def only_numbers(monkeypatch):
    """Invariants have subjects of their own."""
    for module in (calibrate, compare, gate):
        monkeypatch.setattr(module.invariants, "judge", lambda *_, **__: [])


def said(findings):
    return {f.metric: f.verdict for f in findings}


def test_every_field_that_changed_its_meaning_says_what_is_made_of_it():
    assert set(meanings.FAMILIES) | meanings.OF_NO_NUMBER == set(CHANGED) and not meanings.OF_NO_NUMBER & meanings.FAMILIES.keys()


def test_a_baseline_says_of_which_record_version_it_is(tmp_path):
    assert kept_of("3.4.0", tmp_path).record_version == "3.4.0" and json.loads((tmp_path / "made.json").read_text())["calibrated_at"]["record_version"] == "3.4.0"
    with pytest.raises(UserError, match="records of versions 3.4.0, 3.5.0: a baseline is of records of one version"):
        calibrate.propose("made", [run("3.4.0", 10), run("3.5.0", 10)])


@pytest.mark.parametrize("old, new, judged", [("3.5.0", "3.5.0", True), ("3.4.0", "3.5.0", False), ("3.5.0", "3.4.0", False), ("3.4.0", "3.4.0", True)])
def test_a_gate_compares_no_family_of_another_meaning(tmp_path, old, new, judged):
    """Half of the estimates have turned to another word, which within one version is red."""
    kept = kept_of(old, tmp_path)
    found = gate.numbers("made", kept, run(new, 5), True)
    assert said(found)["newton_iterations"] == "pass" and bool(failures(found)) == judged
    if judged:
        assert said(found)["error_estimate: number"] == "FAIL" and "error_estimate" not in said(found)
    else:
        assert said(found)["error_estimate"] == "not_judged" and not [name for name in said(found) if name.startswith("error_estimate: ")]
        line = next(f for f in found if f.metric == "error_estimate")
        assert line.judged == 0 and line.note == f"made of trace error_estimate_m, which means different things in {old} and {new}"
    worse = gate.numbers("made", kept, run(new, 10, iterations=90), True)
    assert said(worse)["newton_iterations"] == "FAIL"  # what means the same is judged


def test_two_records_compare_no_family_of_another_meaning():
    assert said(compare.compare("made", run("3.5.0", 10), run("3.5.0", 5)))["error_estimate: number"] == "FAIL"
    found = said(compare.compare("made", run("3.4.0", 10), run("3.5.0", 5, last="a new word")))
    assert found["error_estimate"] == found["meanings"] == "not_judged" and not [name for name in found if name.startswith("error_estimate: ")]


def test_a_baseline_without_a_version_is_taken_for_this_one_and_that_is_said(tmp_path):
    kept = kept_of(meanings.PRESENT, tmp_path)
    del kept.calibrated_at["record_version"]
    assert said(gate.numbers("made", kept, run(meanings.PRESENT, 5), True))["error_estimate: number"] == "FAIL"
    [line] = meanings.without_version("made", kept.record_version)
    assert line.verdict == "not_judged" and f"does not say of which record version it is: taken as {meanings.PRESENT}" in line.note
    assert meanings.without_version("made", meanings.PRESENT) == []


def test_accepting_over_an_older_version(tmp_path):
    """What means something else starts anew; a part of the metrics cannot be taken over."""
    path = tmp_path / "kept.json"
    accept.keep(calibrate.propose("made", [run("3.4.0", 10)]), path, "old", [])
    new = calibrate.propose("made", [run("3.5.0", 10)])
    with pytest.raises(UserError, match="of record version 3.4.0, in which trace error_estimate_m mean something else"):
        accept.keep(new, path, "a part", ["newton_iterations"])
    accept.keep(new, path, "all", [])
    found = baseline.read(path)
    assert found.record_version == "3.5.0" and found.metrics["newton_iterations"].first.reason == "old" and found.metrics["error_estimate: number"].first is None
