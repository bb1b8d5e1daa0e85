"""Three scenes of the catalogue from ten jittered starts each, with contacts, cut short: every seed passes, and one that fails is red. In less than
half a minute, since ./bench test runs it; ./bench study robust run makes whole scenes.
"""

from dataclasses import replace

import pytest
from own_spec import run, written

from barrierbench_analysis.io.record_file import read_record
from barrierbench_analysis.studies.rules import robust

SEEDS = list(range(1, 11))
STEPS = {"domino": 40, "friction-slope": 25, "beam-on-wedge": 40}  # of them some are in contact


@pytest.fixture(scope="module", params=STEPS)
def ten(request, program, tmp_path_factory):
    """The study, its rows and its records."""
    patch = pytest.MonkeyPatch()
    patch.setenv("BARRIERBENCH_PROGRAM", program)
    study = written(tmp_path_factory.mktemp(request.param), "robust", [request.param], **{"/time/steps": STEPS[request.param]})
    rows, folders = run(study)
    yield study, rows, [read_record(folder / "run.json") for folder in folders]
    patch.undo()


def test_every_jittered_start_passes(ten):
    study, rows, records = ten
    assert [row.place["seed"] for row in rows] == [str(seed) for seed in SEEDS] and {row.values["failed"] for row in rows} == {""}
    assert robust.rule(study, rows)["passed"] == len(SEEDS) and robust.judged(study, rows)[1]
    assert len({record["summary"]["state_hash"] for record in records}) == len(SEEDS)  # no two start alike
    assert all(record["summary"]["contacts"]["max"] > 0 and record["audit"]["motions"] > 0 for record in records)


def test_one_seed_that_fails_is_red(ten):
    study, rows, records = ten
    for change in ({"audit": {"crossings": 1}}, {"status": {"outcome": "newton_stall"}}, {"audit": {"motions": 0}}):
        changed = records[3] | {section: records[3][section] | values for section, values in change.items()}
        values = robust.measure(study, study.cells[3], changed)
        failed = [*rows[:3], replace(rows[3], values=values), *rows[4:]]
        (line,) = robust.judged(study, failed)[0][1:]
        assert "9/10" in line and "seed 4: " in line and not robust.judged(study, failed)[1]
        assert robust.rule(study, failed)["passed"] == len(SEEDS) - 1 and "| 9 of 10 |" in robust.rule(study, failed)["table"]
