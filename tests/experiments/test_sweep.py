"""Sweeps as a user runs them: what is skipped, what runs are compared with, what is refused."""

import json
from pathlib import Path

import jsonschema
import pytest

from test_cli import BLOCK, ROOT, bench, refused, sweep_spec, write


def test_sweep_skips_what_is_finished(program, tmp_path):
    spec, out = sweep_spec(tmp_path, [1, 2]), tmp_path / "out"
    planned = bench(program, "sweep", spec, "--out", out, "--dry-run")
    assert planned.returncode == 0 and len(planned.stdout.splitlines()) == 2 and not out.exists()
    assert bench(program, "sweep", spec, "--out", out).returncode == 0
    records = sorted(out.glob("*/run.json"))
    assert {str(r.parent) for r in records} == set(planned.stdout.split())
    before = [r.stat().st_mtime_ns for r in records]
    second = bench(program, "sweep", spec, "--out", out)
    assert second.returncode == 0 and second.stdout.count("already there") == 2
    assert [r.stat().st_mtime_ns for r in records] == before


def test_a_record_beside_another_trace_runs_again(program, tmp_path):
    """Every reader in Python would refuse it: it is no record that is there."""
    spec, out = sweep_spec(tmp_path, [1, 2]), tmp_path / "out"
    more = ["--set", "/passes/diagnose=true"]
    assert bench(program, "sweep", spec, "--out", out, *more).returncode == 0
    damaged, whole = sorted(out.glob("*/trace.jsonl"))
    content = damaged.read_bytes()
    damaged.write_bytes(content[:-1] + b" ")
    second = bench(program, "sweep", spec, "--out", out, *more)
    assert second.returncode == 0 and second.stdout.count("already there") == 1
    assert "runs again: " in second.stdout and f"{damaged.parent / 'run.json'}#/artifacts/" in second.stdout and str(damaged) in second.stdout
    assert damaged.read_bytes().count(b"\n") == content.count(b"\n")
    assert bench(program, "sweep", spec, "--out", out, *more).stdout.count("already there") == 2
    assert whole.is_file()


def formulations(tmp_path, second: dict) -> Path:
    """log marked as the reference, and a second case."""
    stiff = {"/matching/rule": "as_given", "/formulation/stiffness_policy/kappa_N_per_m": 1000}
    return write(tmp_path / "pairs.json", {
        "schema": "barrierbench.sweep/1", "name": "pairs", "base": BLOCK, "set": {"/time/steps": 30} | stiff,
        "axes": [{"cases": [{"label": "second", "set": second}, {"label": "log", "reference": True, "set": {}}]}]})


def comparabilities(out: Path) -> dict:
    return {r.parent.name.rsplit("-", 1)[0]: json.loads(r.read_text())["comparability"] for r in out.glob("*/run.json")}


@pytest.mark.parametrize("kappa, verdict", [(900, "comparable"), (10, "not_comparable")])
def test_a_sweep_compares_every_run_with_its_reference(program, tmp_path, kappa, verdict):
    """The reference runs last and is named all the same; a second sweep over finished runs changes nothing."""
    spec, out = formulations(tmp_path, {"/formulation/stiffness_policy/kappa_N_per_m": kappa}), tmp_path / "out"
    assert bench(program, "sweep", spec, "--out", out).returncode == 0
    found = comparabilities(out)
    assert found["log"]["verdict"] == "comparable" and found["log"]["ratio"] == 1
    second = found["second"]
    assert second["verdict"] == verdict and second["reference_run"].startswith("log-")
    assert second["ratio"] == pytest.approx(second["gap_rel"] / second["reference_gap_rel"])
    assert (0.5 <= second["pair_ratio"] <= 2) == (verdict == "comparable") and second["max_ratio"] == 2
    assert second["pair"] == "block|plane" and second["pair_ratio"] == pytest.approx(second["pair_gap_rel"] / second["pair_reference_gap_rel"])
    reference = json.loads((out / second["reference_run"] / "run.json").read_text())
    assert second["reference_run_id"] == reference["ids"]["run_id"]
    assert second["reference_gap_rel"] == reference["summary"]["gap_min_rel"]["min"]
    schema = json.loads((ROOT / "configs/schema/run.schema.json").read_text())
    for record in out.glob("*/run.json"):
        jsonschema.Draft202012Validator(schema).validate(json.loads(record.read_text()))
    before = [r.read_bytes() for r in sorted(out.glob("*/run.json"))]
    assert bench(program, "sweep", spec, "--out", out).returncode == 0
    assert [r.read_bytes() for r in sorted(out.glob("*/run.json"))] == before


