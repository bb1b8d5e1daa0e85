"""The verb demo: the sweeps of the README by the program, then their figures and their table."""

from __future__ import annotations

import importlib

from ..errors import tells
from ..places import ROOT
from ..program import started
from .building import ensure_program
from .table import HELP

OUT = ROOT / "results/runs/demo"


@tells("demo")
def main(argv: list[str]) -> int:
    if set(argv) & set(HELP):
        ensure_program()  # its help is that of the program
    done = started("demo", "--out", str(OUT), *argv, capture_output=False)
    if done.returncode != 0 or set(argv) & set(HELP):
        return done.returncode
    return importlib.import_module("analysis.figures.verb").main([str(OUT), str(OUT / "figures")])
