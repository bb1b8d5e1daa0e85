"""The verb microbenchmarks: the program of Google Benchmark, its JSON kept."""

from __future__ import annotations

import subprocess
from datetime import datetime, timezone

from barrierbench_analysis.io.errors import tells
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.program.building import ensure, folder

TARGET = "barrierbench_microbenchmarks"


@tells("dev microbenchmarks")
def main(argv: list[str]) -> int:
    ensure(TARGET)
    out = ROOT / "results/runs/microbenchmarks"
    out.mkdir(parents=True, exist_ok=True)
    kept = out / f"{datetime.now(timezone.utc):%Y-%m-%dT%H%M%SZ}.json"
    words = [
        str(folder("release") / "experiments/microbenchmarks" / TARGET),
        "--benchmark_out_format=json",
        f"--benchmark_out={kept}",
    ]
    return subprocess.run([*words, *argv], check=False).returncode
