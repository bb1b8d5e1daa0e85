"""The committed baselines against the program that was built. Also the judge of the mutants of tests/mutation/gate.toml."""

import re
import subprocess

from barrierbench_analysis.studies.gate import baseline, build_checks, cases


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


def test_every_stiffness_policy_is_in_the_set(program):
    """A policy that the program has and no case runs would be judged by nothing, of contacts and of the strain limit."""
    text = subprocess.run([program, "list", "policies"], capture_output=True, text=True, check=True).stdout
    contacts, limits = (set(re.findall(r"^  (\w+) ", part, re.MULTILINE)) for part in text.split("policies of the limit"))
    configs = [baseline.read(baseline.FOLDER / f"{case.name}.json", case.name).config for case in cases.read_set("small")]
    assert len(contacts) >= 3 and {c["formulation"]["stiffness_policy"]["name"] for c in configs} >= contacts
    assert len(limits) >= 2 and {c["strain_limit"]["stiffness_policy"]["name"] for c in configs if c["strain_limit"]["enabled"]} >= limits
    ways = {(p.get("refresh"), p.get("derivative")) for c in configs for p in [c["formulation"]["stiffness_policy"]]}
    assert ways >= {("per_iteration", "dropped"), ("per_step", "dropped"), ("per_step", "included")}
