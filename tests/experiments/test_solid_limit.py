"""The strain limit of solids as a user sees it: a block that it holds, what the record says, matching, refusals, `eval`."""

import json
import math
import subprocess
from pathlib import Path

import pytest

SCENE = Path(__file__).resolve().parents[2] / "configs/scenes/solid_limit.json"
ONSET = WIDTH = 0.03


def started(program, out, *settings):
    """A setting is POINTER=JSON; null leaves the key out."""
    config = json.loads(SCENE.read_text())
    for setting in ("/passes/time=false", *settings):
        pointer, value = setting.split("=")
        *sections, key = pointer.strip("/").split("/")
        at = config
        for section in sections:
            at = at.setdefault(section, {})
        at[key] = json.loads(value)
        if at[key] is None:
            del at[key]
    out.mkdir(parents=True)
    (out / "config.json").write_text(json.dumps(config))
    return subprocess.run([program, "run", str(out / "config.json"), "--out", str(out / "run")], capture_output=True, text=True, check=False)


def record_of(program, out, *settings):
    done = started(program, out, *settings)
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads((out / "run/run.json").read_text())


def planned(record):
    return next(item for item in record["plan"] if item["item"] == "strain_limit")


@pytest.mark.parametrize("formulation", ["log", "cubic", "cubic_dynamic_consistent"])
def test_a_hanging_block_is_held_at_its_limit(program, tmp_path, formulation):
    record = record_of(program, tmp_path / "out", f'/formulation/name="{formulation}"', "/time/steps=40")
    summary, checks = record["summary"], {check["name"]: check for check in record["validity"]["checks"]}
    assert record["status"]["outcome"] == "ok" and record["status"]["valid"]
    assert ONSET < summary["max_stretch"] < ONSET + WIDTH  # active, and kept
    assert checks["strain_limit_kept"]["pass"] and checks["strain_limit_kept"]["bound"] == pytest.approx(ONSET + WIDTH)
    assert summary["solid_limit_load_max_Pa"] > 5000 and summary["limit_load_max_N_per_m"] is None
    assert max(step["limit_J"] for step in record["steps"]) > 0.01
    assert planned(record) == {"item": "strain_limit", "active": True, "reason": "96 limited tetrahedra"}


def test_the_executor_of_the_host_has_the_same_run(program, tmp_path):
    one, other = (record_of(program, tmp_path / device, f'/device="{device}"', "/time/steps=10") for device in ("cpu", "host"))
    assert one["status"]["outcome"] == other["status"]["outcome"] == "ok" and other["summary"]["max_stretch"] > ONSET
    for key in ("max_stretch", "solid_limit_load_max_Pa"):
        assert other["summary"][key] == pytest.approx(one["summary"][key], rel=1e-6)
    assert planned(other) == planned(one)


def test_without_it_the_block_is_stretched_far_beyond(program, tmp_path):
    record = record_of(program, tmp_path / "out", "/strain_limit/solids=false", "/matching/solid_limit_load_Pa=null", "/time/steps=10")
    assert record["status"]["outcome"] == "ok" and record["summary"]["max_stretch"] is None
    assert not planned(record)["active"]


def test_k_s_is_matched_to_the_load_at_theta(program, tmp_path):
    """k_s |b'(theta w)| is the load, b of the log the mean of b = -(y - w)^2 log(y/w)."""
    record = record_of(program, tmp_path / "out", "/time/steps=1", "/matching/theta=0.2")
    y = 0.2 * WIDTH
    slope = -2 * (y - WIDTH) * math.log(y / WIDTH) - (y - WIDTH) ** 2 / y
    matching = record["matching"]
    assert matching["solid_limit_load_Pa"] == 40000
    assert matching["solid_limit_stiffness_Pa"] == pytest.approx(40000 / -slope, rel=1e-12)
    given = record_of(program, tmp_path / "given", "/time/steps=1", "/matching/solid_limit_load_Pa=null", "/strain_limit/solid_k_s_Pa=4321")
    assert given["matching"]["solid_limit_stiffness_Pa"] == 4321


@pytest.mark.parametrize(
    "settings, words",
    [
        (("/matching/solid_limit_load_Pa=null",), ("#/matching/solid_limit_load_Pa", "no calibration run measures")),
        (("/strain_limit/solids=false",), ("#/matching/solid_limit_load_Pa", "read with strain_limit/solids true")),
        (("/strain_limit/solids=false", "/matching/solid_limit_load_Pa=null", "/strain_limit/solid_k_s_Pa=1"), ("#/strain_limit/solid_k_s_Pa", "nothing")),
        (("/strain_limit/enabled=false", "/matching/solid_limit_load_Pa=null"), ("#/strain_limit/solids", "not enabled")),
        (("/strain_limit/solid_k_s_Pa=-1",), ("#/strain_limit/solid_k_s_Pa", "a number >= 1e-36")),
    ],
)
def test_what_cannot_be_is_refused_at_its_place(program, tmp_path, settings, words):
    done = started(program, tmp_path / "out", *settings)
    assert done.returncode == 2, done.stdout + done.stderr
    for word in words:
        assert word in done.stderr, done.stderr


def test_eval_knows_the_three_stretches_of_a_tetrahedron(program):
    """A diagonal F: PK1 has dS/d|sigma| with the sign of sigma, also where F is inverted."""
    query = {"kind": "strain_limit", "shape": "cubic", "onset": 0.01, "width": 0.02, "F": [[1.0, 0, 0], [0, -1.025, 0], [0, 0, 1.02]]}
    done = subprocess.run([program, "eval"], input=json.dumps(query), capture_output=True, text=True, check=False)
    answer = json.loads(done.stdout)
    slope = [2 / 0.02 * (s - 1 - 0.01) ** 2 for s in (1.025, 1.02)]
    assert answer["dE"] == pytest.approx([*slope, 0], rel=1e-9) and answer["dE"][2] == 0
    assert [answer["PK1"][k][k] for k in range(3)] == pytest.approx([0, -slope[0], slope[1]], rel=1e-9, abs=1e-15)
    query["F"] = [[1, 0], [0, 1]]
    assert "F" in subprocess.run([program, "eval"], input=json.dumps(query), capture_output=True, text=True, check=False).stdout
