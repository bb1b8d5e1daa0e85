"""The program that verbs run, and JSON objects that they read."""

from __future__ import annotations

import argparse
import json
import os
from pathlib import Path

RELEASE = Path(__file__).resolve().parents[1] / "build/release/experiments/barrierbench"


def built_program(error: type[Exception], more: str = "") -> Path:
    """BARRIERBENCH_PROGRAM, or the release build. Raises `error` where it is not built, with `more` after
    what to do.
    """
    path = Path(os.environ.get("BARRIERBENCH_PROGRAM", RELEASE))
    if not path.exists():
        raise error(f"{path} is not built: ./bench build{more}")
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


def read_object(path: Path, error: type[Exception]) -> dict:
    """A JSON object from a file. Raises `error`, which says what the file is instead."""
    try:
        data = json.loads(path.read_text())
    except OSError as fault:
        raise error(f"{path}: {fault.strerror}") from None
    except ValueError as fault:
        raise error(f"{path}: not JSON: {fault}") from None
    if not isinstance(data, dict):
        raise error(f"{path}: not a JSON object")
    return data
