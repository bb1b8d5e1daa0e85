"""The verb mutate: the campaign of tests/mutation."""

from __future__ import annotations

import subprocess
import sys

from ..errors import tells
from ..places import ROOT
from .building import setup
from .table import HELP


@tells("mutate")
def main(argv: list[str]) -> int:
    if not set(argv) & set(HELP):
        setup()
    return subprocess.run(
        [sys.executable, str(ROOT / "tests/mutation/mutate.py"), *argv], check=False
    ).returncode
