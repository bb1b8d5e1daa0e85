"""Three scenes of the catalogue from ten jittered starts each, with contacts, cut short: every seed passes, and one that fails is red. In less than
half a minute, since ./bench test runs it; ./bench study robust runs whole scenes.
"""

import pytest

from barrierbench_analysis.studies.catalogue import robust
from barrierbench_analysis.studies.catalogue.entry import read_entry
from barrierbench_analysis.studies.catalogue.runs import run_scene

SEEDS = list(range(1, 11))
STEPS = {"domino": 40, "friction-slope": 25, "beam-on-wedge": 40}  # of them some are in contact


@pytest.fixture(scope="module", params=STEPS)
def ten(request, program, tmp_path_factory):
    patch = pytest.MonkeyPatch()
    patch.setenv("BARRIERBENCH_PROGRAM", program)
    entry = read_entry(request.param)
    entry.data["mini"]["set"]["/time/steps"] = STEPS[request.param]
    yield entry, run_scene(entry, ["log"], tmp_path_factory.mktemp(request.param), SEEDS)
    patch.undo()


def test_every_jittered_start_passes(ten):
    entry, runs = ten
    (row,) = robust.rows_of(entry, runs)
    assert row["seeds"] == row["passed"] == len(SEEDS) and row["failed"] == ""
    assert len({run.record["summary"]["state_hash"] for run in runs}) == len(SEEDS)  # no two start alike
    assert all(run.record["summary"]["contacts"]["max"] > 0 and run.record["audit"]["motions"] > 0 for run in runs)


def test_one_seed_that_fails_is_red(ten):
    entry, runs = ten
    for change in (lambda r: r["audit"].update(crossings=1), lambda r: r["status"].update(outcome="newton_stall"), lambda r: r["audit"].update(motions=0)):
        kept = {name: dict(runs[3].record[name]) for name in ("audit", "status")}
        change(runs[3].record)
        (row,) = robust.rows_of(entry, runs)
        runs[3].record.update(kept)
        assert row["passed"] == len(SEEDS) - 1 and row["failed"].startswith("seed 4: ")
