"""The one place that starts the program: questions, queries of `eval`, runs and sweeps."""

import json
import os
import shlex
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import NoReturn

from barrierbench_analysis.io.errors import UserError, passed_on
from barrierbench_analysis.io.places import ROOT

RELEASE = ROOT / "build/release/experiments/barrierbench"
ANSWERS_WITHIN_S = 20  # a list of names, of a build with sanitizers on a busy machine
MOST_OF_LIST = 1 << 16  # bytes


def built_program(more: str = "") -> Path:
    """BARRIERBENCH_PROGRAM, or the release build. Errors: UserError where it is not built, with `more`
    after what to do.
    """
    path = Path(os.environ.get("BARRIERBENCH_PROGRAM", RELEASE))
    if not path.exists():
        raise UserError(f"{path} is not built: ./bench build{more}")
    return path


def _is_program(path: Path) -> bool:
    """Whether it lists shapes, as the program does; it is not waited for long, nor read for ever."""
    streams = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
    with subprocess.Popen([str(path), "list", "shapes"], **streams) as process:
        alarm = threading.Timer(ANSWERS_WITHIN_S, process.kill)
        alarm.start()
        try:
            return b"cubic" in process.stdout.read(MOST_OF_LIST)
        finally:
            alarm.cancel()
            process.kill()


def require_program() -> None:
    """BARRIERBENCH_PROGRAM is tested once, whether it names the program: another one hangs, or answers
    what nobody can read. Errors: UserError.
    """
    path = built_program()
    if path.resolve() == RELEASE.resolve():
        return
    found = "no file that can be started" if not (path.is_file() and os.access(path, os.X_OK)) else ""
    try:
        found = found or ("" if _is_program(path) else "does not list shapes as barrierbench does")
    except OSError as fault:
        found = fault.strerror
    if found:
        raise UserError(f"BARRIERBENCH_PROGRAM: found {path}: {found}; allowed: a built program barrierbench")


def plugin_words(plugins: list[str]) -> list[str]:
    """The arguments of the program, before its verb, that load these plugins."""
    return [word for file in plugins for word in ("--plugin", str(Path(file).resolve()))]


def started(
    *words: str, plugins: list[str] = (), under: list[str] = (), **options
) -> subprocess.CompletedProcess:
    """The program with these words, until it ends, as an argument of another program where `under` names one;
    its output is kept unless `options` (of subprocess.run) take it. Errors: UserError where it is not
    built. What its exit code means is the caller's.
    """
    captured = {} if {"stdout", "stderr", "capture_output"} & set(options) else {"capture_output": True}
    command = [*under, str(built_program()), *plugin_words(list(plugins)), *words]
    return subprocess.run(command, check=False, **{"text": True, **captured, **options})


def begun(*words: str) -> subprocess.Popen:
    """The program with these words, not waited for; its errors can be read. Errors: as `started`."""
    command = [str(built_program()), *words]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)


def piped(*words: str) -> subprocess.Popen:
    """The program with these words, not waited for; its streams are pipes of bytes. Errors: as `started`."""
    streams = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
    return subprocess.Popen([str(built_program()), *words], **streams)


def in_shell(line: str, **options) -> subprocess.CompletedProcess:
    """A line of bash in which ./bench is the front door, which builds nothing; otherwise as `started`."""
    command = line.replace("./bench", shlex.join([sys.executable, str(ROOT / "analysis")]))
    environment = {**os.environ, "BARRIERBENCH_PROGRAM": str(built_program())}
    return subprocess.run(
        ["bash", "-c", command], check=False, capture_output=True, text=True, env=environment, **options
    )


def become(program: Path, words: list[str]) -> NoReturn:
    """Replaces this process by the program. Errors: UserError where it cannot be started.

    Python ignores SIGPIPE, and a program that is started this way would too: it would report a reader that
    has seen enough (`| head`) as an output that cannot be written.
    """
    sys.stdout.flush()
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    try:
        os.execv(program, [str(program), *words])
    except OSError as error:
        raise UserError(f"{program}: cannot be started: {error.strerror}; allowed: a program") from None


def run_sweep(
    file: Path, out: Path, *words: str, plugins: list[str] = (), **options
) -> subprocess.CompletedProcess:
    """Runs what is missing of a sweep file into `out`; otherwise as `started`."""
    return started("sweep", str(file), "--out", str(out), *words, plugins=plugins, **options)


def check_ended(done: subprocess.CompletedProcess, what: str) -> None:
    """Errors: UserError, with the first line of the program's message, where it did not end with 0. what: the
    file or run that it was started for, at the beginning of the message.
    """
    if done.returncode != 0:
        message = (done.stderr or "").strip() or (done.stdout or "").strip()
        first, *more = message.splitlines() or ["it printed nothing"]
        others = f" (and {len(more)} more lines)" if more else ""
        raise UserError(
            f"{what}the program ended with {done.returncode}: {first}{others}", passed_on(done.returncode)
        )


def shape_names(plugins: list[str] = ()) -> list[str]:
    """Shapes that the program has with these plugins. Errors: UserError with what it says."""
    done = started("list", "shapes", plugins=plugins)
    if done.returncode != 0:
        raise UserError(done.stderr.strip())
    return [line.split()[0] for line in done.stdout.splitlines() if line[:1] == " " and line.split()]


def settings_words(settings: dict) -> list[str]:
    """The arguments of the program that place settings (pointer -> value) over a config."""
    return [
        word for pointer, value in settings.items() for word in ("--set", f"{pointer}={json.dumps(value)}")
    ]


def finished(*words: str, what: str = "") -> subprocess.CompletedProcess:
    """The program with these words, which ended with 0. Errors: as `started`, and check_ended."""
    done = started(*words)
    check_ended(done, what)
    return done


def evaluated(queries: list[dict], plugins: list[str] = ()) -> list[dict]:
    """Answers of one process of `eval`, in order. Errors: UserError with the first one that is an error."""
    done = started("eval", plugins=plugins, input="".join(json.dumps(query) + "\n" for query in queries))
    try:
        answers = [json.loads(line) for line in done.stdout.splitlines()]
    except ValueError:
        raise UserError(f"eval: an answer of {built_program()} is no JSON: {done.stdout[:80]!r}") from None
    bad = next((answer["error"] for answer in answers if "error" in answer), None)
    if bad or len(answers) != len(queries):
        why = bad or done.stderr.strip()[:300]
        raise UserError(f"eval: {len(answers)} answers to {len(queries)} queries: {why}")
    return answers
