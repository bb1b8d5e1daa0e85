"""Hostile input, given to the real program: one table (cases.py), one row a promise.

Every case ends within its time, within a bound on memory, with the exit code and the words that the table promises, without a
signal, and leaves nothing behind: no folder of an output that was refused, no half-written file.
"""

import os
import resource
import subprocess
from functools import lru_cache
from pathlib import Path

import pytest

from tests.hostile.case import Case
from tests.hostile.cases import CASES
from tests.hostile.files import PLUGIN_SOURCE, make

ROOT = Path(__file__).resolve().parents[2]
ADDRESS_SPACE = 3 << 30  # bytes


@lru_cache
def is_sanitized(program: str) -> bool:
    """The sanitizers' shadow memory needs an address space without a limit."""
    return b"__asan_init" in Path(program).read_bytes()


def library(path: Path, bad: str) -> None:
    """Compiles one of the hostile plugins; `bad` may say how many of its bytes are kept: wrong:100."""
    name, _, kept = bad.partition(":")
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", f"-DBAD={name}", f"-I{ROOT}", "-o", path, PLUGIN_SOURCE], check=True)
    if kept:
        os.truncate(path, int(float(kept) * path.stat().st_size))


def listing(folder: Path) -> set:
    return {str(p.relative_to(folder)) for p in folder.rglob("*")}


def test_the_table_is_large_and_every_name_its_own():
    assert len(CASES) >= 150
    assert len({case.name for case in CASES}) == len(CASES)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_hostile(program: str, tmp_path: Path, case: Case):
    for name, content in case.files.items():
        make(tmp_path / name, content)
    for name, bad in case.libraries.items():
        library(tmp_path / name, bad)
    before = listing(tmp_path)

    def limits() -> None:
        if not is_sanitized(program):
            resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if case.prepare:
            case.prepare()

    # a program with the address sanitizer leaves the signals of a crashing plugin to be seen from outside
    sanitizer = ":".join(filter(None, [os.environ.get("ASAN_OPTIONS"), "handle_segv=0"]))
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "2", "ASAN_OPTIONS": sanitizer, **case.environment}
    done = subprocess.run([program, *case.command], cwd=tmp_path, env=environment, input=case.stdin, capture_output=True,
                          check=False, timeout=case.seconds, preexec_fn=limits)

    reported = done.stderr.decode(errors="replace") + done.stdout.decode(errors="replace")
    assert done.returncode == case.code, (done.returncode, reported[:2000])
    for part in case.says:
        assert part in reported, (part, reported[:2000])
    assert "internal" not in reported
    assert len(reported) < 20000, "a message that nobody reads"
    left = listing(tmp_path) - before
    assert not [p for p in left if ".tmp" in p or p.endswith(".part")], left
    assert all(p.split("/")[0] in case.writes for p in left), left
