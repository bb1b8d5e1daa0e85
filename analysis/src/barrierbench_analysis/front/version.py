"""What ./bench --version says."""

import re
import subprocess

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.places import ROOT


def version() -> str:
    """What these sources are."""
    number = re.search(r"^project\(\w+ VERSION (\S+)", input_file.read_text(ROOT / "CMakeLists.txt"), re.M)[1]
    how = ["describe", "--always", "--dirty=, with changes", "--abbrev=10", "--exclude=*"]
    try:
        commit = subprocess.run(
            ["git", "-C", str(ROOT), *how], capture_output=True, text=True, check=True
        ).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return f"barrierbench {number}"
    return f"barrierbench {number}, commit {commit}"
