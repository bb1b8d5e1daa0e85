"""What the gate missed and once cried wolf about: a baseline and a doctored record each, and the verdict that it deserves.

The records are those of one honest run of the block, edited; `bench gate accept --record` makes the baseline of one, `bench gate --record` judges the other."""

import copy
import hashlib
import json
import math
import shutil

import numpy as np
import pytest
from test_matrices import laplace, write

MATRICES = ("full/none", "full/block_jacobi", "solved/full/none", "solved/full/block_jacobi")


@pytest.fixture
def judged(gate, block, tmp_path, answer):
    """judged(edit of the new record, edit of both, edits of a line of the new trace) -> (exit code, metric -> verdict)."""

    def folder(name, edit, line):
        shutil.copytree(block, tmp_path / name)
        record, trace = json.loads((block / "run.json").read_text()), (block / "trace.jsonl").read_text()
        edit(record)
        if line:
            rows = [json.loads(text) for text in trace.splitlines()]
            for k, row in enumerate(rows):
                line(k, row)
            trace = "".join(json.dumps(row) + "\n" for row in rows)
            for file in record["artifacts"]:
                if file["kind"] == "trace":
                    file.update(sha256=hashlib.sha256(trace.encode()).hexdigest(), bytes=len(trace))
        (tmp_path / name / "run.json").write_text(json.dumps(record))
        (tmp_path / name / "trace.jsonl").write_text(trace)
        return tmp_path / name / "run.json"

    def call(edit=lambda record: None, both=lambda record: None, line=None):
        def new(record):
            both(record)
            edit(record)

        kept = tmp_path / "kept.json"
        assert gate("accept", "--record", folder("old", both, None), "--baseline", kept, "--reason", "first") == 0
        code = gate("gate", "--record", folder("new", new, line), "--baseline", kept)
        return code, {f["metric"]: f["verdict"] for f in answer()["findings"]}

    return call


def cond(record, name, which, factor=1.0):
    record["summary"]["cond"][name]["log10_cond"][which] += math.log10(factor)


def test_the_same_record_is_green(judged):
    code, verdicts = judged()
    assert code == 0 and "FAIL" not in verdicts.values() and len(verdicts) > 50


def test_the_95th_percentile_of_cond_times_51(judged):
    def both(record):
        record["summary"]["cond"]["full/none"]["log10_cond"]["max"] = 4.0  # one wall at the start hides the others

    code, verdicts = judged(lambda record: cond(record, "full/none", "p95", 51), both)
    assert code == 1 and {m for m, v in verdicts.items() if v == "FAIL"} == {"log10_cond full/none p95"}


def test_the_smallest_gap_from_0_015_to_1e_9_d_hat(judged):
    def gap(value):
        return lambda record: record["summary"]["gap_min_rel"].update(min=value)

    code, verdicts = judged(gap(1e-9), gap(0.015))
    assert code == 1 and verdicts["gap_min"] == "FAIL"


def test_a_small_gap_may_move_by_its_own_rounding(judged):
    def gap(value):
        return lambda record: record["summary"]["gap_min_rel"].update(min=value)

    assert judged(gap(1.502e-3), gap(1.5e-3))[0] == 0


