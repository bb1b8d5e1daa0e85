"""The verb tidy: clang-tidy over the sources, as many at once as there are jobs."""

from __future__ import annotations

import re
import subprocess
from concurrent.futures import ThreadPoolExecutor

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import tells
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.program.building import folder, job_count, regenerate, setup

from .sources import sources

TIDIED = ("core/", "barriers/", "experiments/")
OF_GCC = re.compile(
    r" -include [^ ]*cmake_pch\.hxx| -fpch-preprocess| -Winvalid-pch| --param=ggc-[^ ]*"
)  # these mean nothing to clang


@tells("dev tidy")
def main(argv: list[str]) -> int:
    setup()
    regenerate("dev")
    files = argv or [file for file in sources() if file.startswith(TIDIED) and file.endswith(".cpp")]
    base = folder("tidy")
    base.mkdir(parents=True, exist_ok=True)
    (base / "compile_commands.json").write_text(
        OF_GCC.sub("", input_file.read_text(folder("dev") / "compile_commands.json"))
    )

    def tidied(file: str) -> int:
        words = ["clang-tidy-14", "--quiet", "--extra-arg=-Wno-unknown-warning-option", "-p", str(base), file]
        return subprocess.run(words, cwd=ROOT, check=False).returncode

    with ThreadPoolExecutor(job_count()) as pool:
        return 1 if any(list(pool.map(tidied, files))) else 0
