"""The environment that tests run in: a home, a temporary folder and a cache of their own, and few of the
variables of this machine.
"""

import re
import shutil
from collections.abc import Mapping
from pathlib import Path

KEPT = re.compile(
    r"PATH|TERM|TZ|C(C|XX)(FLAGS)?|CUDA_(HOME|PATH|VISIBLE_DEVICES)|CUDACXX|(LD_)?LIBRARY_PATH|NVIDIA_.*|SLURM_CONF|SNAKEMAKE"
    r"|CCACHE_.*|OPENBLAS_.*|(A|L|M|T|UB)SAN_OPTIONS|PYTEST_.*|PYTHON(DONTWRITEBYTECODE|UNBUFFERED|WARNINGS)"
    r"|BARRIERBENCH_(?!CACHE$).*|BB_.*|JUDGE_PAIRS"
)  # the last line: what a user asks of the tests
NAMES = ("home", "temporary")  # folders that are empty when a test is over


def compiler_cache(environment: Mapping[str, str]) -> str:
    """The folder of ccache, which stays the same in another home."""
    home = Path(environment.get("HOME") or "/")
    base = Path(environment.get("XDG_CACHE_HOME") or home / ".cache")
    old = home / ".ccache"
    return environment.get("CCACHE_DIR") or str(old if old.is_dir() else base / "ccache")


def variables(place: Path, environment: Mapping[str, str]) -> dict[str, str]:
    """What tests whose folders lie at `place` are started with; makes these folders."""
    for name in (*NAMES, "cache"):
        (place / name).mkdir(parents=True, exist_ok=True)
    home, temporary = (str(place / name) for name in NAMES)
    cache = str(place / "cache")
    kept = {name: value for name, value in environment.items() if KEPT.fullmatch(name)}
    return kept | {
        "HOME": home,
        "TMPDIR": temporary,
        "TEST_TMPDIR": f"{temporary}/",  # of GoogleTest
        "LANG": "C.UTF-8",
        "XDG_CACHE_HOME": cache,
        "MPLCONFIGDIR": f"{cache}/matplotlib",
        "CUDA_CACHE_PATH": f"{cache}/nv",  # of the driver, where PTX is compiled for a card
        "CCACHE_DIR": compiler_cache(environment),
    }


def left_over(place: Path, spared: str = "") -> list[Path]:
    """What lies in the home and in the temporary folder, but for what matches `spared`; it is removed."""
    found = [
        path
        for name in NAMES
        for path in sorted((place / name).iterdir())
        if not (spared and path.match(spared))
    ]
    for path in found:
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)
    return found
