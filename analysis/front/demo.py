"""The verb demo: the sweeps of the README by the program, then their figures and their table."""

from __future__ import annotations

import importlib
import subprocess

from ..errors import tells
from .building import ensure_program
from .table import HELP
from .verbs import ROOT

OUT = ROOT / "results/runs/demo"


@tells("demo")
def main(argv: list[str]) -> int:
    done = subprocess.run([str(ensure_program()), "demo", "--out", str(OUT), *argv], check=False)
    if done.returncode != 0 or set(argv) & set(HELP):
        return done.returncode
    return importlib.import_module("analysis.figures.verb").main([str(OUT), str(OUT / "figures")])
