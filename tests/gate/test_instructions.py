"""Instructions counted by callgrind: nearly the same twice, judged on the machine of the baseline alone."""

import json
import shutil

import pytest

from barrierbench_analysis.studies.gate import baseline, cases, instructions
from barrierbench_analysis.studies.gate.baseline import Baseline

CASE = "block-log"


@pytest.fixture
def short(monkeypatch, program, build_folder):
    """The case of the set with fewer steps, so that a count takes a second."""
    if shutil.which("valgrind") is None:
        pytest.skip("no valgrind")
    if build_folder.name == "sanitize":
        pytest.skip("valgrind does not run a program with sanitizers")
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    case = next(case for case in cases.read_set("small") if case.name == CASE)
    case = cases.Case(case.name, case.config, {**case.set, "/time/steps": 2}, instructions=True)
    monkeypatch.setattr(instructions, "read_set", lambda name: [case])
    return case


def test_a_count_repeats_and_is_judged_where_it_was_made(short, tmp_path):
    first, made_by = instructions.count(short)
    path = tmp_path / f"{CASE}.json"
    kept = {"instructions": instructions.instructions_of(short)}
    assert first > 1e7 and kept["instructions"].envelope.value == pytest.approx(first, rel=1e-3)
    baseline.write(Baseline(CASE, "run", "test", {}, kept, made_by=made_by), path)

    def verdicts() -> list[tuple]:
        return [(f.verdict, f.note) for f in instructions.judge_instructions("small", tmp_path, [])]

    assert verdicts() == [("pass", "")]
    data = json.loads(path.read_text())
    for key in ("value", "lower", "upper"):
        data["metrics"]["instructions"][key] *= 0.9
    path.write_text(json.dumps(data))
    assert verdicts() == [("FAIL", "")]
    data["made_by"]["cpu_model"] = "another processor"
    path.write_text(json.dumps(data))
    assert verdicts() == [("not_judged", "the baseline is of another processor or compiler")]


def test_without_valgrind_nothing_is_counted(short, monkeypatch):
    monkeypatch.setattr(instructions.shutil, "which", lambda name: None)
    assert instructions.count(short) is None and instructions.instructions_of(short) is None
