"""The record of another config in the folder of a run stays, unless `replace` lets it go."""

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


def test_a_file_of_another_program_stays(bb, drape, tmp_path):
    (tmp_path / "run.json").write_text("mine")
    for made in (lambda: bb.run(drape, {"/time/steps": 1}, out=tmp_path), lambda: bb.Simulation(drape, {"/time/steps": 1}, out=tmp_path)):
        with pytest.raises(bb.ConfigError, match="no record of a run"):
            made()
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("run.json", "mine")]
