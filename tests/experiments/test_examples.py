"""The scenes of examples/: they run as their README says, with what they are meant to show, and every key is explained."""

import json
import re
from pathlib import Path

import pytest
from test_cli import bench

FOLDER = Path(__file__).resolve().parents[2] / "examples/scenes"
SCENE = FOLDER / "cloth_over_bar.json"


@pytest.fixture(scope="module")
def run(program, tmp_path_factory):
    out = tmp_path_factory.mktemp("example")
    done = bench(program, "run", SCENE, "--out", out, "--set", "/passes/time=false")
    assert done.returncode == 0, done.stderr
    return out


def test_the_scene_ends_ok_and_everything_in_it_touches(run):
    record = json.loads((run / "run.json").read_text())
    assert record["status"]["outcome"] == "ok", record["status"]["detail"]
    assert record["summary"]["steps"] == 30 and record["audit"]["crossings"] == 0
    assert {"bar|cloth", "cloth|rod", "cloth|plate"} <= set(record["summary"]["first_contact"])
    assert len(list((run / "frames").glob("step_*.ply"))) == 6 + 1  # every fifth, and the last


def test_the_pins_follow_their_motion(run):
    from barrierbench_analysis.io.frames import read_frame

    start, end = (read_frame(run / "frames" / name).vertices for name in ("start.ply", "step_000025.ply"))
    low, high = json.loads(SCENE.read_text())["scene"]["bodies"][0]["pins"][0]["box_m"]
    pinned = ((start >= low) & (start <= high)).all(axis=1)
    assert 10 <= pinned.sum() < 40
    moved = (end - start)[pinned]
    assert abs(moved - [-0.1 * 0.15, 0, 0.2 * 0.15]).max() < 1e-12  # velocity times 0.15 s


def test_every_key_is_explained(program):
    text, config = (FOLDER / "README.md").read_text(), json.loads(SCENE.read_text())
    pointers = re.findall(r"`(/[a-z_0-9/]+)`", text)
    for pointer in pointers:  # what is explained is there
        place = config
        for word in pointer.split("/")[1:]:
            place = place[int(word)] if isinstance(place, list) else place[word]
    bodies = config["scene"]["bodies"]
    keys = {f"/{k}" for k in config if k != "scene"} | {f"/scene/{k}" for k in config["scene"] if k not in ("bodies", "obstacles")}
    keys |= {f"/scene/obstacles/{i}" for i in range(len(config["scene"]["obstacles"]))}
    for key in keys:
        assert any(p == key or p.startswith(key + "/") for p in pointers), key
    explained = " ".join(p.rsplit("/", 1)[-1] for p in pointers) + " pins name "
    for body in bodies:
        for key in body:
            assert key in explained.split() or f"/{key}/" in text, key
    commands = re.findall(r"^\./bench (\w+) +(examples\S+)", text, re.MULTILINE)
    assert commands == [("check", "examples/scenes/cloth_over_bar.json"), ("run", "examples/scenes/cloth_over_bar.json"), ("run", "examples/scenes/garment_on_a_torso.json")]
    assert bench(program, "check", SCENE).returncode == 0


def record_of(program, out, name, *settings):
    """Of a scene of examples/scenes, which has to end ok and clean."""
    words = [word for setting in ("/passes/time=false", *settings) for word in ("--set", setting)]
    done = bench(program, "run", FOLDER / f"{name}.json", "--out", out, *words)
    assert done.returncode == 0, done.stderr
    record = json.loads((out / "run.json").read_text())
    assert record["status"]["outcome"] == "ok" and record["status"]["valid"], record["status"]["detail"]
    assert record["audit"]["crossings"] == 0 and record["audit"]["judged"] > 0
    return record


def test_blocks_stay_on_the_slope_above_its_tangent_and_slide_below(program, tmp_path):
    kinetic = []
    for mu in (0.6, 0.3):
        record = record_of(program, tmp_path / f"{mu}", "blocks_on_slope", f"/friction/mu={mu}")
        assert {"slope|upper", "lower|slope"} <= {"|".join(sorted(pair.split("|"))) for pair in record["summary"]["first_contact"]}
        kinetic.append(record["steps"][-1]["kinetic_J"])
    assert kinetic[0] < 0.02 * kinetic[1]  # 1.2 kg at g (sin - 0.3 cos) 0.3 s = 0.53 m/s: 0.17 J
    assert 0.08 < kinetic[1] < 0.25


@pytest.mark.parametrize("name, pair", [("coiled_rod", "rod|rod"), ("twisted_sheet", "sheet|sheet"), ("ball_on_cloth", "ball|cloth")])
def test_the_others_touch_what_they_are_said_to_touch(program, tmp_path, name, pair):
    record = record_of(program, tmp_path / name, name)
    assert pair in {"|".join(sorted(each.split("|"))) for each in record["summary"]["first_contact"]}
    if name == "ball_on_cloth":
        assert 0.02 < record["summary"]["max_stretch"] < 0.05
    assert f"`{name}.json`" in (FOLDER / "README.md").read_text()
