#!/usr/bin/env python3
"""What each kernel costs on the device: registers, stack and spills (ptxas, sm_90), FP64 instructions of its PTX, cache
lines and sectors that a request of a warp touches in the tests.

    kernel_table.py --build build/release             writes results/KERNELS.json and results/KERNELS.md
    kernel_table.py --build build/release --check     compares with results/KERNELS.json, writes nothing: exit code 1 when
                                                      a number has grown or a kernel is new, naming kernel and number

The kernels are those of core/resident/*/kernels.inc. Lines and sectors come from the tests that run them, if they were
built (bb_ptx_test); without one they are left out and not compared."""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RESULT = ROOT / "results" / "KERNELS"
GROWTH = {"registers": 0, "stack": 0, "spills": 0, "fp64": 0, "lines": 0.005, "sectors": 0.005}  # allowed, rounding of the table
FP64 = re.compile(r"^\s*(?:@!?%p\d+\s+)?(?:add|sub|mul|fma|div|sqrt|rcp|neg|abs|min|max|setp|selp|cvt)\.[\w.]*f64\b", re.M)


class TableError(Exception):
    """A tool failed or a file is missing."""


def demangled(names: list[str]) -> list[str]:
    done = subprocess.run(["c++filt"], input="\n".join(names), capture_output=True, text=True, check=True)
    return [kernel_name(line) for line in done.stdout.splitlines()]


def kernel_name(text: str) -> str:
    """`void bb::exec::run_each<bb::resident::X>(long, ...)` -> `bb::resident::X`."""
    m = re.match(r"void bb::exec::run_(?:each|blocks)<(.*)>\(", text)
    return m[1].strip() if m else text


def ptxas_numbers(log: str) -> dict[str, dict]:
    """Mangled name -> registers, stack, spills, of `ptxas -v`."""
    out: dict[str, dict] = {}
    name = ""
    for line in log.splitlines():
        if m := re.search(r"Compiling entry function '(\w+)'", line):
            name = m[1]
            out[name] = {"registers": 0, "stack": 0, "spills": 0}
        elif m := re.search(r"Function properties for (\w+)", line):
            name = m[1] if m[1] in out else ""
        elif (m := re.search(r"(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads", line)) and name:
            out[name].update(stack=int(m[1]), spills=int(m[2]) + int(m[3]))
            name = ""
        elif m := re.search(r"Used (\d+) registers", line):
            last = list(out)[-1]
            out[last]["registers"] = int(m[1])
    return out


def fp64_counts(ptx: str) -> dict[str, int]:
    """Mangled name -> FP64 instructions of its text; device functions that it calls are not counted."""
    out = {}
    for m in re.finditer(r"\.entry\s+(\w+)\s*\([^)]*\)(.*?)^\}", ptx, re.S | re.M):
        out[m[1]] = len(FP64.findall(m[2]))
    return out


def compile_room(ptxas: str, ptx: Path) -> dict[str, dict]:
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([ptxas, "-v", "-arch=sm_90", "-o", f"{folder}/out.cubin", str(ptx)], capture_output=True, text=True)
    if done.returncode:
        raise TableError(f"ptxas {ptx}: {done.stderr.strip()[-400:]}")
    rows = ptxas_numbers(done.stderr)
    for name, n in fp64_counts(ptx.read_text()).items():
        rows[name]["fp64"] = n
    return rows


def profiles(build: Path) -> dict[str, list[int]]:
    """Mangled name -> requests, lines, sectors, over all PTX tests that were built."""
    out: dict[str, list[int]] = {}
    for program in sorted(build.glob("tests/ptx/test_ptx_*")):
        if program.name.endswith("_faults") or not os.access(program, os.X_OK) or program.is_dir():
            continue
        with tempfile.NamedTemporaryFile(suffix=".json") as file:
            subprocess.run([str(program)], env={**os.environ, "BB_PTX_PROFILE": file.name}, stdout=subprocess.DEVNULL, check=False)
            text = Path(file.name).read_text()
        for row in json.loads(text)["kernels"] if text else []:
            sums = out.setdefault(row["name"], [0, 0, 0])
            for i, key in enumerate(("requests", "lines", "sectors")):
                sums[i] += row[key]
    return out


def table(build: Path, ptxas: str) -> dict[str, dict]:
    rooms = sorted(p.parent.name for p in (ROOT / "core/resident").glob("*/kernels.inc"))
    traffic = profiles(build)
    out: dict[str, dict] = {}
    for room in rooms:
        ptx = build / "tests/ptx" / f"ptx_{room}.ptx"
        if not ptx.exists():
            raise TableError(f"{ptx} is not there: build the target ptx_{room}")
        rows = compile_room(ptxas, ptx)
        for mangled, name in zip(rows, demangled(list(rows)), strict=True):
            row = {"room": room, **rows[mangled]}
            requests, lines, sectors = traffic.get(mangled, (0, 0, 0))
            if requests:
                row.update(lines=round(lines / requests, 2), sectors=round(sectors / requests, 2))
            out[name] = row
    return dict(sorted(out.items()))


def grown(before: dict[str, dict], now: dict[str, dict]) -> list[str]:
    """Sentences, one a number that grew or a kernel that is not in the table."""
    out = []
    for name, row in now.items():
        if name not in before:
            out.append(f"{name}: not in {RESULT.name}.json")
            continue
        for key, allowed in GROWTH.items():
            old, new = before[name].get(key), row.get(key)
            if old is not None and new is not None and new > old + allowed:
                out.append(f"{name}: {key} {old} -> {new}")
    return out


def markdown(rows: dict[str, dict]) -> str:
    lines = [
        "# Kernels on the device",
        "",
        "Registers, stack and spills in bytes: ptxas for sm_90. FP64: instructions in the PTX. Lines (128 B) and sectors",
        "(32 B) a request of a warp, in the tests. Written by tests/ptx/kernel_table.py; `--check` fails when a number grows.",
        "",
        "| kernel | room | registers | stack | spills | FP64 | lines | sectors |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for name, row in rows.items():
        cells = [row.get(key, "") for key in ("room", "registers", "stack", "spills", "fp64", "lines", "sectors")]
        lines.append(f"| `{name.replace('bb::resident::', '')}` | " + " | ".join(str(c) for c in cells) + " |")
    return "\n".join(lines) + "\n"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", type=Path, default=ROOT / "build/release")
    parser.add_argument("--ptxas", default="ptxas")
    parser.add_argument("--check", action="store_true")
    args = parser.parse_args()
    try:
        rows = table(args.build, args.ptxas)
    except (TableError, OSError) as error:
        print(error, file=sys.stderr)
        return 2
    if args.check:
        worse = grown(json.loads(RESULT.with_suffix(".json").read_text())["kernels"], rows)
        print("\n".join(worse) or f"{len(rows)} kernels, none grew")
        return 1 if worse else 0
    RESULT.with_suffix(".json").write_text(json.dumps({"kernels": rows}, indent=1) + "\n")
    RESULT.with_suffix(".md").write_text(markdown(rows))
    print(f"{len(rows)} kernels: {RESULT}.json, {RESULT}.md")
    return 0


if __name__ == "__main__":
    sys.exit(main())
