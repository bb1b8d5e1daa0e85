"""Verbs in a forked process (tests/forked.py) end as Python ends a process, whatever they return or raise."""

import resource
import subprocess
import sys
import time

import pytest

import tests.forked
from tests.forked import forked

ENOUGH = 60  # seconds


def ends(result=None, raises=None):
    def main(words):
        print("said", *words)
        if raises is not None:
            raise raises
        return result

    return main


def call(monkeypatch, tmp_path, main, timeout=ENOUGH, limits=lambda: None):
    monkeypatch.setattr(tests.forked, "main", main)
    return forked(["no", "verb"], tmp_path, {}, timeout, limits)


@pytest.mark.parametrize(("main", "code", "told"), [
    (ends(), 0, ""), (ends(0), 0, ""), (ends(3), 3, ""), (ends("wrong"), 1, "wrong\n"),
    (ends(raises=SystemExit()), 0, ""), (ends(raises=SystemExit(4)), 4, ""), (ends(raises=SystemExit("some words")), 1, "some words\n"),
], ids=["nothing", "0", "3", "text", "exit", "exit 4", "exit with a text"])  # fmt: skip
def test_the_code_is_that_of_python(monkeypatch, tmp_path, main, code, told):
    done = call(monkeypatch, tmp_path, main)
    assert (done.returncode, done.stdout, done.stderr.decode()) == (code, b"said no verb\n", told)


def test_an_error_is_a_traceback_and_1(monkeypatch, tmp_path):
    done = call(monkeypatch, tmp_path, ends(raises=ValueError("nobody expects it")))
    assert done.returncode == 1 and b"Traceback" in done.stderr and b"ValueError: nobody expects it" in done.stderr


def test_what_asks_for_more_memory_than_its_limit_is_refused_it(monkeypatch, tmp_path):
    def limits():
        resource.setrlimit(resource.RLIMIT_AS, (1 << 36, 1 << 36))

    done = call(monkeypatch, tmp_path, lambda words: len(bytearray(1 << 37)), limits=limits)
    assert done.returncode == 1 and b"MemoryError" in done.stderr


def test_what_hangs_is_ended(monkeypatch, tmp_path):
    with pytest.raises(subprocess.TimeoutExpired):
        call(monkeypatch, tmp_path, lambda words: time.sleep(ENOUGH), timeout=0.2)


def test_the_caller_keeps_its_own_streams_and_folder(monkeypatch, tmp_path):
    before = sys.stdout, sys.stderr
    call(monkeypatch, tmp_path, ends())
    assert (sys.stdout, sys.stderr) == before
