#!/usr/bin/env python3
"""What each kernel costs on the device: registers, stack, spills and accesses to local memory (ptxas, sm_90), FP64
instructions of its PTX, cache lines and sectors that a request of a warp touches in the tests.

    kernel_table.py --check              compares what is built with results/KERNELS.json; nothing is compiled or run
    kernel_table.py [--profile FILE]...  writes results/KERNELS.json and results/KERNELS.md

The kernels are those of the lists kernels.inc of modules (`room` in the table), their numbers those of the object files bb_device_ROOM. A check fails
(exit code 1) when registers, stack, accesses to local memory or FP64 instructions have grown, a kernel is new, gone or without its numbers, a kernel of PCG or of sums uses local
memory, or a buffer is read in more sectors than 1.2 times the least without a reason in gathers.toml. Where another
version of nvcc made the objects, only names are compared. Exit code 2: an object file is missing or not understood.

Spills are ptxas's and looked up when the table is written, for the kernels that use local memory. Lines and sectors come
from files that tests wrote (BB_PTX_PROFILE); kernels that are in none keep theirs."""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from embedded_ptx import embedded_ptx  # noqa: E402
from machine_code import MachineCodeError, machine_code  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
RESULT = ROOT / "results" / "KERNELS"
CODE = ("registers", "stack", "local", "fp64")  # of every row
WITHOUT_LOCAL = ("linear", "sums")  # modules
MOST = 1.2  # sectors of a request over the least
FP64 = re.compile(r"^\s*(?:@!?%p\d+\s+)?(?:add|sub|mul|fma|div|sqrt|rcp|neg|abs|min|max|setp|selp|cvt)\.[\w.]*f64\b", re.M)


class TableError(Exception):
    """A tool failed or a file is missing."""


def demangled(names: list[str]) -> list[str]:
    done = subprocess.run(["c++filt"], input="\n".join(names), capture_output=True, text=True, check=True)
    return [kernel_name(line) for line in done.stdout.splitlines()]


def kernel_name(text: str) -> str:
    """`void bb::exec::run_each<bb::exec::X>(long, ...)` -> `bb::exec::X`."""
    m = re.match(r"void bb::exec::run_(?:each|blocks)<(.*)>\(", text)
    return m[1].strip() if m else text


def short_name(name: str) -> str:
    """Without our namespaces."""
    return re.sub(r"\bbb::(exec::)?", "", name)


def fp64_counts(ptx: str) -> dict[str, int]:
    """Mangled name -> FP64 instructions of its text; device functions that it calls are not counted."""
    out = {}
    for m in re.finditer(r"\.entry\s+(\w+)\s*\([^)]*\)(.*?)^\}", ptx, re.S | re.M):
        out[m[1]] = len(FP64.findall(m[2]))
    return out


def object_file(build: Path, room: str) -> Path:
    found = list(build.glob(f"core/exec/cuda/CMakeFiles/bb_device_{room}.dir/**/{room}.cu.o"))
    if len(found) != 1:
        raise TableError(f"{build}: {len(found)} object files of the kernels of {room}, wanted 1: build the target bb_device_{room}")
    return found[0]


def kernels_of_room(path: Path) -> tuple[dict[str, dict], str]:
    """Mangled name -> registers, stack, local, fp64; version of the tools."""
    data = path.read_bytes()
    try:
        rows, version = machine_code(data)
        fp64 = fp64_counts(embedded_ptx(data))
    except (MachineCodeError, ValueError) as error:
        raise TableError(f"{path}: {error}") from None
    for name, row in rows.items():
        if name in fp64:
            row["fp64"] = fp64[name]
    return rows, version


def built(build: Path) -> dict:
    """{"nvcc": version, "kernels": {name: row}} of the object files."""
    folders = [p.parent for p in (ROOT / "core").rglob("kernels.inc")]
    rooms = sorted((f.parent if f.name == "executor" else f).name for f in folders)  # cmake/KernelLists.cmake
    versions, out = set(), {}
    for room in rooms:
        rows, version = kernels_of_room(object_file(build, room))
        versions.add(version)
        for mangled, name in zip(rows, demangled(list(rows)), strict=True):
            out[name] = {"room": room, "mangled": mangled, **rows[mangled]}
    if len(versions) != 1:
        raise TableError(f"{build}: object files of several versions of nvcc: {', '.join(sorted(versions))}")
    return {"nvcc": versions.pop(), "kernels": dict(sorted(out.items()))}


