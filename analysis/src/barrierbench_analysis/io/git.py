"""The one place that starts git."""

import subprocess
from pathlib import Path


class NoHistory(Exception):
    """No git, or no repository here."""


def git(root: Path, *words: str) -> str:
    """What a command of git prints. Errors: NoHistory with what git says."""
    try:
        done = subprocess.run(["git", "-C", str(root), *words], capture_output=True, text=True, check=False)
    except OSError as error:
        raise NoHistory(str(error)) from None
    if done.returncode != 0:
        raise NoHistory(done.stderr.strip())
    return done.stdout
