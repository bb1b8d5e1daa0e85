"""A verb in Python in a process of its own that need not import its libraries again: they take most of its time.

The process is forked from that of pytest. What belongs to the start of a process (streams that a shell has closed, the locale, what is
imported) is judged by tests that start Python.
"""

import contextlib
import importlib
import os
import select
import signal
import subprocess
import sys
import tempfile
import traceback
import warnings
from collections.abc import Callable
from pathlib import Path

from barrierbench_analysis.program import streams, verbs
from barrierbench_analysis.front.door import main
from barrierbench_analysis.io.errors import UserError


def _status(code: object) -> int:
    """As Python ends a process: nothing is 0, and what is not a number is printed and 1."""
    if code is None or isinstance(code, int):
        return code or 0
    print(code, file=sys.stderr)
    return 1


def _child(words: list[str], cwd: Path, environment: dict[str, str], files: tuple, limits: Callable[[], None]) -> int:
    for number, file in enumerate(files):
        os.dup2(file.fileno(), number)
    sys.stdin, sys.stdout, sys.stderr = (open(number, mode, closefd=False) for number, mode in enumerate("rww"))
    sys.__stdout__, sys.__stderr__ = sys.stdout, sys.stderr
    os.chdir(cwd)
    os.environ.clear()
    os.environ.update(environment)
    limits()
    try:
        streams.prepare()
        return _status(main(words))
    except SystemExit as ended:
        return _status(ended.code)
    except BaseException:  # noqa: BLE001 (as Python ends a process)
        traceback.print_exc()
        return 1
    finally:
        sys.stdout.flush()
        sys.stderr.flush()


def forked(words: list[str], cwd: Path, environment: dict[str, str], timeout: float, limits: Callable[[], None] = lambda: None) -> subprocess.CompletedProcess:
    """As subprocess.run of python analysis WORDS, with nothing to read. Errors: TimeoutExpired."""
    with contextlib.suppress(UserError):
        if (found := verbs.call_of(words)) and getattr(found.row, "module", ""):
            importlib.import_module(f"barrierbench_analysis.{found.row.module}")
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err, open(os.devnull) as nothing:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # threads of numpy wait for work, and are not queried in the child
            child = os.fork()
        if child == 0:
            code = 1
            try:
                code = _child(words, cwd, environment, (nothing, out, err), limits)
            finally:
                os._exit(code if isinstance(code, int) else 1)  # whatever happens, the child is no second pytest
        ended = os.pidfd_open(child)
        in_time = bool(select.select([ended], [], [], timeout)[0])
        os.close(ended)
        if not in_time:
            os.kill(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
        if not in_time:
            raise subprocess.TimeoutExpired(words, timeout)
        out.seek(0), err.seek(0)
        return subprocess.CompletedProcess(words, os.waitstatus_to_exitcode(status), out.read(), err.read())