def ptxas_spills(log: str) -> dict[str, int]:
    """Mangled name -> bytes of spill stores and loads, of `ptxas -v`."""
    found = re.findall(r"Function properties for (\w+)\n.*?(\d+) bytes spill stores, (\d+) bytes spill loads", log)
    return {name: int(stores) + int(loads) for name, stores, loads in found}


def add_spills(now: dict, before: dict, build: Path, ptxas: str) -> None:
    """Without local memory there are none. Other kernels are compiled once more unless all their numbers are the table's."""
    kernels = now["kernels"]
    for name, row in kernels.items():
        old = before["kernels"].get(name, {}) if before.get("nvcc") == now["nvcc"] else {}
        same = "spills" in old and all(old.get(key) == row[key] for key in CODE)
        row["spills"] = 0 if not row["local"] else old["spills"] if same else None
    for room in sorted({row["room"] for row in kernels.values()}):
        requested = [row for row in kernels.values() if row["room"] == room and row["spills"] is None]
        if not requested:
            continue
        with tempfile.TemporaryDirectory() as folder:
            ptx = Path(folder) / "room.ptx"
            ptx.write_text(embedded_ptx(object_file(build, room).read_bytes()))
            entries = [word for row in requested for word in ("-e", row["mangled"])]
            done = subprocess.run([ptxas, "-v", "-arch=sm_90", *entries, "-o", f"{folder}/out.cubin", str(ptx)], capture_output=True, text=True)
        if done.returncode:
            raise TableError(f"ptxas, kernels of {room}: {done.stderr.strip()[-400:]}")
        spills = ptxas_spills(done.stderr)
        for row in requested:
            row["spills"] = spills[row["mangled"]]


def add_profiles(kernels: dict[str, dict], files: list[Path], before: dict[str, dict]) -> None:
    """Requests, lines and sectors a request, sectors over the least: of the kernel, and of each buffer that it touches."""
    sums: dict[str, dict[str, dict]] = {}
    for file in files:
        for row in json.loads(file.read_text())["kernels"]:
            for buffer, t in row["buffers"].items():
                into = sums.setdefault(row["name"], {}).setdefault(buffer, dict.fromkeys(t, 0))
                for key, n in t.items():
                    into[key] += n

    def means(t: dict) -> dict:
        n = t["requests"]
        return {"requests": n, "lines": round(t["lines"] / n, 2), "sectors": round(t["sectors"] / n, 2), "over_least": round(t["sectors"] / t["least"], 2)}

    for name, row in kernels.items():
        buffers = sums.get(row["mangled"], {})
        if buffers:
            every = {key: sum(t[key] for t in buffers.values()) for key in ("requests", "lines", "sectors", "least")}
            row.update(means(every), buffers={b: means(t) for b, t in sorted(buffers.items())})
        else:
            row.update({k: v for k, v in before.get(name, {}).items() if k in ("requests", "lines", "sectors", "over_least", "buffers")})


def differences(before: dict, now: dict) -> list[str]:
    """Sentences, one a number that grew and a kernel that is new, gone or lacks numbers. Names alone for another nvcc."""
    old, new = before["kernels"], now["kernels"]
    out = [f"{name}: not in {RESULT.name}.json" for name in new if name not in old]
    out += [f"{name}: in {RESULT.name}.json, but not built" for name in old if name not in new]
    for name, row in new.items():
        for which, have in (("the build", row), ("the table", old.get(name, row))):
            out += [f"{name}: {which} has no {key}" for key in CODE if key not in have]
        if row["room"] in WITHOUT_LOCAL and row.get("local"):
            out.append(f"{name}: {row['local']} accesses to local memory; a kernel of {row['room']} has none")
        if before.get("nvcc") != now["nvcc"] or name not in old:
            continue
        for key in CODE:
            a, b = old[name].get(key), row.get(key)
            if a is not None and b is not None and b > a:
                out.append(f"{name}: {key} {a} -> {b}")
    return out


