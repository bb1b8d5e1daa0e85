"""A verb in a process of its own, and file size limits that stand for full disks."""

import os
import resource
import subprocess
import sys

from barrierbench_analysis.io.places import ROOT


def bench(*words, program=sys.executable, environment=None, at_most=None, **options):
    """Builds nothing. program: what it starts, if it comes to that."""
    return _started([str(ROOT / "analysis"), *map(str, words)], {"BARRIERBENCH_PROGRAM": str(program), **(environment or {})}, at_most, **options)


def python(code: str, folder, at_most=None):
    """A program of Python that imports `barrierbench_analysis`, in a folder."""
    return _started(["-c", code], {"PYTHONPATH": str(ROOT / "analysis/src")}, at_most, cwd=folder)


def _started(words, environment, at_most, **options):
    """at_most: every file that the process and its own processes write ends after so many bytes, as on a full disk; with 0 there is no folder for
    temporary files either. Python ignores the signal that goes with it, and of a compiled module it would keep the beginning."""
    if at_most is not None:
        environment = {**environment, "PYTHONDONTWRITEBYTECODE": "1"}
        options["preexec_fn"] = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (at_most, at_most))
    return subprocess.run([sys.executable, *words], env={**os.environ, **environment}, capture_output=True, text=True, check=False, timeout=120, **options)
