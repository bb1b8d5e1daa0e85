"""The record of another config in the folder of a run stays, unless `replace` lets it go."""

import json
import re

import pytest


def test_a_run_replaces_the_record_of_its_own_config_alone(bb, drape, tmp_path):
    out = tmp_path / "out"
    first = bb.run(drape, {"/time/steps": 2}, out=out)
    assert len(first["steps"]) == 2
    before = {path: path.read_bytes() for path in out.iterdir()}
    for made in (lambda: bb.run(drape, {"/time/steps": 1}, out=out), lambda: bb.Simulation(drape, {"/time/steps": 1}, out=out)):
        with pytest.raises(bb.ConfigError, match=r"run\.json: found the record of another run.*another folder.*replace=True"):
            made()
        assert {path: path.read_bytes() for path in out.iterdir()} == before
    assert bb.run(drape, {"/time/steps": 2}, out=out)["summary"]["state_hash"] == first["summary"]["state_hash"]
    with bb.Simulation(drape, {"/time/steps": 2}, out=out) as sim:  # the same config
        assert len(sim.run().finish()["steps"]) == 2
    with bb.Simulation(drape, {"/time/steps": 1}, out=out, replace=True) as sim:
        assert len(sim.run().finish()["steps"]) == 1
    assert len(bb.run(drape, {"/time/steps": 3}, out=out, replace=True)["steps"]) == 3


def test_a_simulation_replaces_the_record_of_a_whole_run_of_the_same_config(bb, drape, tmp_path):
    """Although it makes no timed pass, which its record says in its config."""
    requested = {"/time/steps": 2, "/passes/time": True}
    assert bb.run(drape, requested, out=tmp_path)["config"]["passes"]["time"] is True
    with bb.Simulation(drape, requested, out=tmp_path) as sim:
        assert sim.run().finish()["config"]["passes"]["time"] is False
    with pytest.raises(bb.ConfigError, match="/passes/time is false there and true in this run"):
        bb.run(drape, requested, out=tmp_path)


def test_what_else_made_the_record_that_is_replaced_is_a_warning(bb, drape, tmp_path):
    for made in (lambda: bb.run(drape, {"/time/steps": 1}, out=tmp_path), lambda: bb.Simulation(drape, {"/time/steps": 1}, out=tmp_path).run().finish()):
        bb.run(drape, {"/time/steps": 1}, out=tmp_path, replace=True)
        record = json.loads((tmp_path / "run.json").read_text())
        record["ids"]["build_id"] = "b" * 64
        (tmp_path / "run.json").write_text(json.dumps(record))
        with pytest.warns(UserWarning, match=re.escape(f"{tmp_path}/run.json is replaced when this run is over, which differs from it: another build")):
            made()


def test_a_warning_that_is_an_error_replaces_nothing(bb, drape, tmp_path):
    bb.run(drape, {"/time/steps": 1}, out=tmp_path)
    record = json.loads((tmp_path / "run.json").read_text())
    record["ids"]["build_id"] = "b" * 64
    text = json.dumps(record)
    (tmp_path / "run.json").write_text(text)
    with pytest.raises(UserWarning, match="is replaced when this run is over"):
        bb.run(drape, {"/time/steps": 1}, out=tmp_path)
    assert (tmp_path / "run.json").read_text() == text


def test_a_file_of_another_program_stays(bb, drape, tmp_path):
    (tmp_path / "run.json").write_text("mine")
    for made in (lambda: bb.run(drape, {"/time/steps": 1}, out=tmp_path), lambda: bb.Simulation(drape, {"/time/steps": 1}, out=tmp_path)):
        with pytest.raises(bb.ConfigError, match="no record of a run"):
            made()
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("run.json", "mine")]