def reason(name: str, buffer: str, gathers: list[dict]) -> str:
    """Why a buffer is not read in order; empty when that is not known."""
    return next((g["reason"] for g in gathers if g["kernel"] == short_name(name) and {buffer, "*"} & set(g["buffers"])), "")


def unexplained(table: dict, gathers: list[dict]) -> list[str]:
    """Sentences, one a buffer of a kernel of PCG or of sums that takes more than MOST times the least sectors."""
    out = []
    for name, row in table["kernels"].items():
        if row["room"] not in WITHOUT_LOCAL:
            continue
        if "buffers" not in row:
            out.append(f"{name}: the table has no lines and sectors")
        for buffer, t in row.get("buffers", {}).items():
            if t["over_least"] > MOST and not reason(name, buffer, gathers):
                out.append(f"{name}: '{buffer}' in {t['over_least']} times the least sectors, allowed {MOST}, and no reason in gathers.toml")
    return out


def markdown(table: dict, gathers: list[dict]) -> str:
    lines = [
        "# Kernels on the device",
        "",
        f"Made by nvcc {table['nvcc']}, ptxas for sm_90: registers; bytes of stack frame and of spills; local: instructions that",
        "access local memory, those of called functions included. FP64: instructions in the PTX. Lines (128 B) and sectors (32 B)",
        "a request of a warp, in the tests; of least: sectors over those that the bytes would fill side by side. Written by",
        "tests/ptx/kernel_table.py; `--check` fails when registers, stack, local or FP64 grow.",
        "",
        "| kernel | room | registers | stack | spills | local | FP64 | lines | sectors | of least |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    short = {name: short_name(name) for name in table["kernels"]}
    for name, row in table["kernels"].items():
        cells = [row.get(key, "") for key in ("room", "registers", "stack", "spills", "local", "fp64", "lines", "sectors", "over_least")]
        lines.append(f"| `{short[name]}` | " + " | ".join(str(c) for c in cells) + " |")
    lines += ["", f"## Buffers of PCG and of sums above {MOST} times the least", "", "| kernel | buffer | share of requests | lines | sectors | of least | why |", "|---|---|---|---|---|---|---|"]
    n_buffers = 0
    for name, row in table["kernels"].items():
        for buffer, t in row.get("buffers", {}).items() if row["room"] in WITHOUT_LOCAL else ():
            n_buffers += 1
            if t["over_least"] > MOST:
                lines.append(f"| `{short[name]}` | {buffer} | {t['requests'] / row['requests']:.2f} | {t['lines']} | {t['sectors']} | {t['over_least']} | {reason(name, buffer, gathers) or 'not explained'} |")
    lines += ["", f"All others of their {n_buffers} pairs of a kernel and a buffer are within {MOST}."]
    return "\n".join(lines) + "\n"


def check(before: dict, now: dict, gathers: list[dict]) -> list[str]:
    if before.get("nvcc") != now["nvcc"]:
        print(f"the objects were made by nvcc {now['nvcc']}, {RESULT.name}.json by {before.get('nvcc', 'an unknown one')}: only names are compared")
    return differences(before, now) + unexplained(before, gathers)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", type=Path, default=ROOT / "build/release")
    parser.add_argument("--ptxas", default="ptxas")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--profile", type=Path, action="append", default=[], help="file that a test wrote to BB_PTX_PROFILE")
    args = parser.parse_args()
    gathers = tomllib.loads((Path(__file__).parent / "gathers.toml").read_text())["gather"]
    try:
        now = built(args.build)
        before = json.loads(RESULT.with_suffix(".json").read_text())
        if args.profile or not args.check:
            add_profiles(now["kernels"], args.profile, before["kernels"])
        if args.check:
            worse = check(before, now, gathers)
            print("\n".join(worse) or f"{len(now['kernels'])} kernels, none grew")
            return 1 if worse else 0
        add_spills(now, before, args.build, args.ptxas)
    except (TableError, OSError) as error:
        print(error, file=sys.stderr)
        return 2
    for row in now["kernels"].values():
        del row["mangled"]
    RESULT.with_suffix(".json").write_text(json.dumps(now, indent=1) + "\n")
    RESULT.with_suffix(".md").write_text(markdown(now, gathers))
    print(f"{len(now['kernels'])} kernels: {RESULT}.json, {RESULT}.md")
    return 0


if __name__ == "__main__":
    sys.exit(main())
