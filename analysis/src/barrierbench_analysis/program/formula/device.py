"""The kernel of a formula's shape: PTX text, made by nvcc when a run on a card requests it, and kept beside
the compiled formulas. It is good as long as every header that it was made from is as it was.
"""

import json
import os
import shutil
import time
from pathlib import Path

from barrierbench_analysis.io import digests, input_file
from barrierbench_analysis.io.places import ROOT

from . import cache
from .grammar import Formula, FormulaError, read

# As cmake/Cuda.cmake has it: no contraction to fused multiply-adds; PTX of the oldest card, which newer ones
# compile.
FLAGS = (
    "-ptx -arch=compute_80 -std=c++20 -O3 -DNDEBUG --fmad=false -Xcompiler=-ffp-contract=off"
    " --expt-relaxed-constexpr --diag-suppress=20012 -Werror=cross-execution-space-call"
)
USUAL = ("/usr/local/cuda/bin", "/opt/cuda/bin")
REMEDY = "CUDA's nvcc, no newer than the card's driver, on PATH, in CUDA_HOME or named by CUDACXX"
# Variables of the environment that would change what nvcc makes.
CHANGES_NVCC = ("NVCC_APPEND_FLAGS", "NVCC_PREPEND_FLAGS", "NVCC_CCBIN")


def find_nvcc() -> str | None:
    """CUDACXX, PATH, then the usual folders, as cmake/Cuda.cmake does without CMAKE_CUDA_COMPILER."""
    homes = [f"{os.environ[name]}/bin" for name in ("CUDA_HOME", "CUDA_PATH") if os.environ.get(name)]
    return (
        shutil.which(os.environ.get("CUDACXX") or "nvcc")
        or shutil.which("nvcc")
        or shutil.which("nvcc", path=os.pathsep.join([*homes, *USUAL]))
    )


def device_code(text: str, layout: int) -> dict:
    """entry, ptx (a file) and ptx_sha256 of the kernel of a formula that was compiled before. layout: that of
    the program's rows (core/contact/executor/given_shape.hpp). Cost: 0.1 s from the cache, else some seconds.
    Errors: FormulaError.
    """
    formula = read(text)
    nvcc = find_nvcc()
    if not nvcc:
        raise FormulaError(f'"{formula.text}" on a card, and no nvcc', REMEDY)
    words = [nvcc, *FLAGS.split(), f"-I{ROOT}", f"-I{cache.EIGEN}"]
    place = cache.folder() / f"{_key_of(formula, layout, words)}.ptx"
    return _find(place) or _make(formula, layout, words, place)


def _key_of(formula: Formula, layout: int, words: list[str]) -> str:
    """Headers are not in it: the JSON beside the PTX has them."""
    code = [digests.of_file(path) for path in sorted(Path(__file__).parent.glob("*.py"))]
    version = cache.version_of(words[0], REMEDY)
    return digests.of_text("\n".join([formula.text, str(layout), version, *words, *code]))


def _find(place: Path) -> dict | None:
    """Nothing where it was not made yet, a header has changed, or the file is not what its JSON says."""
    try:
        known = json.loads(input_file.read_text(place.with_suffix(".ptx.json")))
        headers = known["headers"]
        whole = known["ptx_sha256"] == digests.of_file(place) and all(
            digests.of_file(ROOT / header) == sha256 for header, sha256 in headers.items()
        )
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None
    return _answer(known, place) if whole and headers else None


def _answer(known: dict, place: Path) -> dict:
    return {"entry": known["entry"], "ptx": str(place), "ptx_sha256": known["ptx_sha256"]}


def _make(formula: Formula, layout: int, words: list[str], place: Path) -> dict:
    from . import checks, source, symbolic  # they import sympy, which what is kept does not need

    terms, begun = symbolic.terms_of(formula), time.time()

    def made(there: Path) -> dict:
        plain = ["env", *(word for name in CHANGES_NVCC for word in ("-u", name)), *words]
        arguments = ["-MD", "-MF", "headers.d", "-o", "formula.ptx", "formula.cu"]
        cache.compile_there([*plain, *arguments], there, f"{REMEDY} ({words[0]} was requested)")
        headers = _headers(input_file.read_text(there / "headers.d"))
        if any((ROOT / header).stat().st_mtime > begun for header in headers):
            allowed = "sources that nobody edits meanwhile"
            raise FormulaError("headers that changed while nvcc read them", allowed)
        sha256 = digests.of_file(there / "formula.ptx")
        return {"entry": source.ENTRY, "formula": formula.text, "ptx_sha256": sha256, "headers": headers}

    text = source.cu(formula.text, terms, checks.check(terms, None), layout)
    return _answer(cache.put(place, text, ("cu", "ptx", "ptx.json"), made), place)


def _headers(rule: str) -> dict[str, str]:
    """Files of this tree in a make rule of nvcc, with their hashes."""
    files = {Path(word) for word in rule.replace("\\\n", " ").split() if word.startswith(f"{ROOT}/")}
    return {str(file.relative_to(ROOT)): digests.of_file(file) for file in sorted(files)}
