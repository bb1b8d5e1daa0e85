"""The stages of a diagnosis: the matrix with parts of it left out, either one first."""

import json
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

STAGES = ["full", "without_contact", "without_limit", "without_contact_and_limit"]


def lines(program, out, *more):
    words = [program, "run", str(ROOT / "configs/scenes/sphere_on_sheet.json"), "--out", str(out)]
    for setting in ("/scene/n=5", "/scene/sphere_level=1", "/strain_limit/limit=0.01", "/time/steps=8", "/passes/time=false", "/passes/diagnose=true", '/diagnose/scalings=["none"]',
                    f"/diagnose/stages={json.dumps(STAGES)}", *more):
        words += ["--set", setting]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in (out / "trace.jsonl").read_text().splitlines()], json.loads((out / "run.json").read_text())


def stages_of(line):
    return {s["stage"]: s for s in line["cond"] if s["matrix"] == "clamped"}


def test_without_limit_is_the_matrix_minus_the_limits_part(program, tmp_path):
    found, record = lines(program, tmp_path / "on")
    touching = [stages_of(line) for line in found if sum(line["contacts"].values()) > 0]
    assert touching and all(list(of) == STAGES for of in touching)
    assert "without_limit/none" in record["summary"]["cond"]
    for line in found:
        of = stages_of(line)
        if not sum(line["contacts"].values()):  # nothing but the limit to leave out
            assert of["without_limit"]["cond"] == pytest.approx(of["without_contact_and_limit"]["cond"], rel=1e-3) and "without_contact" not in of
        assert of["without_limit"]["lambda_max"] <= of["full"]["lambda_max"] * 1.001
        assert of["without_contact_and_limit"]["lambda_max"] <= of["without_limit"]["lambda_max"] * 1.001
    # it is neither of the other two: of some matrix the limit makes nine tenths, of another, without limit, contact does
    assert any(of["without_limit"]["lambda_max"] < 0.1 * of["full"]["lambda_max"] for of in touching)
    assert any(of["without_contact_and_limit"]["lambda_max"] < 0.1 * of["without_limit"]["lambda_max"] for of in touching)


def test_a_run_without_a_limit_has_no_such_stage(program, tmp_path):
    found, record = lines(program, tmp_path / "off", "/strain_limit/enabled=false")
    assert all(set(stages_of(line)) <= {"full", "without_contact"} for line in found) and "without_limit/none" not in record["summary"]["cond"]
