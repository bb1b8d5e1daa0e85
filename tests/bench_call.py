"""A verb in a process of its own, and file size limits that stand for full disks."""

import os
import resource
import subprocess
import sys

from analysis.places import ROOT


def bench(*words, program=sys.executable, environment=None, **options):
    """Builds nothing. program: what it starts, if it comes to that."""
    return subprocess.run([sys.executable, str(ROOT / "analysis"), *map(str, words)], env={**os.environ, "BARRIERBENCH_PROGRAM": str(program), **(environment or {})},
                          capture_output=True, text=True, check=False, timeout=120, **options)


def python(code: str, folder, **options):
    """A program of Python that imports `analysis`, in a folder."""
    return subprocess.run([sys.executable, "-c", code], cwd=folder, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False,
                          timeout=120, **options)


def at_most(size: int) -> dict:
    """Options of a process: every file that it and its processes write ends after so many bytes, as on a full disk; with 0 there is no folder for
    temporary files either. Python ignores the signal that goes with it."""
    return {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))}
