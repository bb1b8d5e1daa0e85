"""The one place that starts the program: questions, queries of `eval`, sweeps; JSON objects from files."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
from pathlib import Path

from .errors import UserError

RELEASE = Path(__file__).resolve().parents[1] / "build/release/experiments/barrierbench"


def built_program(more: str = "") -> Path:
    """BARRIERBENCH_PROGRAM, or the release build. Errors: UserError where it is not built, with `more`
    after what to do.
    """
    path = Path(os.environ.get("BARRIERBENCH_PROGRAM", RELEASE))
    if not path.exists():
        raise UserError(f"{path} is not built: ./bench build{more}")
    return path


def plugin_argument(parser: argparse.ArgumentParser) -> None:
    """--plugin, as the program takes it; may be repeated."""
    parser.add_argument(
        "--plugin",
        action="append",
        default=[],
        metavar="FILE.so",
        help=(
            "a shared library with shapes, stiffness policies or integrators, loaded by every run; may be"
            " repeated (examples/plugins/README.md)"
        ),
    )


def plugin_words(plugins: list[str]) -> list[str]:
    """The arguments of the program, before its verb, that load these plugins."""
    return [word for file in plugins for word in ("--plugin", str(Path(file).resolve()))]


def started(*words: str, plugins: list[str] = (), **options) -> subprocess.CompletedProcess:
    """The program with these words, until it ends; what it says is kept unless `options` (of subprocess.run)
    say otherwise. Errors: UserError where it is not built. What its exit code means is the caller's.
    """
    said = {} if {"stdout", "stderr", "capture_output"} & set(options) else {"capture_output": True}
    command = [str(built_program()), *plugin_words(list(plugins)), *words]
    return subprocess.run(command, check=False, **{"text": True, **said, **options})


def run_sweep(
    file: Path, out: Path, *words: str, plugins: list[str] = (), **options
) -> subprocess.CompletedProcess:
    """Runs what is missing of a sweep file into `out`; otherwise as `started`."""
    return started("sweep", str(file), "--out", str(out), *words, plugins=plugins, **options)


def evaluated(queries: list[dict], plugins: list[str] = ()) -> list[dict]:
    """Answers of one process of `eval`, in order. Errors: UserError with the first one that is an error."""
    done = started("eval", plugins=plugins, input="".join(json.dumps(query) + "\n" for query in queries))
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    bad = next((answer["error"] for answer in answers if "error" in answer), None)
    if bad or len(answers) != len(queries):
        why = bad or done.stderr.strip()[:300]
        raise UserError(f"eval: {len(answers)} answers to {len(queries)} queries: {why}")
    return answers


def read_object(path: Path) -> dict:
    """A JSON object from a file. Errors: UserError, which says what the file is instead."""
    try:
        data = json.loads(path.read_text())
    except OSError as fault:
        raise UserError(f"{path}: {fault.strerror}") from None
    except ValueError as fault:
        raise UserError(f"{path}: not JSON: {fault}") from None
    if not isinstance(data, dict):
        raise UserError(f"{path}: not a JSON object")
    return data
