"""The verb format: C++ by clang-format, the Python of analysis/ and python/ by ruff, in place."""

from __future__ import annotations

import subprocess
import sys

from barrierbench_analysis.io.errors import UserError, tells
from barrierbench_analysis.io.places import ROOT

from .sources import sources

RUFF = (sys.executable, "-m", "ruff")


def clang_format(*words: str) -> int:
    """Exit code of clang-format on every C++ file."""
    try:
        return subprocess.run(["clang-format-14", *words, *sources()], cwd=ROOT, check=False).returncode
    except FileNotFoundError:
        raise UserError("clang-format-14 is needed: ./bench setup") from None


def ruff(verb: str, *words: str) -> int:
    """Exit code of `ruff format` or `ruff check` on analysis/ and python/."""
    return subprocess.run(
        [*RUFF, verb, "--no-cache", *words, "analysis", "python"], cwd=ROOT, stdout=sys.stderr, check=False
    ).returncode


@tells("dev format")
def main(argv: list[str]) -> int:
    if argv:
        raise UserError(f"found {argv[0]!r}; allowed: no arguments")
    return max(clang_format("-i"), ruff("format", "--quiet"))
