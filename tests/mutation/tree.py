"""A copy of the working tree with a release build of its own, and the judges that run in it."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from pathlib import Path

PROGRAM = "experiments/barrierbench"  # below the build folder


def listed_files(root: Path) -> list[str]:
    """Tracked files and untracked ones that git does not ignore."""
    command = ["git", "-C", str(root), "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(command, capture_output=True, check=True, text=True).stdout.split("\0")
    return sorted({name for name in names if name and (root / name).is_file()})


def tree_digest(root: Path) -> str:
    digest = hashlib.sha256()
    for name in listed_files(root):
        digest.update(name.encode() + b"\0" + hashlib.sha256((root / name).read_bytes()).digest())
    return digest.hexdigest()


class Tree:
    """A copy of the working tree with a release build of its own."""

    def __init__(self, folder: Path, data: Path | None):
        self.folder, self.build = folder, folder / "build" / "release"
        self.environment = os.environ | {
            "PYTHONPATH": f"{folder / 'analysis/src'}:{folder}",
            "PYTHONDONTWRITEBYTECODE": "1",
            "BARRIERBENCH_PROGRAM": str(self.build / PROGRAM),
        }
        if data is not None:
            self.environment["BARRIERBENCH_DATA"] = str(data)

    def synchronise(self, root: Path) -> None:
        """Makes the copy equal to the working tree; files that are equal keep their times, so they are not rebuilt."""
        wanted = listed_files(root)
        for name in wanted:
            target, content = self.folder / name, (root / name).read_bytes()
            if not target.is_file() or target.read_bytes() != content:
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(content)
                target.chmod((root / name).stat().st_mode)
        for path in list(self.folder.rglob("*")):
            name = path.relative_to(self.folder)
            if path.is_file() and name.parts[0] not in ("build", ".git") and str(name) not in set(wanted):
                path.unlink()

    def run(self, command: list[str], timeout: float) -> tuple[int, str]:
        """Exit code (124: out of time) and output, stderr included."""
        try:
            done = subprocess.run(command, cwd=self.folder, env=self.environment, timeout=timeout, check=False,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
        except subprocess.TimeoutExpired:
            return 124, f"out of time after {timeout:.0f} s"
        return done.returncode, done.stdout

    def configure(self) -> tuple[int, str]:
        if (self.build / "build.ninja").exists():
            return 0, ""
        return self.run(["cmake", "--preset", "release", "-DBB_CUDA=OFF", "-DBB_BENCHMARKS=OFF"], 600)

    def make(self, judges: list[str], jobs: int) -> tuple[int, str]:
        """Builds what the judges run, and goes on after an error so that all errors are seen."""
        targets = sorted({"barrierbench" if j.startswith("pytest:") else j.split(":")[0] for j in judges})
        return self.run(["ninja", "-C", str(self.build), "-j", str(jobs), "-k", "0", *targets], 3600)

    def write(self, name: str, text: str) -> None:
        """Only what differs is touched, so that nothing else is built anew."""
        if (self.folder / name).read_text() != text:
            (self.folder / name).write_text(text)

    def judge(self, name: str, timeout: float) -> tuple[int, str]:
        """Runs one judge up to its first failure."""
        kind, _, rest = name.partition(":")
        if kind == "pytest":
            return self.run([sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *rest.split()], timeout)
        program = next(iter(self.build.glob(f"tests/*/{kind}")), None)
        if program is None:
            return 127, f"{kind} is not among the built tests"
        return self.run([str(program), "--gtest_fail_fast", "--gtest_brief=1", *([f"--gtest_filter={rest}"] if rest else [])], timeout)


def ran_nothing(name: str, code: int, output: str) -> bool:
    """A judge whose filter or path matches no test judges nothing."""
    if name.startswith("pytest:"):
        return code == 5 or "no tests ran" in output
    return "Running 0 tests" in output or "0 tests from 0 test suites" in output


def first_failure(output: str) -> str:
    """The line of a judge's output that names what failed."""
    for mark in ("[  FAILED  ]", "FAILED ", "ERROR ", ": error:", "error:"):
        for line in output.splitlines():
            if mark in line:
                return line.strip()[:160]
    return (output.strip().splitlines() or [""])[-1][:160]
