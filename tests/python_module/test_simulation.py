"""Runs by single steps: the numbers of the program, views, callbacks, and nothing lost where Python raises."""

import json
import subprocess

import numpy as np
import pytest

APART = {"status", "ids", "provenance", "machine", "times"}  # when, by which file and where


def run_of_program(program, config, folder, *words):
    file = folder / "config.json"
    file.write_text(json.dumps({"schema": "barrierbench.config/1", **config}))
    command = [program, "run", str(file), "--out", str(folder / "run"), "--progress", "none", *words]
    subprocess.run(command, check=True, capture_output=True)
    return json.loads((folder / "run/run.json").read_text())


def untimed(audit):
    return {name: value for name, value in audit.items() if not name.endswith("time_s")}


def numbers_of(record):
    """Without what distinguishes one run of a config from another."""
    kept = {name: value for name, value in record.items() if name not in APART}
    kept["summary"] = {k: v for k, v in kept["summary"].items() if k not in ("start_check_s", "peak_rss_bytes")}
    kept["audit"] = untimed(kept["audit"])
    kept["validity"] = {k: v for k, v in kept["validity"].items() if k != "build"}
    kept["artifacts"] = [a for a in kept["artifacts"] if a["kind"] != "trace"]
    return kept


def test_steps_are_those_of_the_program(bb, program, drape, tmp_path):
    wanted = run_of_program(program, drape, tmp_path)
    assert wanted["steps"][-1]["contacts"]["total"] > 0
    with bb.Simulation(drape, out=tmp_path / "steps") as sim:
        reports = [sim.step() for _ in range(8)]
        assert sim.done and sim.outcome == "ok"
        record = sim.finish()
    assert json.loads((tmp_path / "steps/run.json").read_text()) == record
    assert record["summary"]["state_hash"] == wanted["summary"]["state_hash"]
    assert numbers_of(record) == numbers_of(wanted)
    for report, step in zip(reports, wanted["steps"]):
        assert report["newton_iterations"] == step["newton_iterations"] and report["gap_min_m"] == step["gap_min_m"]
    own, others = ((tmp_path / name / "trace.jsonl").read_text().splitlines() for name in ("steps", "run"))
    for a, b in zip(own, others, strict=True):
        a, b = json.loads(a), json.loads(b)
        a.pop("time"), b.pop("time")
        assert a == b


def test_a_run_of_two_passes_is_its_observed_one(bb, program, drape, tmp_path):
    drape["passes"] = {"time": True, "audit": True}
    sim = bb.Simulation(drape)
    assert sim.config["passes"]["time"] is False
    wanted = run_of_program(program, drape, tmp_path)["summary"]["state_hash"]
    assert sim.run().state_hash == wanted == sim.record()["summary"]["state_hash"]


def test_views_follow_the_state(bb, drape):
    sim = bb.Simulation(drape)
    x, v = sim.positions, sim.velocities
    start = x.copy()
    assert np.array_equal(start, sim.scene.x0) and not x.flags.writeable
    report = sim.step()
    assert not np.array_equal(x, start) and np.allclose(v, (x - start) / report["dt_s"], atol=1e-9)
    assert sim.faces.shape == (98, 3) and sim.time == pytest.approx(report["t_s"])
    del sim
    assert np.isfinite(x).all()  # a view keeps what it looks at


def test_a_callback_sees_every_iteration(bb, drape):
    rows = []
    sim = bb.Simulation(drape, on_iteration=rows.append)
    count = sum(sim.step()["newton_iterations"] for _ in range(3))
    assert len(rows) == count > 3 and rows[-1]["step"] == 2 and rows[0]["grad_inf_N"] > 0


class Stop(Exception):
    pass


def test_what_a_callback_raises_leaves_the_run_where_it_was(bb, drape, tmp_path):
    whole = bb.Simulation(drape).run()
    sim = bb.Simulation(drape, out=tmp_path / "run")
    for _ in range(4):
        sim.step()
    before, calls = sim.state_hash, []

    def fall(row):
        calls.append(row)
        if len(calls) == 2:
            raise Stop("in the middle")

    sim.on_iteration = fall
    with pytest.raises(Stop, match="in the middle"):
        sim.step()
    assert len(calls) == 2 and sim.state_hash == before and sim.steps == 4 and not sim.done
    sim.on_iteration = None
    sim.run()
    assert sim.state_hash == whole.state_hash
    record, wanted = sim.finish(), whole.record()
    assert record["steps"] == wanted["steps"] and untimed(record["audit"]) == untimed(wanted["audit"])
    assert record["summary"]["newton_iterations"] == wanted["summary"]["newton_iterations"]
    lines = (tmp_path / "run/trace.jsonl").read_text().splitlines()
    assert len(lines) == sum(step["newton_iterations"] for step in record["steps"])


def test_errors_are_those_of_the_program(bb, drape, tmp_path):
    with pytest.raises(bb.ConfigError, match="/output: found frames, matrices or forces"):
        bb.Simulation(drape, {"/output/frames_every": 1})
    with pytest.raises(bb.ConfigError, match="did you mean drape"):
        bb.Simulation({"scene": {"name": "drap"}})
    with pytest.raises(bb.ConfigError, match="nowhere.json"):
        bb.Simulation(tmp_path / "nowhere.json")
    sim = bb.Simulation(drape, {"/time/steps": 1}, out=tmp_path / "run")
    with pytest.raises(bb.RecordError, match="run"):
        bb.Simulation(drape, out=tmp_path / "run")
    sim.step()
    with pytest.raises(RuntimeError, match="the run is over: ok"):
        sim.step()
    sim.close()
    assert not (tmp_path / "run/trace.jsonl.part").exists()
    with pytest.raises(RuntimeError, match="closed"):
        sim.step()


def test_a_run_that_was_ended_early_says_so(bb, drape):
    sim = bb.Simulation(drape)
    sim.step()
    status = sim.finish()["status"]
    assert status["outcome"] == "timeout" and "after 1 steps" in status["detail"] and not status["valid"]


def test_a_whole_run_is_that_of_the_program(bb, program, drape, tmp_path):
    drape["passes"] = {"time": True, "audit": True}
    steps = []
    record = bb.run(drape, out=tmp_path / "whole", on_step=steps.append)
    assert {s["pass"] for s in steps} == {"time", "diagnose"} and len(steps) == 16
    wanted = run_of_program(program, drape, tmp_path)
    assert record["summary"]["state_hash"] == wanted["summary"]["state_hash"]
    assert record["summary"]["wall_s"] > 0 and record["ids"]["config_id"] == wanted["ids"]["config_id"]
    assert record["ids"]["build_id"] != wanted["ids"]["build_id"]

    def fall(row):
        raise Stop

    with pytest.raises(Stop):
        bb.run(drape, out=tmp_path / "cut", on_step=fall)
    assert not (tmp_path / "cut/run.json").exists()
    assert bb.run(drape, out=tmp_path / "cut", resume=True)["summary"]["state_hash"] == wanted["summary"]["state_hash"]
