"""The committed baselines against the program that was built. Also the judge of the mutants of tests/mutation/gate.toml."""

from analysis.gate import build_checks


def test_cases_of_the_small_set_are_green(gate, answer):
    """A case of every scene, and both formulations of the block; `bench gate` runs all."""
    assert gate("gate", "--case", "block", "--case", "strip-cubic", "--case", "sphere-log", "--case", "drape-log") == 0
    body = answer()
    assert body["green"] and body["failed"] == 0
    assert all(body["judged"][c] >= 4 for c in ("I", "II", "III", "IV")), body["judged"]
    assert {f["case"] for f in body["findings"]} >= {"block-log", "block-cubic", "strip-cubic", "sphere-log", "drape-log"}


def test_the_validity_block_of_the_program_is_judged(gate, answer):
    gate("gate", "--case", "block-log")
    lines = [f for f in answer()["findings"] if f["case"] == "build"]
    assert len(lines) >= 12 and all(f["class"] == "I" and f["verdict"] == "pass" and f["judged"] > 0 for f in lines)
    assert {"ccd", "repetition", "condition_estimators"} <= {f["metric"] for f in lines}


def test_a_check_that_judged_nothing_or_failed_is_red():
    check = {"name": "ccd", "pass": True, "subjects": 9, "value": 0, "bound": 0, "detail": ""}
    verdicts = [build_checks.findings_of({"checks": [{**check, **change}]})[0].verdict for change in ({}, {"pass": False}, {"subjects": 0})]
    assert verdicts == ["pass", "FAIL", "FAIL"]
