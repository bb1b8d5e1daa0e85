#!/usr/bin/env python3
"""Breaks one instruction of nvcc's PTX at a time and counts how many breaks the tests that run it notice.

    inject_faults.py ptx_samples                    tests by the name that bb_ptx_test gave them (test_NAME_faults is built)
    inject_faults.py ptx_samples ptx_linear:20      of ptx_linear at most so many of each kind and module, by a fixed seed
    inject_faults.py ptx_linear --cases='-*Long*'   without some cases: what those alone would notice survives
    inject_faults.py ptx_samples --out results/PTX_FAULTS

Kinds: barrier (left out), shuffle (another lane), guard (a conditional jump ahead is not taken), store and atomic (left
out). Only instructions that the tests run are broken; those that they do not run are the affair of coverage. Caught: a
test is red, crashes or does not end. A survivor whose reason stands in survivors.toml is equivalent. Exit code 0 when
at least 90 % of the others are caught, else 1; 2 for wrong arguments or tests that are not green to begin with."""

from __future__ import annotations

import argparse
import fnmatch
import json
import os
import random
import signal
import subprocess
import sys
import time
import tomllib
from collections import Counter, defaultdict
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from datetime import date
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LEAST = 0.9


@dataclass
class Fault:
    module: str
    number: int
    line: int
    kind: str
    kernel: str
    tests: list[str]
    verdict: str = ""
    why: str = ""


class FaultError(Exception):
    """Wrong arguments or a baseline that is not green."""


def executable(build: Path, test: str) -> Path:
    found = list(build.glob(f"tests/**/test_{test}_faults"))
    if len(found) != 1:
        raise FaultError(f"test_{test}_faults is not in {build}/tests; allowed: names of bb_ptx_test")
    return found[0]


def run(program: Path, fault: str, timeout: float, cases: str) -> tuple[int | None, str]:
    """Exit code, None when it did not end within `timeout` s of the processor's time, and output."""
    environment = {**os.environ, "BB_PTX_FAULT": fault}
    words = ["prlimit", f"--cpu={timeout:.0f}:{timeout + 5:.0f}", str(program), "--gtest_brief=1", f"--gtest_filter={cases}", *([] if fault == "list" else ["--gtest_fail_fast"])]
    try:
        done = subprocess.run(words, env=environment, capture_output=True, text=True, errors="replace", timeout=20 * timeout)
    except subprocess.TimeoutExpired:  # it waits
        return None, ""
    return None if done.returncode == -signal.SIGXCPU else done.returncode, done.stdout + done.stderr


def parse_list(output: str, test: str) -> list[Fault]:
    """The lines of list_faults() (report.hpp), of instructions that ran."""
    out = []
    for line in output.splitlines():
        if line.startswith("fault "):
            head, kernel = line[6:].split("; ", 1)
            module, number, ran, at, kind = head.split(" ", 4)
            if ran == "1":
                out.append(Fault(module, int(number), int(at), kind, kernel, [test]))
    return out


def parse_tests(words: list[str]) -> dict[str, int]:
    """NAME or NAME:SAMPLE; 0: all."""
    out = {}
    for word in words:
        name, _, sample = word.partition(":")
        if sample and (not sample.isdecimal() or int(sample) == 0):
            raise FaultError(f"'{word}': the sample is '{sample}'; allowed: a number from 1 on")
        out[name] = int(sample or 0)
    return out


def choose(faults: list[Fault], samples: dict[str, int], seed: int) -> list[Fault]:
    """Of each module and kind as many as the least sample of its tests."""
    groups = defaultdict(list)
    for fault in faults:
        groups[fault.module, fault.kind].append(fault)
    chosen = []
    for key in sorted(groups):
        group = groups[key]
        sample = min((samples[t] for f in group for t in f.tests if samples[t]), default=0)
        if sample and len(group) > sample:
            group = random.Random(f"{seed} {key}").sample(group, sample)
        chosen += sorted(group, key=lambda f: f.number)
    return chosen


def reason(fault: Fault, survivors: list[dict]) -> str:
    """Why nobody can see it; empty when that is not known."""
    for entry in survivors:
        if entry["kind"] == fault.kind and fnmatch.fnmatch(fault.kernel, entry["kernel"]) and entry.get("line", fault.line) == fault.line:
            return entry["reason"]
    return ""


