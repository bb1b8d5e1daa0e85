"""Hostile input, given to the verbs in Python through the front door: one table (cases_of_verbs.py), one row a promise.

Every case ends within its time and a bound on memory, with the exit code and the words of the table, without a traceback, and leaves
nothing behind. A FIFO that is opened would be waited for until the time is over.
"""

import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest

from tests.forked import forked
from tests.hostile.cases_of_verbs import VERBS, VerbCase
from tests.hostile.files import make

ROOT = Path(__file__).resolve().parents[2]
ADDRESS_SPACE = 8 << 30  # bytes: numpy and its threads take 3 of them
SECONDS = 120  # of a busy machine


def test_every_name_is_its_own():
    assert len(VERBS) >= 30 and len({case.name for case in VERBS}) == len(VERBS)


@pytest.mark.parametrize("case", VERBS, ids=lambda case: case.name)
def test_a_verb_in_python(program: str, tmp_path: Path, case: VerbCase):
    for name, content in case.files.items():
        make(tmp_path / name, content)
    before = {path.name for path in tmp_path.iterdir()}

    def limits() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))
        for number in case.closed:
            os.close(number)

    environment = {**os.environ, "BARRIERBENCH_PROGRAM": program, "OPENBLAS_NUM_THREADS": "1", **case.environment}
    if case.output or case.closed or case.environment:  # what the start of a process has to meet
        output = open(case.output, "wb") if case.output else subprocess.PIPE
        command = [sys.executable, ROOT / "analysis", *case.words]
        done = subprocess.run(command, cwd=tmp_path, env=environment, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.PIPE, check=False, timeout=SECONDS, preexec_fn=limits)
        if case.output:
            output.close()
    else:
        done = forked(list(case.words), tmp_path, environment, SECONDS, limits)
    reported = done.stderr.decode(errors="replace") + (done.stdout or b"").decode(errors="replace")
    assert done.returncode == case.code, (done.returncode, reported[-2000:])
    assert all(part in reported for part in case.says), reported[-2000:]
    assert "Traceback" not in reported and len(reported) < 20000
    assert {path.name for path in tmp_path.iterdir()} - before <= set(case.writes)
