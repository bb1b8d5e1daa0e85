"""What ./bench --version says."""

import re

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.git import NoHistory, git
from barrierbench_analysis.io.places import ROOT


def version() -> str:
    """What these sources are."""
    number = re.search(r"^project\(\w+ VERSION (\S+)", input_file.read_text(ROOT / "CMakeLists.txt"), re.M)[1]
    how = ["describe", "--always", "--dirty=, with changes", "--abbrev=10", "--exclude=*"]
    try:
        return f"barrierbench {number}, commit {git(ROOT, *how).strip()}"
    except NoHistory:
        return f"barrierbench {number}"
