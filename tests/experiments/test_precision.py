"""The settings /precision and /scene/translate_m as a user meets them: records, refusals, and what a translation may not change."""

import json
from pathlib import Path

import pytest
from test_cli import BLOCK, ROOT, bench

BALL = ROOT / "configs/scenes/sphere_on_sheet.json"
SMALL_BALL = ["/scene/n=7", "/scene/sphere_level=1", "/time/steps=3"]


def run(program: str, out: Path, config, *settings: str) -> dict:
    done = bench(program, "run", config, "--out", out, *[word for setting in settings for word in ("--set", setting)])
    assert (out / "run.json").exists(), done.stderr
    return json.loads((out / "run.json").read_text())


def hash_of(record: dict) -> str:
    return record["summary"]["state_hash"]


def test_float_and_mixed_are_named_in_record_plan_and_label(program, tmp_path):
    for precision, needed in (("double", False), ("mixed", True), ("float", True)):
        record = run(program, tmp_path / precision, BLOCK, "/time/steps=20", f'/precision="{precision}"')
        assert record["status"]["outcome"] == "ok"
        assert record["labels"]["precision"] == record["config"]["precision"] == precision
        item = next(p for p in record["plan"] if p["item"] == "float_arithmetic")
        assert item["active"] is needed
        assert ("no times of a float program" in item["reason"]) is needed


def test_float_and_mixed_end_near_double_and_have_the_same_stiffness(program, tmp_path):
    records = {p: run(program, tmp_path / p, BALL, *SMALL_BALL, f'/precision="{p}"') for p in ("double", "mixed", "float")}
    for record in records.values():
        assert record["status"]["outcome"] == "ok", record["status"]
        assert max(step["contacts"]["total"] for step in record["steps"]) > 0
        assert record["matching"]["contact"] == records["double"]["matching"]["contact"] if "contact" in record["matching"] else True
    assert len({hash_of(record) for record in records.values()}) == 3
    first = {p: next(s for s in r["steps"] if s["contacts"]["total"]) for p, r in records.items()}
    assert first["mixed"]["gap_min_m"] == pytest.approx(first["double"]["gap_min_m"], rel=1e-2)
    assert first["float"]["gap_min_m"] == pytest.approx(first["double"]["gap_min_m"], rel=1e-2)
    ulps = first["float"]["gap_min_ulps"] / first["double"]["gap_min_ulps"]
    assert ulps == pytest.approx(2.0**-29, rel=1e-2)  # of float, not of double


def test_a_translation_of_zero_changes_no_bit_and_one_of_ten_metres_no_physics(program, tmp_path):
    here = run(program, tmp_path / "here", BALL, *SMALL_BALL)
    zero = run(program, tmp_path / "zero", BALL, *SMALL_BALL, "/scene/translate_m=[0,0,0]")
    away = run(program, tmp_path / "away", BALL, *SMALL_BALL, "/scene/translate_m=[10,-10,10]")
    assert hash_of(zero) == hash_of(here) and zero["ids"]["config_id"] == here["ids"]["config_id"]
    assert hash_of(away) != hash_of(here) and away["config"]["scene"]["translate_m"] == [10, -10, 10]
    assert [s["contacts"]["total"] for s in away["steps"]] == [s["contacts"]["total"] for s in here["steps"]]
    assert any(s["contacts"]["total"] for s in here["steps"])
    for a, b in zip(away["steps"], here["steps"], strict=True):
        if b["gap_min_m"] is not None:
            assert a["gap_min_m"] == pytest.approx(b["gap_min_m"], rel=1e-4)


def test_obstacles_motions_and_bodies_move_together(program, tmp_path):
    turning = {"angular_velocity_rad_per_s": 1, "center_m": [0.2, 0.1, 0]}
    scene = {
        "bodies": [{"name": "cloth", "mesh": {"generator": "grid", "n_x": 4, "n_y": 4}, "pins": [{"indices": [0, 1], "motion": turning}]}],
        "obstacles": [{"name": "floor", "kind": "plane", "point_m": [0, 0, -0.005]}],
    }
    config = {"schema": "barrierbench.config/1", "scene": scene, "formulation": {"name": "log", "d_hat_m": 0.01}, "time": {"dt_s": 0.01, "steps": 3}}
    config["matching"] = {"rule": "equal_force", "load_N": 0.1}
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(config))
    here = run(program, tmp_path / "here", path)
    away = run(program, tmp_path / "away", path, "/scene/translate_m=[3,2,1]")
    assert here["status"]["outcome"] == away["status"]["outcome"] == "ok"
    totals = [s["contacts"]["total"] for s in here["steps"]]
    assert totals == [s["contacts"]["total"] for s in away["steps"]] and max(totals) > 0


def test_far_from_the_origin_a_float_run_does_not_end_ok(program, tmp_path):
    # d_hat is 80 ulps of float there: the ball does not come to rest above the 16 ulps below which no step is proven free
    far = [*SMALL_BALL, "/scene/translate_m=[1000,0,1000]"]
    double = run(program, tmp_path / "double", BALL, *far)
    single = run(program, tmp_path / "float", BALL, *far, '/precision="float"')
    assert double["status"]["outcome"] == "ok" and double["status"]["valid"]
    assert single["status"]["outcome"] != "ok"


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ('/precision="single"', ["/precision", '"single"', "double, mixed, float"]),
        ("/scene/translate_m=[1,2]", ["/scene/translate_m", "[1,2]"]),
        ("/scene/translate_m=[1e16,0,0]", ["/scene/translate_m/0: found 1e+16", "<= 1e+15 (m)"]),
    ],
)
def test_what_is_not_allowed_is_refused(program, tmp_path, setting, words):
    done = bench(program, "run", BLOCK, "--out", tmp_path / "out", "--set", setting)
    assert done.returncode == 2 and not (tmp_path / "out").exists()
    for word in words:
        assert word in done.stderr


def test_a_planar_scene_has_no_third_direction(program, tmp_path):
    planar = ROOT / "configs/scenes/drape2d.json"
    done = bench(program, "check", planar, "--set", "/scene/translate_m=[1,0,1]")
    assert done.returncode == 2 and "without z" in done.stderr
    assert bench(program, "check", planar, "--set", "/scene/translate_m=[1,1,0]").returncode == 0
