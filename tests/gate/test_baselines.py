"""Baselines: what is read, what is refused, and how they change."""

import json
import shutil

import pytest

from barrierbench_analysis.studies.gate import baseline


@pytest.fixture
def folder(tmp_path):
    """A copy of the committed baselines; edit(name, function) changes one."""
    target = tmp_path / "baselines"
    shutil.copytree(baseline.FOLDER, target)
    return target


def edit(folder, change, name="block-log"):
    path = folder / f"{name}.json"
    data = json.loads(path.read_text())
    change(data)
    path.write_text(json.dumps(data))
    return path


def test_every_case_has_a_baseline_and_every_baseline_a_case():
    from barrierbench_analysis.studies.gate.cases import read_set, sets

    names = {case.name for name in sets() for case in read_set(name)}
    assert names == {path.stem for path in baseline.FOLDER.glob("*.json")} and len(names) >= 12
    for name in names:
        kept = baseline.read(baseline.FOLDER / f"{name}.json", name, "run")
        assert kept.reason and kept.calibrated_at["runs"] == 21 and kept.calibrated_at["jitter_m"] > 0
        assert {"gap_min", "newton_iterations", "log10_cond full/none p95", "status full/none: ok", "error_estimate: number"} <= kept.metrics.keys()
        assert "state_hash" not in json.dumps(kept.json())


@pytest.mark.parametrize("change, said", [
    (lambda b: b["schema"].update(version="2.0.0"), "/schema/version: found '2.0.0'; a version 1.x.y of barrierbench.baseline is needed"),
    (lambda b: b.update(case="strip-log"), "a baseline of case 'strip-log', requested is 'block-log'"),
    (lambda b: b.update(kind="matrix"), "a baseline of kind 'matrix'"),
    (lambda b: b.update(metrics={}), "/metrics: found {}; at least one metric, without which nothing is judged, is needed"),
    (lambda b: b["scene"].update({"/free_dofs": 12}), "of another scene"),
    (lambda b: b["config"]["time"].update(dt_s=0.02), "/time/dt_s: 0.02 and 0.01"),
    (lambda b: b["metrics"]["gap_min"].update(value=float("nan")), "/metrics/gap_min/value: found nan; a finite number is needed"),
    (lambda b: b["metrics"]["gap_min"].update(upper=None), "/metrics/gap_min/upper: found None; a finite number is needed"),
    (lambda b: b["metrics"]["gap_min"].update(upper=-1.0), "outside its own envelope"),
    (lambda b: b["metrics"]["gap_min"].update({"class": "I"}), "classes I and II are exact"),
    (lambda b: b["metrics"]["gap_min"].update(first={"value": None}), "/metrics/gap_min/first"),
    (lambda b: b["metrics"]["gap_min"].update(direction="up"), "/metrics/gap_min/direction: found 'up'; one of two_sided, lower_better, upper_better is needed"),
])
def test_a_baseline_that_cannot_judge(gate, folder, capsys, change, said):
    edit(folder, change)
    assert gate("gate", "--case", "block-log", "--baselines", folder) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize("text, said", [("", "not JSON"), ("{", "not JSON"), ("[]", "not a JSON object"), ("{}", "schema: is missing")])
def test_a_file_that_is_no_baseline(gate, folder, capsys, text, said):
    (folder / "block-log.json").write_text(text)
    assert gate("gate", "--case", "block-log", "--baselines", folder) == 2
    assert said in capsys.readouterr().err


def test_no_baseline_and_no_case(gate, folder, capsys):
    (folder / "block-log.json").unlink()
    assert gate("gate", "--case", "block-log", "--baselines", folder) == 2
    assert "bench gate calibrate" in capsys.readouterr().err
    assert gate("gate", "--case", "nothing of this name") == 2
    assert gate("gate", "--set", "nothing of this name") == 2


def test_a_setting_that_the_baseline_does_not_know_is_no_other_config(gate, folder):
    edit(folder, lambda b: b["config"]["contact"].pop("ccd_park"))
    assert gate("gate", "--case", "block-log", "--baselines", folder) == 0


def test_another_processor_still_passes(gate, folder, answer):
    """Costs may then move as far as those of perturbed copies, and are not averaged."""
    def elsewhere(b):
        b["made_by"]["cpu_model"] = "another processor"
        kept = b["metrics"]["factorizations"]
        assert kept["value"] > 20
        kept.update(value=kept["value"] * 0.95, scatter=kept["scatter"] * 0.95, lower=kept["value"] * 0.9, upper=kept["value"] * 1.05)  # the run has 5.3% more

    edit(folder, elsewhere)
    assert gate("gate", "--case", "block-log", "--baselines", folder) == 0
    assert "geometric mean" not in {f["metric"] for f in answer()["findings"]}
    edit(folder, lambda b: b["made_by"].update(cpu_model=baseline.read(baseline.FOLDER / "block-log.json").made_by["cpu_model"]))
    here = json.loads((folder / "block-log.json").read_text())["made_by"]
    run = json.loads((next((folder.parent / "gate").rglob("threads-1/run.json"))).read_text())
    if here["cpu_model"] == run["machine"]["cpu_model"] and here["libraries"] == run["provenance"]["libraries"]:
        assert gate("gate", "--case", "block-log", "--baselines", folder) == 1  # more than 3% on the machine of the baseline


