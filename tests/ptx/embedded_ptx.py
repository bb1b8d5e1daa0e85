#!/usr/bin/env python3
"""The PTX in an object file of nvcc, which carries it as plain text (-Xfatbin=-compress=false).

    embedded_ptx.py OBJECT OUT.ptx"""
import re
import sys
from pathlib import Path

# A module begins with its version and ends with a zero.
MODULE = re.compile(rb"\.version \d+\.\d+\n\.target sm_\d+\w*\n\.address_size 64\n[^\0]*")


def embedded_ptx(data: bytes) -> str:
    """Errors: ValueError unless there is one module, and it is whole."""
    found = MODULE.findall(data)
    if len(found) != 1:
        raise ValueError(f"{len(found)} PTX modules in plain text, wanted 1")
    text = found[0].decode("ascii")
    if ".entry" not in text or not text.rstrip().endswith("}"):
        raise ValueError("the PTX has no kernel or is cut short")
    return text


def main() -> int:
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        text = embedded_ptx(Path(sys.argv[1]).read_bytes())
    except (ValueError, OSError) as error:
        print(f"{sys.argv[1]}: {error}", file=sys.stderr)
        return 1
    Path(sys.argv[2]).write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
