#!/usr/bin/env python3
"""Translates the PTX that nvcc emits into C++ that runs on the CPU (runtime.hpp, machine.hpp).

    translate.py KERNELS.ptx KERNELS.cpp [--module NAME] [--faults]

One C++ function a kernel or device function, one variable a register, one goto a branch. Loads, stores, barriers and
shuffles are calls into the checked run time and carry their line of the PTX. Each straight-line piece of code leaves a
mark when it runs, so that what was executed can be counted. An instruction that is not known is an error that names
its line and text (exit code 2), never a guess.

With --faults every barrier, store, atomic, conditional jump ahead and shuffle can be broken, one at a time, by the
environment variable BB_PTX_FAULT=MODULE:NUMBER (inject_faults.py)."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from translator import Unknown, translate  # noqa: E402


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("ptx", type=Path)
    parser.add_argument("cpp", type=Path)
    parser.add_argument("--module", help="its name in messages (the file's by default)")
    parser.add_argument("--faults", action="store_true", help="with switches that break one instruction at a time")
    args = parser.parse_args()
    try:
        args.cpp.write_text(translate(args.ptx.read_text(), args.module or args.ptx.stem, args.faults))
    except Unknown as error:
        print(f"{args.ptx}: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