def test_the_bits_of_another_processor_still_pass(gate, answer, monkeypatch, tmp_path):
    """Emulated: OpenBLAS with the kernel of another processor, so that factorisations round otherwise."""
    hashes = []
    for kernel in (None, "Prescott"):
        if kernel:
            monkeypatch.setenv("OPENBLAS_CORETYPE", kernel)
        assert gate("gate", "--case", "strip-cubic") == 0
        assert answer()["judged"]["III"] > 15 and answer()["judged"]["II"] == 2
        record = json.loads((tmp_path / "gate/strip-cubic/threads-1/run.json").read_text())
        hashes.append(record["summary"]["state_hash"])
    if record["provenance"]["blas"]["kernel"] != "Prescott":
        pytest.skip("this OpenBLAS has one kernel")
    assert hashes[0] != hashes[1]


def test_a_metric_that_vanished_is_red(gate, folder, answer):
    edit(folder, lambda b: b["metrics"].update({"log10_cond full/jacobi max": dict(b["metrics"]["log10_cond full/none max"])}))
    assert gate("gate", "--case", "block-log", "--baselines", folder) == 1
    line = next(f for f in answer()["findings"] if f["verdict"] == "FAIL")
    assert line["metric"] == "log10_cond full/jacobi max" and line["judged"] == 0


def test_a_baseline_without_a_class_judges_nothing_of_it(gate, folder, answer):
    edit(folder, lambda b: b.update(metrics={k: v for k, v in b["metrics"].items() if v["class"] == "III"}))
    assert gate("gate", "--case", "block-log", "--baselines", folder) == 1
    red = [f for f in answer()["findings"] if f["verdict"] == "FAIL"]
    assert {f["class"] for f in red} == {"IV"} and red[-1]["note"] == "no line of class IV judged anything"
    assert all(f["note"].startswith("not in the baseline") for f in red[:-1]) and len(red) > 3


def test_an_expected_failure_is_shown_and_no_failure(gate, folder, answer):
    def expected(b):
        b["metrics"]["gap_min"].update(value=0.5, lower=0.4, upper=0.6, xfail="issue 7")
        b["metrics"]["gap_median"].update(xfail="issue 7")

    edit(folder, expected)
    assert gate("gate", "--case", "block-log", "--baselines", folder) == 0
    verdicts = {f["metric"]: f["verdict"] for f in answer()["findings"]}
    assert verdicts["gap_min"] == "xfail" and verdicts["gap_median"] == "xpass"


# --- calibrate and accept


def test_calibrate_and_accept(gate, tmp_path, capsys):
    proposals, kept = tmp_path / "proposals", tmp_path / "kept"
    assert gate("calibrate", "--case", "block-cubic", "--copies", 5, "--out", proposals) == 0
    arguments = ["accept", "--proposals", proposals, "--baselines", kept]
    assert gate(*arguments, "--reason", "the first") == 0
    assert baseline.read(kept / "block-cubic.json").reason == "the first"
    assert gate("gate", "--case", "block-cubic", "--baselines", kept) == 0
    edit(kept, lambda b: b["metrics"]["gap_min"].update(value=0.5, lower=0.4, upper=0.6), "block-cubic")
    capsys.readouterr()
    assert gate(*arguments, "--reason", "contacts are softer", "--metric", "gap_min") == 0
    said = capsys.readouterr().out
    assert "1 of" in said and "gap_min: 0.5 [0.4, 0.6] -> 0.0996" in said and "lower, -80" in said
    assert baseline.read(kept / "block-cubic.json").reason == "contacts are softer"


def test_a_reason_is_needed(gate, capsys):
    for arguments in ([], ["--reason", " "]):
        assert gate("accept", *arguments) == 2
        assert "bench gate accept: " in (said := capsys.readouterr().err) and "--reason" in said


def test_class_I_is_never_accepted(gate, block, folder, tmp_path, capsys):
    proposals = tmp_path / "proposals"
    shutil.copytree(folder, proposals)
    assert gate("accept", "--proposals", proposals, "--baselines", folder, "--reason", "why not", "--metric", "crossings") == 2
    assert "class I and II are exact and are never accepted" in capsys.readouterr().err
    record = json.loads((block / "run.json").read_text())
    record["audit"]["crossings"] = 1
    (tmp_path / "run.json").write_text(json.dumps(record))
    shutil.copyfile(block / "trace.jsonl", tmp_path / "trace.jsonl")
    assert gate("accept", "--record", tmp_path / "run.json", "--baseline", tmp_path / "b.json", "--reason", "why not") == 2
    assert "makes no baseline" in capsys.readouterr().err and not (tmp_path / "b.json").exists()
