"""A sweep that is killed again and again at random moments ends with the records of one that nobody disturbed.

SWEEP_KILLS=200 runs as many runs and kills as that (minutes); seeds are fixed, moments are what the machine makes of them.
"""

import os
import random
import signal
import time

from processes import started
from sweep_files import bench, left_over, records, results, write_sweep

KILLS = int(os.environ.get("SWEEP_KILLS", "6"))
LEAST_S, MOST_S = 0.03, 0.35  # from the start of a sweep to its kill


def kill_after(seconds: float, sweep, whole_group: bool) -> bool:
    """Whether it was still running. whole_group: its runs are killed with it; else they lose their parent."""
    time.sleep(seconds)
    if sweep.poll() is not None:
        return False
    if whole_group:
        os.killpg(sweep.pid, signal.SIGKILL)
    else:
        sweep.kill()
    sweep.communicate(timeout=60)
    return True


def test_kills_at_random_moments_leave_the_records_of_an_undisturbed_sweep(program, tmp_path):
    runs = {"pointer": "/time/steps", "range": {"from": 1500, "to": 1500 + KILLS - 1, "count": KILLS}}
    file, out, alone = write_sweep(tmp_path, runs, settings={"/output/checkpoint_every": 20}), tmp_path / "out", tmp_path / "alone"
    assert bench(program, "sweep", file, "--out", alone, "--jobs", 2).returncode == 0
    draw, killed, finished_before = random.Random(7), 0, []
    for k in range(KILLS):
        with started(program, "sweep", file, "--out", out, "--jobs", 2, start_new_session=True) as sweep:
            killed += kill_after(draw.uniform(LEAST_S, MOST_S), sweep, whole_group=k % 2 == 0)
        finished_before.append(len(list(out.glob("*/run.json"))))
    assert killed >= 0.9 * KILLS and finished_before[-1] < KILLS, (killed, finished_before)
    assert bench(program, "sweep", file, "--out", out, "--jobs", 2).returncode == 0
    found = records(out)
    assert len(found) == KILLS and results(out) == results(alone)
    assert any(record["status"]["resumed_from_step"] for record in found.values())
    assert not left_over(out) and not list(out.rglob("bench.lock"))
    print(f"{killed} kills, records there after each: {finished_before}")
