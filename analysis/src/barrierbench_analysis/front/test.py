"""The verb test: setup, build, format, modules, C++ tests, Python tests, gate. A later part never hides an
earlier failure, and the summary names every skip.
"""

import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.program.building import build, folder, job_count, say, setup

from . import private, python_module, tools

OWN = ("--sanitize", "--browser")  # what ctest does not see
FILMS = ("usd", "alembic", "vtkhdf")  # of analysis/requirements-NAME.txt
NAMED_TESTS = 20  # C++ tests that the summary names


class Summary:
    """Verdicts of the parts, in their order."""

    def __init__(self):
        self.lines: list[str] = []
        self.failures = 0

    def step(self, name: str, part: Callable[[], int]) -> None:
        """Runs one part and keeps its verdict."""
        start = time.monotonic()
        say(f"== {name}")
        failed = part() != 0
        self.failures += failed
        self.lines.append(f"{'FAILED  ' if failed else 'passed  '} {name} ({time.monotonic() - start:.0f} s)")

    def text(self) -> str:
        lines = ["", "== summary", *(f"  {line}" for line in self.lines)]
        return "\n".join(lines + ([f"  {self.failures} of the parts failed"] if self.failures else []))


def _into(log: Path, words: list[str], **more) -> int:
    with log.open("wb") as out:
        return subprocess.run(words, stdout=out, stderr=subprocess.STDOUT, check=False, **more).returncode


def not_passed_cpp(log: str) -> list[str]:
    """Lines of the summary about tests that ctest skipped, and about those that failed."""
    lines = []
    for mark, word in (("Skipped", "SKIPPED"), ("(?!Skipped)", "FAILED ")):
        names = re.findall(rf"(?m)^.*Test +#\d+: (.*?) \.*\*\*\*{mark}", log)
        if names:
            lines += [
                f"{word}  {len(names)} C++ tests:",
                *(f"           {name}" for name in names[:NAMED_TESTS]),
            ]
    return lines


def without_passed(log: str) -> str:
    """The lines of ctest that are not of a test that started or passed."""
    return "\n".join(
        line
        for line in log.splitlines()
        if not re.match(r" *Start +\d+: |.*Test +#\d+: .* Passed +[\d.]+ sec", line)
    )


def ptx_share(log: str) -> list[str]:
    """A line of the summary about the tests that run nvcc's PTX: how many, and their share of the time."""
    seconds = {name: float(s) for name, s in re.findall(r"Test +#\d+: (\S+) .*?([\d.]+) sec", log)}
    ptx = [s for name, s in seconds.items() if name.startswith("ptx.")]
    if not ptx:
        return []
    of_all = sum(seconds.values())
    return [f"PTX      {len(ptx)} C++ tests run PTX: {sum(ptx):.0f} of {of_all:.0f} s of one core"]


def in_private(words: list[str], log: Path) -> tuple[int, list[str]]:
    """Runs tests in folders of their own: their exit code, and a line for everything that they left there."""
    with tempfile.TemporaryDirectory(prefix="barrierbench-tests-") as place:
        code = _into(log, words, env=private.variables(Path(place), os.environ))
        left = [f"LEFT     {path.relative_to(place)}" for path in private.left_over(Path(place))]
    return code, left


def cpp_tests(preset: str, arguments: list[str], summary: Summary) -> int:
    log = folder(preset) / "ctest.log"
    words = ["ctest", "--test-dir", str(folder(preset)), "--parallel", "2"]
    code, left = in_private([*words, "--output-on-failure", "--no-tests=error", *arguments], log)
    text = input_file.read_text(log)
    print("\n".join(text.splitlines()[-6:]) if code == 0 else without_passed(text), flush=True)
    summary.lines += ptx_share(text) + not_passed_cpp(text) + left
    return code or len(left)


def python_tests(preset: str, summary: Summary) -> int:
    log = ROOT / "build/pytest.log"
    words = [*"-m pytest -q -rsfE -p no:cacheprovider --dist loadfile -n".split(), str(job_count())]
    words += ["-c", str(ROOT / "pytest.ini"), str(ROOT / "tests")]
    program = str(folder(preset) / "experiments/barrierbench")
    environment = {**os.environ, "BARRIERBENCH_PROGRAM": program}
    code = _into(log, [sys.executable, *words], env=environment)
    text = input_file.read_text(log)
    print(text, flush=True)
    summary.lines += [
        f"{word}  {line.removeprefix(word)}"
        for line in text.splitlines()
        for word in ("SKIPPED", "FAILED", "ERROR")
        if line.startswith(f"{word} ")
    ]
    return code


def _gate() -> int:
    from barrierbench_analysis.studies.gate import gate

    return gate.main([])


def set_up(browser: bool, films: bool) -> None:
    """What every test needs; with `browser` also Debian's chromium (about 100 MB) and what drives it, with
    `films` the packages of films (about 50 MB), so that no test of theirs is skipped. Errors: UserError.
    """
    setup(python_module.PACKAGE, *(["chromium"] if browser else []))
    names = [*(FILMS if films else ()), *(["browser"] if browser else [])]
    files = [f"analysis/requirements-{name}.txt" for name in names]
    if files:
        words = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        words += [word for file in files for word in ("--requirement", str(ROOT / file))]
        if subprocess.run(words, stdout=sys.stderr, check=False).returncode:
            raise UserError(f"cannot install {', '.join(files)}: is there a network?")


@reported("test")
def main(argv: list[str]) -> int:
    own = {word for word in argv if word in OWN}
    arguments = [word for word in argv if word not in OWN]
    preset = "sanitize" if "--sanitize" in own else "release"
    set_up("--browser" in own, films=not arguments)
    summary = Summary()
    start = time.monotonic()
    build(preset, options={"BB_CUDA": "AUTO"} | (python_module.options() if preset == "release" else {}))
    if preset == "release":
        build(preset, *python_module.MODULE)
    summary.lines.append(f"built    {preset} ({time.monotonic() - start:.0f} s)")
    summary.step("clang-format", lambda: tools.clang_format("--dry-run", "--Werror"))
    summary.step("modules", lambda: tools.main(["dev modules"]))
    summary.step(f"C++ tests ({preset})", lambda: cpp_tests(preset, arguments, summary))
    if arguments:
        summary.lines.append("not run  Python tests (ctest arguments were given)")
    else:
        summary.step(f"Python tests ({preset})", lambda: python_tests(preset, summary))
        if preset == "release":
            summary.step("gate (small set)", _gate)
    print(summary.text())
    return 1 if summary.failures else 0
