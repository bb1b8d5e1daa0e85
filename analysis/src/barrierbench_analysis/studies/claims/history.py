"""When an entry of a JSON file was committed, from git. Without a history nothing is verified."""

import json
import subprocess
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path


class NoHistory(Exception):
    """No git, or no repository here."""


@dataclass(frozen=True)
class Commit:
    sha: str
    at: datetime
    oldest: bool  # the last commit that is known here: in a shallow clone the entry may be older


def _git(root: Path, *words: str) -> str:
    try:
        done = subprocess.run(["git", "-C", str(root), *words], capture_output=True, text=True, check=False)
    except OSError as error:
        raise NoHistory(str(error)) from None
    if done.returncode != 0:
        raise NoHistory(done.stderr.strip())
    return done.stdout


def _is_shallow(root: Path) -> bool:
    return _git(root, "rev-parse", "--is-shallow-repository").strip() == "true"


def brought(root: Path, file: str, way: tuple[str, ...], value) -> Commit | None:
    """The commit, an ancestor of HEAD, since which every commit of the file has this value at this place;
    None when HEAD has another.
    """
    lines = _git(root, "log", "--format=%H %ct", "HEAD", "--", file).split("\n")
    known, found = [line.split() for line in lines if line], None
    for k, (sha, seconds) in enumerate(known):
        try:
            at = json.loads(_git(root, "show", f"{sha}:{file}"))
        except (NoHistory, ValueError):  # the file is not there, or is none
            break
        for word in way:
            at = at.get(word) if isinstance(at, dict) else None
        if at != value:
            break
        found = Commit(
            sha, datetime.fromtimestamp(int(seconds), timezone.utc), k == len(known) - 1 and _is_shallow(root)
        )
    return found
