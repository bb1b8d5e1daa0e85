"""Verbs that hand over to a tool: build, and of `dev` format, tidy, modules, mutate and microbenchmarks. The
first argument is the verb, which its row of the table says.
"""

import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from datetime import datetime, timezone
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.program.building import build, folder, job_count, regenerate, say, setup
from barrierbench_analysis.program.verb_table import HELP

FOLDERS = ("core", "barriers", "experiments", "python", "examples", "tests")  # of sources in C++
SUFFIXES = (".cpp", ".hpp", ".c", ".h", ".cu", ".cuh")
TIDIED = ("core/", "barriers/", "experiments/")
OF_GCC = re.compile(  # these mean nothing to clang
    r" -include [^ ]*cmake_pch\.hxx| -fpch-preprocess| -Winvalid-pch| --param=ggc-[^ ]*"
)
MICROBENCHMARKS = "barrierbench_microbenchmarks"


def sources() -> list[str]:
    """The C++ sources of the tree, relative to the root, sorted."""
    found = (path for folder in FOLDERS for path in (ROOT / folder).rglob("*") if path.suffix in SUFFIXES)
    return sorted(str(path.relative_to(ROOT)) for path in found)


def _ran(*words: str | Path, **how) -> int:
    """The exit code of a tool in the tree."""
    return subprocess.run([str(word) for word in words], cwd=ROOT, check=False, **how).returncode


def build_preset(argv: list[str]) -> int:
    """A preset with all its targets."""
    preset = argv[0] if argv else "release"
    setup()
    build(preset, options={"BB_CUDA": "AUTO"})
    say(f"built build/{preset}")
    return 0


def clang_format(*words: str) -> int:
    """On every C++ file."""
    try:
        return _ran("clang-format-14", *words, *sources())
    except FileNotFoundError:
        raise UserError("clang-format-14 is needed: ./bench setup") from None


def format_all(argv: list[str]) -> int:
    """C++ by clang-format, the Python of analysis/ and python/ by ruff, in place."""
    if argv:
        raise UserError(f"found {argv[0]!r}; allowed: no arguments")
    ruff = (sys.executable, "-m", "ruff", "format", "--no-cache", "--quiet", "analysis", "python")
    return max(clang_format("-i"), _ran(*ruff, stdout=sys.stderr))


def tidy(argv: list[str]) -> int:
    """clang-tidy over the sources, as many at once as there are jobs."""
    setup()
    regenerate("dev")
    files = argv or [file for file in sources() if file.startswith(TIDIED) and file.endswith(".cpp")]
    base = folder("tidy")
    base.mkdir(parents=True, exist_ok=True)
    commands = OF_GCC.sub("", input_file.read_text(folder("dev") / "compile_commands.json"))
    (base / "compile_commands.json").write_text(commands)
    words = ("clang-tidy-14", "--quiet", "--extra-arg=-Wno-unknown-warning-option", "-p", base)
    with ThreadPoolExecutor(job_count()) as pool:
        return 1 if any(list(pool.map(lambda file: _ran(*words, file), files))) else 0


def modules(argv: list[str]) -> int:
    """The graph of the modules as CMake knows it, checked against the #include lines."""
    regenerate("release")
    known = (f"-DMODULES={folder('release') / 'modules.txt'}", f"-DSOURCE_DIR={ROOT}", "-DPRINT=ON")
    return _ran("cmake", *known, "-P", ROOT / "cmake/ModuleCheck.cmake")


def mutate(argv: list[str]) -> int:
    """The campaign of tests/mutation."""
    if not set(argv) & set(HELP):
        setup()
    return subprocess.run(
        [sys.executable, str(ROOT / "tests/mutation/mutate.py"), *argv], check=False
    ).returncode


def microbenchmarks(argv: list[str]) -> int:
    """The program of Google Benchmark, its JSON kept."""
    out = ROOT / "results/runs/microbenchmarks"
    out.mkdir(parents=True, exist_ok=True)
    kept = out / f"{datetime.now(timezone.utc):%Y-%m-%dT%H%M%SZ}.json"
    program = folder("release") / "experiments/microbenchmarks" / MICROBENCHMARKS
    words = [str(program), "--benchmark_out_format=json", f"--benchmark_out={kept}"]
    return subprocess.run([*words, *argv], check=False).returncode


VERBS = {"build": build_preset, "dev format": format_all}
VERBS |= {f"dev {verb.__name__}": verb for verb in (tidy, modules, mutate, microbenchmarks)}


def main(argv: list[str]) -> int:
    name, *words = argv
    return reported(name)(VERBS[name])(words)
