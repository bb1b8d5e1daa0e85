"""A plan of as many runs as a sweep may have."""

import json
import random
import subprocess
import sys

from sweep_files import ROOT, planned

MANY = 100_000
MOST_BYTES = 500e6
MOST_SECONDS = 15  # of the processor; 4 to 5 on one that does nothing else

# A process inherits the peak of the one that forked it, and a test worker may hold a gigabyte: a small process forks the plan.
MEASURE = """
import json, resource, subprocess, sys
subprocess.run(sys.argv[2:], check=True)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
json.dump([used.ru_maxrss * 1024, used.ru_utime + used.ru_stime], open(sys.argv[1], "w"))
"""


def test_a_plan_of_100000_runs_takes_seconds_and_its_ids_are_those_of_single_runs(program, tmp_path):
    axes = [{"cases": [{"label": name, "set": {"/formulation": name}} for name in ("log", "cubic")]},
            {"pointer": "/time/dt_s", "range": {"from": 1e-3, "to": 1e-2, "count": 25}},
            {"pointer": "/formulation/d_hat_m", "range": {"from": 1e-3, "to": 1e-2, "count": 20}},
            {"pointer": "/formulation/stiffness_policy/kappa_N_per_m", "range": {"from": 1, "to": 1000, "count": 100, "scale": "log"}}]
    spec = tmp_path / "many.json"
    spec.write_text(json.dumps({"schema": "barrierbench.sweep/1", "name": "many", "base": str(ROOT / "configs/scenes/drape.json"),
                                "set": {"/scene/n": 8}, "axes": axes}))
    answer, used = tmp_path / "plan.txt", tmp_path / "used.json"
    with answer.open("w") as out:
        subprocess.run([sys.executable, "-c", MEASURE, used, program, "plan", spec, "--out", tmp_path / "runs"], stdout=out, check=True)
    bytes_used, seconds = json.loads(used.read_text())
    assert 0 < bytes_used < MOST_BYTES and 0 < seconds < MOST_SECONDS
    rows = [line.split() for line in answer.read_text().splitlines()[1 : MANY + 1]]
    assert [int(row[0]) for row in rows] == list(range(MANY)) and len({row[1] for row in rows}) == MANY
    for index in random.Random(1).sample(range(MANY), 5):
        [folder] = planned(program, spec, "--index", index)
        assert folder.rsplit("-", 1)[1] == rows[index][1][:8]