def judge(fault: Fault, programs: dict[str, Path], survivors: list[dict], timeout: float, cases: str) -> None:
    for test in fault.tests:
        code, output = run(programs[test], f"{fault.module}:{fault.number}", timeout, cases)
        if code != 0:
            red = next((line for line in output.splitlines() if "FAILED  ]" in line or "what():" in line), "")
            fault.verdict, fault.why = "caught", "does not end" if code is None else red.strip()[:100] or f"exit code {code}"
            return
    fault.why = reason(fault, survivors)
    fault.verdict = "equivalent" if fault.why else "survived"


def report(faults: list[Fault], seconds: float, arguments: str) -> tuple[str, float]:
    """Markdown, and the share of those not equivalent that were caught."""
    counts = defaultdict(Counter)
    for fault in faults:
        counts[fault.kind][fault.verdict] += 1
    lines = ["# Faults injected into the PTX", "", f"Written on {date.today()} by `tests/ptx/inject_faults.py {arguments}`.", "", "| kind | caught | survived | equivalent |", "|---|---|---|---|"]
    for kind in sorted(counts):
        c = counts[kind]
        lines.append(f"| {kind} | {c['caught']} | {c['survived']} | {c['equivalent']} |")
    caught = sum(f.verdict == "caught" for f in faults)
    real = sum(f.verdict != "equivalent" for f in faults)
    share = caught / real if real else 0.0
    lines += ["", f"{caught} of {real} caught ({100 * share:.1f} %), {len(faults) - real} equivalent, {seconds:.0f} s.", ""]
    for verdict, title in (("survived", "Survived"), ("equivalent", "Equivalent")):
        listed = [f for f in faults if f.verdict == verdict]
        if listed:
            lines += [f"## {title}", "", "| kernel | kind | module and line | reason |", "|---|---|---|---|"]
            lines += [f"| `{f.kernel.removeprefix('void bb::exec::').split('(')[0]}` | {f.kind} | {f.module}:{f.line} | {f.why or 'not explained'} |" for f in listed]
            lines.append("")
    return "\n".join(lines), share


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("tests", nargs="+", help="NAME, or NAME:SAMPLE of each module and kind")
    parser.add_argument("--build", type=Path, default=ROOT / "build/release")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--timeout", type=float, default=120, help="s of the processor's time, of one run of one test")
    parser.add_argument("--cases", default="*", help="filter of GoogleTest: which cases have to notice")
    parser.add_argument("--kernel", default="*", help="pattern of the names of kernels")
    parser.add_argument("--out", type=Path, help="OUT.md and OUT.json")
    args = parser.parse_args()
    start = time.time()
    survivors = tomllib.loads((Path(__file__).parent / "survivors.toml").read_text())["survivor"]
    try:
        samples = parse_tests(args.tests)
        subprocess.run(["ninja", "-j", str(args.jobs), "-C", str(args.build), *[f"test_{t}_faults" for t in samples]], check=True, stdout=sys.stderr)
        programs = {test: executable(args.build, test) for test in samples}
        found: dict[tuple[str, int], Fault] = {}
        for test, program in programs.items():
            code, output = run(program, "list", 20 * args.timeout, args.cases)
            if code != 0:
                raise FaultError(f"test_{test}_faults is not green: exit code {code}\n{output[-2000:]}")
            for fault in parse_list(output, test):
                found.setdefault((fault.module, fault.number), Fault(**{**asdict(fault), "tests": []})).tests.append(test)
    except (FaultError, subprocess.CalledProcessError) as error:
        print(error, file=sys.stderr)
        return 2
    faults = choose([f for f in found.values() if fnmatch.fnmatch(f.kernel, args.kernel)], samples, args.seed)
    print(f"{len(faults)} of {len(found)} instructions are broken, one at a time", flush=True)
    with ThreadPoolExecutor(args.jobs) as pool:
        list(pool.map(lambda f: judge(f, programs, survivors, args.timeout, args.cases), faults))
    text, share = report(faults, time.time() - start, " ".join(sys.argv[1:]))
    print(text)
    if args.out:
        args.out.with_suffix(".md").write_text(text)
        args.out.with_suffix(".json").write_text(json.dumps({"date": str(date.today()), "arguments": sys.argv[1:], "faults": [asdict(f) for f in faults]}, indent=1) + "\n")
    return 0 if share >= LEAST else 1


if __name__ == "__main__":
    sys.exit(main())
