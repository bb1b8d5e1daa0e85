"""Fuzzing: builds the targets of tests/fuzz with clang, which this verb alone installs, runs them and prints
one table.

Every target starts from seeds that its build writes (fuzz_seeds) and from the corpus of earlier runs in
build/fuzz/corpus. A crash, a report of a sanitizer, a leak or an input that takes longer than 10 s ends the
target; the input is kept. Exit code 1 when there was one, 2 for a wrong request.
"""

import json
import os
import re
import subprocess
import sys
import time
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.text_table import aligned
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program import building
from barrierbench_analysis.program.arguments import count_from_1, options, parser_of

BUILD = ROOT / "build" / "fuzz"
CRASHES = ROOT / "results" / "runs" / "fuzz"
# Longest input: what a target's seeds need, and short enough that an execution stays below a millisecond.
MAX_LEN = {"config": 4096, "record": 16384, "sweep": 2048, "trace": 8192}
# Short stacks of allocations and a small quarantine: a third faster, and a report still names its place.
SANITIZER = {"ASAN_OPTIONS": "malloc_context_size=3:quarantine_size_mb=8:detect_leaks=1"}
LIMITS = ["-timeout=10", "-rss_limit_mb=2048", "-print_final_stats=1", "-verbosity=1"]


def targets() -> list[str]:
    text = input_file.read_text(ROOT / "tests" / "fuzz" / "targets.inc")
    return re.findall(r"^BB_FUZZ_TARGET\((\w+)\)", text, re.MULTILINE)


def chosen(names: list[str]) -> list[str]:
    known = targets()
    for name in names:
        if name not in known:
            raise UserError(f"found target {name!r}; allowed: {', '.join(known)}")
    return names or known


def parse_log(text: str) -> dict:
    """Executions and coverage out of what libFuzzer says; coverage is None where it never came so far."""
    cov = [int(n) for n in re.findall(r"\bcov: (\d+)", text)]
    started = re.search(r"INITED cov: (\d+)", text)
    stats = dict(re.findall(r"stat::(\w+):\s+(\d+)", text))
    last = re.findall(r"^#(\d+)\s", text, re.MULTILINE)
    executions = int(stats.get("number_of_executed_units", last[-1] if last else 0))
    return {
        "executions": executions,
        "coverage": max(cov, default=None),
        "new_coverage": max(cov) - int(started.group(1)) if cov and started else None,
    }


def _command(
    name: str, build: Path, kept: Path, seconds: int | None, runs: int | None, seed: int
) -> list[str]:
    """The target with its limits and its dictionary, where it has one; findings go to `kept`."""
    words = [
        str(build / "tests" / "fuzz" / f"fuzz_{name}"),
        *LIMITS,
        f"-max_len={MAX_LEN.get(name, 1024)}",
        f"-seed={seed}",
        f"-artifact_prefix={kept}/",
        f"-runs={runs}" if runs is not None else f"-max_total_time={seconds}",
    ]
    dictionary = build / "seeds" / f"{name}.dict"
    if dictionary.is_file() and dictionary.stat().st_size > 0:
        words.append(f"-dict={dictionary}")
    return [*words, str(build / "corpus" / name), str(build / "seeds" / name)]


def run_target(
    name: str, build: Path, crashes: Path, seconds: int | None, runs: int | None, seed: int
) -> dict:
    """One target until its seconds or runs are over, or to its first finding. A run without any execution is
    a failure too.
    """
    corpus, kept = build / "corpus" / name, crashes / name
    corpus.mkdir(parents=True, exist_ok=True)
    kept.mkdir(parents=True, exist_ok=True)
    before = {path.name for path in kept.iterdir()}
    words = _command(name, build, kept, seconds, runs, seed)
    start = time.monotonic()
    streams = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
    done = subprocess.run(words, **streams, check=False, cwd=kept, env={**os.environ, **SANITIZER})
    took = time.monotonic() - start
    log = done.stderr.decode(errors="replace")
    found = [str(path) for path in sorted(kept.iterdir()) if path.name not in before]
    row = {"target": name, **parse_log(log), "seconds": took}
    row |= {"findings": found, "failed": done.returncode != 0}
    if row["failed"]:
        write_whole(kept / "log.txt", log)
        row["findings"] = found or [str(kept / "log.txt")]
    row["failed"] = row["failed"] or row["executions"] == 0
    return row


def table(rows: list[dict]) -> str:
    head = ["target", "executions", "seconds", "executions/s", "coverage", "new coverage", "crashes"]
    lines = []
    for row in rows:
        rate = row["executions"] / row["seconds"] if row["seconds"] > 0 else 0
        counts = [f"{row['executions']:,}", f"{row['seconds']:.0f}", f"{rate:,.0f}"]
        seen = ["-" if row[key] is None else str(row[key]) for key in ("coverage", "new_coverage")]
        lines.append([row["target"], *counts, *seen, str(int(row["failed"]))])
    executions, seconds, failed = (
        sum(row[key] for row in rows) for key in ("executions", "seconds", "failed")
    )
    lines.append(["all", f"{executions:,}", f"{seconds:.0f}", "", "", "", str(failed)])
    return "\n".join(aligned(head, lines, set(range(1, len(head)))))


def prepare(names: list[str]) -> None:
    """Targets and seeds. Errors: UserError where clang cannot be installed or something does not build."""
    building.setup("clang", "libclang-rt-14-dev")
    building.build("fuzz", "fuzz_seeds", *(f"fuzz_{name}" for name in names))
    subprocess.run(
        [str(BUILD / "tests/fuzz/fuzz_seeds"), str(BUILD / "seeds")],
        check=True,
        env={**os.environ, "ASAN_OPTIONS": "detect_leaks=0"},
    )


@reported("dev fuzz")
def main(argv: list[str]) -> int:
    parser = parser_of("dev fuzz", __doc__.split("\n\n", 1)[1])
    length = parser.add_mutually_exclusive_group()
    text = "--seconds: for each target (default 30)\n--runs: executions of each target"
    options(length, text, seconds={"type": count_from_1, "default": 30}, runs=count_from_1)
    text = f"""
targets TARGET: of {", ".join(targets())} (default: all)
--seed: of libFuzzer; the corpus of earlier runs matters too (default 1)
--json: file of everything that the table shows"""
    options(parser, text, targets={"nargs": "*"}, seed={"type": count_from_1, "default": 1}, json=Path)
    arguments = parser.parse_args(argv)
    names = chosen(arguments.targets)
    prepare(names)
    rows = []
    for name in names:
        print(f"bench: fuzzing {name}", file=sys.stderr, flush=True)
        rows.append(run_target(name, BUILD, CRASHES, arguments.seconds, arguments.runs, arguments.seed))
    print(table(rows))
    for row in rows:
        for finding in row["findings"]:
            print(f"{row['target']}: {finding}")
    if arguments.json:
        write_whole(arguments.json, json.dumps(rows, indent=1) + "\n")
    return 1 if any(row["failed"] for row in rows) else 0
