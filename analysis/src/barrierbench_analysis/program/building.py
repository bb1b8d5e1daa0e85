"""Builds: presets of CMakePresets.json, their targets, and the program."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import BUILD_FAILED, UserError
from barrierbench_analysis.io.free_memory import free_bytes
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.whole_file import write_whole

from .start import RELEASE

BYTES_A_JOB = 2 << 30  # g++ on many files at once
UNKNOWN_BYTES = 4 << 30  # where the system does not say what is free
MINUTE = 60  # seconds between two words about a build off the terminal


def say(text: str) -> None:
    print(f"bench: {text}", file=sys.stderr, flush=True)


def job_count() -> int:
    """One job a core, and 2 GiB of memory for each."""
    return max(1, min((free_bytes() or UNKNOWN_BYTES) // BYTES_A_JOB, len(os.sched_getaffinity(0))))


def folder(preset: str) -> Path:
    return ROOT / "build" / preset


def of_script(*words: str) -> int:
    """Exit code of the script ./bench."""
    return subprocess.run([str(ROOT / "bench"), *words], check=False).returncode


def setup(*packages: str) -> None:
    """Packages of the system and the Python environment, by the script ./bench. Errors: UserError; the script
    has reported why.
    """
    if code := of_script("setup", *packages):
        raise UserError("the setup failed", code)


def _has_options(preset: str, options: dict[str, str]) -> bool:
    cache = folder(preset) / "CMakeCache.txt"
    known = input_file.read_text(cache).splitlines() if options else []
    return all(
        any(line.startswith(f"{name}:") and line.endswith(f"={value}") for line in known)
        for name, value in options.items()
    )


def _cuda_here() -> str:
    """What decides whether there is device code: compilers and cards, each with its time."""
    places = [
        os.environ.get("CUDACXX", ""),
        shutil.which("nvcc") or "",
        *(os.environ.get(name, "") + "/bin/nvcc" for name in ("CUDA_HOME", "CUDA_PATH")),
        "/usr/local/cuda/bin/nvcc",
        "/opt/cuda/bin/nvcc",
        "/dev/nvidiactl",
    ]
    found = [place for place in places if place and Path(place).exists()]
    return "".join(f"{place} {int(Path(place).stat().st_mtime)}\n" for place in found)


def _device_options(preset: str, options: dict[str, str]) -> tuple[dict[str, str], bool]:
    """The options with BB_CUDA (cmake/Cuda.cmake) where this build needs a word about device code, and
    whether CMake has to look again. Kernels take minutes of nvcc, so where no card is only what compiles and
    tests them requests them (AUTO); a compiler or a card that is found later is used later.
    """
    cache = folder(preset) / "CMakeCache.txt"
    if not (folder(preset) / "build.ninja").is_file():
        return ({"BB_CUDA": "CARD", **options} if preset == "release" else options), True
    known = input_file.read_text(cache)
    configured = re.search(r"^BB_CUDA:STRING=(AUTO|CARD)$", known, re.M)
    without = {name: value for name, value in options.items() if name != "BB_CUDA"}
    if not configured or "BB_CUDA_BUILT:INTERNAL=OFF" not in known:
        return without, False  # it has device code, or its configuration says that it shall have none
    stamp = folder(preset) / "cuda_asked"
    wanted = "AUTO" if options.get("BB_CUDA") == "AUTO" else configured[1]
    same = wanted == configured[1] and stamp.is_file() and input_file.read_text(stamp) == _cuda_here()
    return {**without, "BB_CUDA": wanted}, not same


def configure(preset: str, options: dict[str, str] | None = None) -> None:
    """Once, and again when one of the CMake options has another value. Errors: UserError."""
    if not shutil.which("cmake") or not shutil.which("ninja"):
        raise UserError("cmake and ninja are needed: ./bench setup")
    options, look_again = _device_options(preset, options or {})
    if not look_again and _has_options(preset, options):
        return
    say(f"configuring build/{preset}")
    words = ["cmake", "--preset", preset, *(f"-D{name}={value}" for name, value in options.items())]
    if subprocess.run(words, cwd=ROOT, stdout=sys.stderr, check=False).returncode != 0:
        raise UserError("configuration failed")
    write_whole(folder(preset) / "cuda_asked", _cuda_here())


def _last_line(log: Path) -> str:
    lines = input_file.read_text(log).splitlines()
    return lines[-1] if lines else ""


def _build_quietly(words: list[str], preset: str) -> int:
    """Off the terminal: every minute how far it is, and the log of ninja when it fails."""
    with tempfile.TemporaryDirectory() as scratch:
        log = Path(scratch) / "ninja.log"
        with log.open("wb") as out:
            process = subprocess.Popen(words, stdout=out, stderr=subprocess.STDOUT)
            while True:
                try:
                    code = process.wait(MINUTE)
                    break
                except subprocess.TimeoutExpired:
                    say(f"building build/{preset}: {_last_line(log)}")
        if code != 0:
            sys.stderr.write(input_file.read_text(log))
        return code


def build(preset: str, *targets: str, options: dict[str, str] | None = None) -> None:
    """Targets of a preset, all without any, with these CMake options; silent when nothing is to be done.
    Errors: UserError, 70 where code does not build.
    """
    configure(preset, options)
    words = ["ninja", "-C", str(folder(preset)), "-j", str(job_count())]
    if sys.stderr.isatty():
        code = subprocess.run([*words, "--quiet", *targets], stdout=sys.stderr, check=False).returncode
    else:
        code = _build_quietly([*words, *targets], preset)
    if code != 0:
        raise UserError("build failed", BUILD_FAILED)


def regenerate(preset: str) -> None:
    """Configured, and every generated header as the CMake files say. Errors: UserError."""
    configure(preset)
    if (
        subprocess.run(
            ["ninja", "-C", str(folder(preset)), "--quiet", "build.ninja"], stdout=sys.stderr, check=False
        ).returncode
        != 0
    ):
        raise UserError("configuration failed")


def ensure(*targets: str) -> None:
    """Targets of the release build, after the setup where nothing was configured. Errors: UserError."""
    if not (folder("release") / "build.ninja").is_file():
        setup()
    build("release", *targets)


def ensure_program() -> Path:
    ensure("barrierbench")
    return RELEASE
