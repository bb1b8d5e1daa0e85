"""The compiled formulas of this user: made once, found by the hash of all that makes them. A library is put
in place by renaming, and its JSON, which says that it is whole, after it.
"""

import json
import os
import shlex
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from barrierbench_analysis.io import digests, input_file
from barrierbench_analysis.io.errors import code_of
from barrierbench_analysis.io.places import ROOT

from .grammar import Formula, FormulaError

HEADERS = [
    *(f"barriers/shapes/{name}.hpp" for name in ("builtin_shape", "lane_batch", "shape_family")),
    *(
        f"core/barrier/{name}.hpp"
        for name in ("shape_potential", "normalized_gap", "shape", "stiffness_sums")
    ),
    *(f"core/math/{name}.hpp" for name in "atan2 device_code exp host_device lanes lanes_log log".split()),
    *(f"core/math/{name}.hpp" for name in ("scale", "select", "types")),
    "core/model/plugin/barrierbench_plugin.h",
]
EIGEN = "/usr/include/eigen3"
SECONDS_TO_COMPILE = 120
HOST_COMPILER = "a C++ compiler as c++, or named by the variable CXX (Debian: apt-get install g++)"


class Compiled(NamedTuple):
    """A library in the cache, and what is known of its formula."""

    library: Path
    about: dict  # formula, label, at_zero, smoothness, library_sha256, ...


def folder() -> Path:
    """BARRIERBENCH_CACHE, else barrierbench in the user's cache folder."""
    own = os.environ.get("BARRIERBENCH_CACHE")
    if own:
        return Path(own) / "formulas"
    base = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    return Path(base) / "barrierbench" / "formulas"


def label_of(formula: Formula) -> str:
    """The short name, for folders and legends."""
    return f"formula-{digests.of_text(formula.text)[:8]}"


def command() -> list[str]:
    """The compiler of the system and its flags: those of the program, which decide bits and speed."""
    compiler = shlex.split(os.environ.get("CXX") or "c++")
    flags = (
        "-std=c++20 -O2 -DNDEBUG -ffp-contract=off -fno-tree-vectorize -fno-math-errno -fno-trapping-math"
        " -DEIGEN_DONT_VECTORIZE"
    )
    march = ["-march=x86-64-v3"] if _runs_v3() else []
    return [*compiler, *flags.split(), *march, "-shared", "-fPIC", "-s", f"-I{ROOT}", "-isystem", EIGEN]


def _runs_v3() -> bool:
    try:
        words = set(input_file.read_text(Path("/proc/cpuinfo")).split("flags", 2)[1].split("\n")[0].split())
    except (ValueError, IndexError):
        return False
    return {"avx2", "bmi1", "bmi2", "fma", "f16c", "movbe", "abm"} <= words


def key_of(formula: Formula, words: list[str]) -> str:
    """Of the formula, this code, the headers, the command, and the compiler's own version. Errors:
    FormulaError where there is no compiler.
    """
    code = sorted(Path(__file__).parent.glob("*.py"))
    files = [digests.of_file(path) for path in [*code, *(ROOT / header for header in HEADERS)]]
    return digests.of_text("\n".join([formula.text, version_of(words[0]), *words, *files]))


def version_of(compiler: str, allowed: str = HOST_COMPILER) -> str:
    how = {"check": True, "capture_output": True, "text": True, "timeout": 30}
    try:
        return subprocess.run([compiler, "--version"], **how).stdout
    except (OSError, subprocess.SubprocessError) as error:
        raise FormulaError(f'no compiler "{compiler}" ({error})', allowed) from None


def find(key: str) -> Compiled | None:
    """Nothing where it was not made yet, or is not what its JSON says."""
    library, about = folder() / f"{key}.so", folder() / f"{key}.json"
    try:
        known = json.loads(input_file.read_text(about))
        whole = known["library_sha256"] == digests.of_file(library)
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return Compiled(library, known) if whole else None


def make(key: str, words: list[str], source: str, about: dict, judge: Callable[[Path], dict]) -> Compiled:
    """Compiles and keeps, with all that `judge` says of the library. Errors: FormulaError with what the
    compiler reported, where nothing can be written, and of `judge`.
    """

    def made(there: Path) -> dict:
        refusal = f"a compiler of C++20 ({shlex.join(words)})"
        compile_there([*words, "-o", "formula.so", "formula.cpp"], there, refusal)
        library = there / "formula.so"
        return {**about, **judge(library), "library_sha256": digests.of_file(library)}

    place = folder() / f"{key}.so"
    return Compiled(place, put(place, source, ("cpp", "so", "json"), made))


def put(place: Path, source: str, suffixes: tuple[str, str, str], make: Callable[[Path], dict]) -> dict:
    """What `make` says of the files that it has made in a folder, in which formula.SUFFIX is the source; they
    are renamed to their place. suffixes: of source, product and JSON, which is the last since it says that
    the others are there. Errors: FormulaError where nothing can be written.
    """
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=place.parent, prefix="making-") as name:
            files = [Path(name) / f"formula.{suffix}" for suffix in suffixes]
            files[0].write_text(source)
            known = make(Path(name))
            files[-1].write_text(json.dumps(known, indent=1) + "\n")
            for suffix, file in zip(suffixes, files, strict=True):
                file.replace(place.with_suffix(f".{suffix}"))
    except OSError as error:
        raise not_written(place.parent, error) from None
    return known


def not_written(place: Path, error: OSError) -> FormulaError:
    allowed = "a folder to write to, or another in BARRIERBENCH_CACHE"
    return FormulaError(f"the folder {place} ({error.strerror})", allowed, code_of(error))


def compile_there(words: list[str], there: Path, allowed: str) -> None:
    """Runs a compiler in a folder. allowed: what would do. Errors: FormulaError with the compiler's words."""
    try:
        how = {"capture_output": True, "text": True, "timeout": SECONDS_TO_COMPILE}
        done = subprocess.run(words, check=False, cwd=there, **how)
    except subprocess.TimeoutExpired:
        found = f"a compiler that takes more than {SECONDS_TO_COMPILE} s"
        raise FormulaError(found, "a shorter formula") from None
    if done.returncode != 0:
        first = next((line for line in done.stderr.splitlines() if "error" in line), done.stderr[:200])
        raise FormulaError(f"a compiler that refuses the formula: {first}", allowed)