def box(name: str, z: float) -> dict:
    return {"name": name, "kind": "rigid", "transform": {"translate_m": [3, 0, z]},
            "mesh": {"generator": "box", "n": 1, "size_x_m": 0.5, "size_y_m": 0.5, "size_z_m": 0.1}}


def cloth(name: str, place: list, n: int, size: float) -> dict:
    return {"name": name, "transform": {"translate_m": place}, "mesh": {"generator": "grid", "n_x": n, "n_y": n, "size_x_m": size, "size_y_m": size}}


def test_a_pair_that_never_moves_does_not_hide_one_that_rests_elsewhere(program, tmp_path):
    """A piece between given bodies has the smallest gap whatever the stiffness: the sheet on the floor decides."""
    config = write(tmp_path / "pinch.json", {
        "schema": "barrierbench.config/1", "formulation": {"name": "log", "d_hat_m": 0.005}, "matching": {"rule": "equal_force"}, "time": {"dt_s": 0.01, "steps": 20},
        "scene": {"bodies": [box("lower", 0.9494), box("upper", 1.0506), cloth("piece", [3, 0, 1], 2, 0.2), cloth("resting", [0, 0, 0.004], 4, 1)],
                  "obstacles": [{"name": "floor", "kind": "plane", "axis": [0, 0, 1]}]}})
    spec, out = write(tmp_path / "pinch_sweep.json", {"schema": "barrierbench.sweep/1", "name": "pinch", "base": str(config), "axes": [{"cases": [
        {"label": "log", "set": {}, "reference": True}, {"label": "stiff", "set": {"/formulation/stiffness_policy/scale": 1000}}]}]}), tmp_path / "out"
    assert bench(program, "sweep", spec, "--out", out).returncode == 0
    found = comparabilities(out)
    assert found["log"]["verdict"] == "comparable"
    stiff = found["stiff"]
    assert 0.5 <= stiff["ratio"] <= 2  # the smallest gaps alone would call them comparable
    assert stiff["verdict"] == "not_comparable" and stiff["pair"] == "floor|resting" and stiff["pair_ratio"] > 2
    assert "floor|resting" in stiff["reason"]


def test_an_invalid_run_is_no_reference(program, tmp_path):
    spec, out = formulations(tmp_path, {}), tmp_path / "out"
    sweep = json.loads(spec.read_text())
    sweep["axes"][0]["cases"][1]["set"] = {"/step_solver/max_iterations": 1}
    assert bench(program, "sweep", write(spec, sweep), "--out", out).returncode == 0
    found = comparabilities(out)
    assert found["log"]["verdict"] == "not_valid"
    assert found["second"]["verdict"] == "no_reference" and "not valid" in found["second"]["reason"]
    alone = bench(program, "run", BLOCK, "--set", "/time/steps=2", "--out", tmp_path / "alone")
    assert alone.returncode == 0
    assert json.loads((tmp_path / "alone/run.json").read_text())["comparability"]["verdict"] == "no_reference"


def test_two_references_of_an_axis_are_refused(program, tmp_path):
    spec = json.loads(formulations(tmp_path, {}).read_text())
    spec["axes"][0]["cases"][0]["reference"] = True
    refused(bench(program, "sweep", write(tmp_path / "two.json", spec), "--dry-run"), "#/axes/0", "more than one reference")


def test_sweep_names_every_wrong_case_before_the_first_run(program, tmp_path):
    done = bench(program, "sweep", sweep_spec(tmp_path, [1, 0, "many"]), "--out", tmp_path / "out")
    refused(done, "steps=0", "steps=many", "#/time/steps")
    assert not (tmp_path / "out").exists()
