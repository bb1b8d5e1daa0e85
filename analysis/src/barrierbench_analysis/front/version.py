"""What ./bench --version says."""

import re
import subprocess

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.places import ROOT


def version() -> str:
    """What these sources are."""
    number = re.search(r"^project\(\w+ VERSION (\S+)", input_file.read_text(ROOT / "CMakeLists.txt"), re.M)[1]
    asked = [
        "git",
        "-C",
        str(ROOT),
        "describe",
        "--always",
        "--dirty=, with changes",
        "--abbrev=10",
        "--exclude=*",
    ]
    try:
        commit = subprocess.run(asked, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return f"barrierbench {number}"
    return f"barrierbench {number}, commit {commit}"
