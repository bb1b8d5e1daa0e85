"""The verb mutate: the campaign of tests/mutation."""

from __future__ import annotations

import subprocess
import sys

from barrierbench_analysis.io.errors import tells
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.program.building import setup
from barrierbench_analysis.program.verb_table import HELP


@tells("dev mutate")
def main(argv: list[str]) -> int:
    if not set(argv) & set(HELP):
        setup()
    return subprocess.run(
        [sys.executable, str(ROOT / "tests/mutation/mutate.py"), *argv], check=False
    ).returncode
