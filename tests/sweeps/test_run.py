"""One run as pandas, numpy and scipy objects."""

import numpy as np
import pytest
from sweep_files import ROOT, bench

from barrierbench_analysis import RecordError, Run

HANG = ROOT / "configs/scenes/hang.json"


@pytest.fixture(scope="module")
def folder(program, tmp_path_factory):
    out = tmp_path_factory.mktemp("run") / "out"
    more = ["/time/steps=2", "/output/frames_every=1", "/output/matrices=true", "/passes/diagnose=true", "/scene/n=4", "/diagnose/tier=2"]
    done = bench(program, "run", HANG, "--out", out, *(word for one in more for word in ("--set", one)))
    assert done.returncode == 0, done.stderr
    return out


def test_every_part_of_a_run_is_typed(folder):
    run = Run(folder)
    assert run.outcome == "ok" and run.config["time"]["steps"] == 2 and run.scalars["steps"] == 2
    assert len(run.steps) == 2 and run.steps["newton_iterations"].sum() == len(run.trace) == run.scalars["newton_iterations"]
    assert len(run.cond) and set(run.cond["step"]) == {0, 1}
    steps, frames = zip(*run.frames())
    assert steps == (-1, 0, 1) and run.positions().shape == (3, *frames[0].vertices.shape)
    assert not np.array_equal(run.positions()[0], run.positions()[2])


def test_a_system_has_one_right_hand_side_and_its_vertices(folder):
    systems = list(Run(folder).systems())
    assert systems and [(s.step, s.iteration) for s in systems] == sorted((s.step, s.iteration) for s in systems)
    for system in systems:
        n = system.matrix.shape[0]
        assert system.rhs.shape == (n,) and np.abs(system.rhs).max() > 0 and abs(system.matrix - system.matrix.T).max() == 0
        assert system.coordinates_m.shape == (len(system.block_start) - 1, 3) and system.block_start[-1] == n


def test_a_matrix_that_is_not_the_one_of_the_record_is_refused(folder):
    victim = next((folder / "matrices").glob("*.mtx"))
    kept = victim.read_bytes()
    victim.write_bytes(kept + b"\n")
    with pytest.raises(RecordError, match="sha256"):
        list(Run(folder).systems())
    victim.write_bytes(kept)
