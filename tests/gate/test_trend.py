"""Steps in made histories, and the history that a gate leaves."""

import json
import random

import pytest

from barrierbench_analysis.studies.gate import trend
from barrierbench_analysis.studies.gate.finding import Finding


def noisy(levels, seed=3, noise=0.01):
    numbers = random.Random(seed)
    return [level * (1 + numbers.uniform(-noise, noise)) for level, count in levels for _ in range(count)]


def test_one_step_is_found_where_it_is():
    values = noisy([(10.0, 8), (12.0, 6)])
    index, before, after = trend.last_step(values)
    assert index == 8 and before == pytest.approx(10, rel=0.01) and after == pytest.approx(12, rel=0.01)


def test_of_two_steps_the_last_is_told():
    assert trend.pieces(noisy([(10.0, 6), (12.0, 6), (9.0, 5)])) == [(0, 6), (6, 12), (12, 17)]
    assert trend.last_step(noisy([(10.0, 6), (12.0, 6), (9.0, 5)]))[0] == 12


@pytest.mark.parametrize("seed", range(20))
def test_noise_and_small_steps_are_none(seed):
    assert trend.last_step(noisy([(10.0, 20)], seed)) is None
    assert trend.last_step(noisy([(10.0, 8), (10.3, 8)], seed)) is None  # 3 %


def test_an_outlier_is_no_step_of_the_end():
    values = [10.0] * 6 + [20.0] + [10.0] * 6
    step = trend.last_step(values)
    assert step is None or step[2] == pytest.approx(step[1])


def test_constant_and_short_histories():
    assert trend.last_step([5.0] * 9) is None
    assert trend.last_step([0.0] * 9) is None
    assert trend.last_step([1.0, 1.0, 2.0, 2.0]) is None  # fewer than five
    assert trend.last_step([0.0] * 5 + [3.0] * 5)[2] == 3.0


def write(path, values):
    for i, value in enumerate(values):
        trend.append(path, {"schema": trend.SCHEMA, "commit": f"c{i}", "utc": "", "values": {"strip": {"newton": value, "pcg": 7.0}}})


def test_the_verb_names_case_metric_and_commit_and_never_fails(tmp_path, capsys):
    write(tmp_path / "h.jsonl", [100.0] * 6 + [120.0] * 4)
    assert trend.main([str(tmp_path / "h.jsonl")]) == 0
    out = capsys.readouterr().out
    assert "1 steps in 2 histories" in out and "c6" in out and "newton" in out and "pcg" not in out
    write(tmp_path / "short.jsonl", [100.0, 120.0])
    assert trend.main([str(tmp_path / "short.jsonl")]) == 0
    assert "nothing to look at yet" in capsys.readouterr().out


@pytest.mark.parametrize("text, said", [("", "empty"), ("[]\n[]\n", "no line of"), ("{\n{}\n", ":1: not JSON"), (None, "not there")])
def test_a_history_that_cannot_be_read_is_named(tmp_path, capsys, text, said):
    if text is not None:
        (tmp_path / "h.jsonl").write_text(text)
    assert trend.main([str(tmp_path / "h.jsonl")]) == 2
    assert said in capsys.readouterr().err


def test_numbers_of_a_gate_become_a_line():
    findings = [Finding("a", "III", "cond", "pass", 3.0), Finding("a", "I", "audit", "pass", 0), Finding("b", "V", "time", "report", 1.5), Finding("b", "III", "word", "pass", "x")]
    line = trend.line_of(findings, "abc", "now")
    assert line["values"] == {"a": {"cond": 3.0}, "b": {"time": 1.5}} and line["commit"] == "abc"


def test_a_gate_writes_its_history(gate, tmp_path):
    for _ in range(2):
        assert gate("gate", "--case", "block-log", "--history", str(tmp_path / "h.jsonl")) in (0, 1)
    rows = [json.loads(text) for text in (tmp_path / "h.jsonl").read_text().splitlines()]
    assert len(rows) == 2 and rows[0]["values"]["block-log"] and len(rows[0]["commit"]) == 40
    assert trend.main([str(tmp_path / "h.jsonl")]) == 0