def test_half_the_condition_numbers_turned_to_bound(judged):
    def edit(record):
        statuses = record["summary"]["cond"]["full/none"]["statuses"]
        n = statuses["ok"]
        statuses.update(ok=n - n // 2, lower_bound=n // 2)

    code, verdicts = judged(edit)
    assert code == 1 and verdicts["status full/none: ok"] == verdicts["status full/none: lower_bound"] == "FAIL"


def test_half_the_error_estimates_turned_to_bound(judged):
    def line(k, row):
        if k % 2:
            row.update(error_estimate_m=None, error_estimate_m_status="bound")

    code, verdicts = judged(line=line)
    assert code == 1 and verdicts["error_estimate: number"] == verdicts["error_estimate: bound"] == "FAIL"


@pytest.mark.parametrize("key, value, metric", [("method", "power iteration", "method full/none: spectra"), ("proof", "none", "proof full/none: none")])
def test_another_method_or_no_proof(judged, key, value, metric):
    def line(k, row):
        for entry in row["cond"]:
            if entry["matrix"] == "clamped" and entry["scaling"] == "none":
                entry[key] = value

    code, verdicts = judged(line=line)
    assert code == 1 and verdicts[metric] == "FAIL"


def test_steps_that_end_without_a_proof(judged):
    def edit(record):
        for step in record["steps"][::2]:
            step["end_proof"] = "unproven"

    code, verdicts = judged(edit)
    assert code == 1 and verdicts["end_proof: unproven"] == "FAIL"


@pytest.mark.parametrize("was, now, code", [(4, 8, 1), (9, 18, 1), (1, 2, 1), (9, 10, 0), (60, 65, 0)])
def test_a_small_count_that_doubles(judged, was, now, code):
    def pcg(value):
        return lambda record: record["summary"]["probe_pcg"].update(median=value, p95=value, max=value)

    found, verdicts = judged(pcg(now), pcg(was))
    assert found == code and (verdicts["probe_pcg_median"] == "FAIL") == bool(code)


def test_a_new_stage_at_1e13(judged):
    def edit(record):
        stage = copy.deepcopy(record["summary"]["cond"]["full/none"])
        stage["log10_cond"].update(median=13.0, p95=13.0, max=13.0)
        record["summary"]["cond"]["contact/none"] = stage

    code, verdicts = judged(edit)
    assert code == 1 and verdicts["log10_cond contact/none median"] == verdicts["status contact/none: ok"] == "FAIL"


def test_a_new_number_is_named_with_what_to_do(judged, capsys):
    def without(record):
        record["summary"]["max_stretch"] = None
        record["summary"]["max_stretch_status"] = "no_triangles"

    assert judged(lambda record: record["summary"].update(max_stretch=0.1), without)[0] == 1
    assert "stretch_max" in (said := capsys.readouterr().out) and "not in the baseline: accept it" in said


def test_cond_that_is_20_percent_better_is_green(judged, capsys):
    def edit(record):
        for name in MATRICES:
            for which in ("median", "p95", "max"):
                cond(record, name, which, 0.8)

    code, verdicts = judged(edit)
    better = {metric for metric, verdict in verdicts.items() if verdict == "better"}
    assert code == 0 and len(better) == 12 and "log10_cond full/none median" in better
    said = capsys.readouterr()
    assert "12 better" in said.out and ": green" in said.out and "bench gate accept --record ... --baseline " in said.err and " --better " in said.err


# --- a folder of matrices


@pytest.fixture
def folder(tmp_path):
    """Eight matrices with known condition numbers, the largest far above the others."""

    def make(name, conditions):
        (tmp_path / name).mkdir()
        return [write(tmp_path / name / f"step-{k}.mtx", np.diag(np.geomspace(1, c, 12)) + 1e-9 * laplace(12)) for k, c in enumerate(conditions)]

    return make


CONDITIONS = [10, 20, 30, 1000, 1000, 1000, 1000, 1e6]


def of_folders(gate, answer, tmp_path, old, new):
    assert gate("accept", "--matrix", *old, "--baseline", tmp_path / "m.json", "--reason", "first") == 0
    code = gate("gate", "--matrix", *new, "--baseline", tmp_path / "m.json")
    return code, {f["metric"]: f for f in answer()["findings"]}


def test_three_of_eight_matrices_worse_up_to_the_maximum(gate, answer, tmp_path, folder):
    worse = [10, 20, 30, 1000, 1000, 1e6, 1e6, 1e6]  # median and maximum stay
    code, lines = of_folders(gate, answer, tmp_path, folder("old", CONDITIONS), folder("new", worse))
    red = {metric for metric, f in lines.items() if f["verdict"] == "FAIL"}
    assert code == 1 and {f"log10_cond raw step-{k}.mtx" for k in (5, 6)} <= red and "log10_cond raw step-3.mtx" not in red


def test_matrices_that_are_missing_or_new_are_named(gate, answer, tmp_path, folder):
    old, new = folder("old", CONDITIONS), folder("new", CONDITIONS)
    new[7].rename(new[7].with_name("step-9.mtx"))
    code, lines = of_folders(gate, answer, tmp_path, old, [*new[:7], new[7].with_name("step-9.mtx")])
    assert code == 1
    assert lines["matrix step-7.mtx"]["verdict"] == "FAIL" and "missing" in lines["matrix step-7.mtx"]["note"]
    assert lines["matrix step-9.mtx"]["verdict"] == "FAIL" and "accept it" in lines["matrix step-9.mtx"]["note"]


def test_the_same_folder_elsewhere_is_green(gate, answer, tmp_path, folder):
    assert of_folders(gate, answer, tmp_path, folder("old", CONDITIONS), folder("new", CONDITIONS))[0] == 0


# --- many small accepts


def steps_up(gate, block, tmp_path, n, factor):
    """n accepts of a record whose condition numbers grow by this factor each; the record of the last."""
    record, kept = json.loads((block / "run.json").read_text()), tmp_path / "kept.json"
    shutil.copy(block / "trace.jsonl", tmp_path)
    for k in range(n + 1):
        if k:
            for which in ("median", "p95", "max"):
                cond(record, "full/none", which, factor)
        (tmp_path / "run.json").write_text(json.dumps(record))
        if k:
            assert gate("gate", "--record", tmp_path / "run.json", "--baseline", kept) in (0, 1)
        assert gate("accept", "--record", tmp_path / "run.json", "--baseline", kept, "--reason", f"accept {k}") == 0
    return tmp_path / "run.json", kept


def test_many_small_accepts_are_a_drift(gate, block, tmp_path, answer, capsys):
    record, kept = steps_up(gate, block, tmp_path, 4, 1.1)  # + 10 % each is green against the last, + 46 % is not against the first
    assert gate("gate", "--record", record, "--baseline", kept) == 1
    line = next(f for f in answer()["findings"] if f["metric"] == "log10_cond full/none median")
    assert line["verdict"] == "drift" and "higher, x 1.46 since the first baseline" in line["note"] and "accept --drift" in line["note"]
    assert {f["verdict"] for f in answer()["findings"] if "full/none" not in f["metric"]} <= {"pass", "report", "not_judged"}
    assert "3 drift" in capsys.readouterr().out


def test_two_small_accepts_are_none(gate, block, tmp_path):
    record, kept = steps_up(gate, block, tmp_path, 2, 1.1)
    assert gate("gate", "--record", record, "--baseline", kept) == 0


def test_a_drift_is_accepted_on_purpose_and_recorded(gate, block, tmp_path, capsys):
    record, kept = steps_up(gate, block, tmp_path, 4, 1.1)
    again = ["accept", "--record", record, "--baseline", kept]
    assert gate(*again, "--reason", "once more") == 0  # does not help
    assert "drifted from the first baseline" in capsys.readouterr().out
    assert gate("gate", "--record", record, "--baseline", kept) == 1
    assert gate(*again, "--drift") == 2
    assert gate(*again, "--drift", "--reason", "the scene is stiffer now") == 0
    assert gate("gate", "--record", record, "--baseline", kept) == 0
    entry = json.loads(kept.read_text())["drifts"][0]
    was, now = entry["metrics"]["log10_cond full/none median"]
    assert entry["reason"] == "the scene is stiffer now" and now - was == pytest.approx(4 * math.log10(1.1))
    assert gate(*again, "--reason", "later") == 0 and len(json.loads(kept.read_text())["drifts"]) == 1


def test_accept_offers_what_is_better(gate, block, tmp_path, capsys):
    record, kept = json.loads((block / "run.json").read_text()), tmp_path / "kept.json"
    shutil.copy(block / "trace.jsonl", tmp_path)
    (tmp_path / "run.json").write_text(json.dumps(record))
    assert gate("accept", "--record", tmp_path / "run.json", "--baseline", kept, "--reason", "first") == 0
    was = json.loads(kept.read_text())["metrics"]
    cond(record, "full/none", "median", 0.5)
    cond(record, "full/none", "max", 1.1)
    (tmp_path / "run.json").write_text(json.dumps(record))
    capsys.readouterr()
    assert gate("accept", "--better", "--record", tmp_path / "run.json", "--baseline", kept, "--reason", "a better start") == 0
    now = json.loads(kept.read_text())["metrics"]
    assert [name for name in now if now[name]["value"] != was[name]["value"]] == ["log10_cond full/none median"]
    assert "1 of" in capsys.readouterr().out
