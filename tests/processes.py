"""Processes of the program that a test stops on their way.

A test waits for what a process has written, never for a time: on a busy machine no time is long enough. tests/front/test_form.py
holds the tests to it.
"""

import signal
import subprocess
import time
from contextlib import contextmanager
from pathlib import Path


def _hears_hang_ups():
    """Also where the tests themselves were started with nohup, which programs inherit."""
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


@contextmanager
def started(program: str, *words, **options):
    """A process that never outlives the test."""
    options.setdefault("preexec_fn", _hears_hang_ups)
    with subprocess.Popen([program, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options) as process:
        try:
            yield process
        finally:
            process.kill()


def wait_for(holds, seconds: float = 60, goes_on=lambda: True) -> bool:
    """Waits until holds() is true, as long as goes_on() is; returns whether it is. Fails when the time is over: something hangs."""
    end = time.monotonic() + seconds
    while not holds():
        if not goes_on():
            return False
        assert time.monotonic() < end, "it did not come so far"
        time.sleep(0.0005)
    return goes_on()


def comes_to(holds, process: subprocess.Popen, seconds: float = 60) -> bool:
    """Whether holds() was true while the process ran."""
    return wait_for(holds, seconds, goes_on=lambda: process.poll() is None)


def wait_until(holds, process: subprocess.Popen, seconds: float = 60) -> None:
    """Waits until holds() is true, while the process runs."""
    assert comes_to(holds, process, seconds), process.communicate()


def new_checkpoints(folder: Path, n: int):
    """Whether a run has written n checkpoints into its folder since this call: a condition to wait for.

    Two that are written between two looks count as one.
    """
    def state() -> list:
        """Of the checkpoint that is replaced, and of the one that is written over."""
        out = []
        for name in ("checkpoint.bin", "checkpoint.next.bin"):
            try:
                found = (folder / name).stat()
                out.append((found.st_ino, found.st_mtime_ns))
            except FileNotFoundError:
                out.append(None)
        return out

    last, seen = state(), 0

    def are_there() -> bool:
        nonlocal last, seen
        now = state()
        seen, last = seen + (now != last and now[0] is not None), now
        return seen >= n

    return are_there
